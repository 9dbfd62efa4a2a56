//! A load picked up or dropped moves the arm by no more than predicted. Wrong if the peak gains of the sampled loop
//! did not hold for a load that changes the inertia as well, or if the loop locked up afterwards.

use std::path::Path;

use phihat::Form;
use phihat_design::prelude::*;
use phihat_design::requested_gains;
use phihat_design::sampled::{LoopModel, SampledPeaks};
use phihat_sim::Simulation;
use phihat_study::Study;

fn study(order: usize, pose: f64, mass: f64, start: f64) -> Study {
    let text = format!(
        "duration_s = 3.0\n[robot]\nname = \"planar3r\"\nlocked = {{ joint2 = 0.3, joint3 = 0.3 }}\n[gains]\n\
         order = {order}\nbandwidth_rad_s = 15.0\nestimator_bandwidth_rad_s = 50.0\ninertia_kg_m2 = 1.0\n\
         [loop]\ndelay_samples = 1\n[world]\nfriction = \"none\"\n[[fault]]\nkind = \"payload\"\nsize = {mass}\n\
         start_s = {start}\n{}[reference]\nkind = \"hold\"\nq_rad = {pose}\n",
        if start > 0.0 { "" } else { "duration_s = 1.5\n" }
    );
    Study::from_text(&text, "arm.toml", Path::new("")).unwrap()
}

#[test]
fn f12_a_load_dropped_or_picked_moves_the_arm_no_more_than_predicted() {
    let (mut closest, mut runs) = (0.0_f64, 0);
    for order in [1, 2] {
        for k in 0..60_u32 {
            // Even over postures and masses, the same every time.
            let share = |step: f64| (f64::from(k) * step).fract();
            let (pose, mass) = (2.4 * share(0.618) - 1.2, 0.05 + 0.45 * share(0.414));
            let picked = k % 2 == 0;
            let at = if picked { 1.5 } else { 0.0 };
            let study = study(order, pose, mass, at);
            let gains = requested_gains(&study).unwrap();
            let record = &gains.joints[0];
            let model = LoopModel::from_study(&study, 0);
            // Links of 0.6 to 1.1 kg·m² with the rotor, and the load at up to 0.85 m on top.
            let peaks = SampledPeaks::find(record, &model, (0.5, 1.6), 6).unwrap();
            let law = gains.joint_gains(&["joint1".to_owned()], 1_000_000, Form::Observer).unwrap();
            let outcome = Simulation::new(&study, &law).unwrap().run(|_| ());
            assert!(outcome.divergence.is_none());
            let joint = &outcome.trace.joints[0];
            let jump = (joint.phi[1490] - joint.phi[2990]).abs();
            let predicted = peaks.jump[1] * jump / record.inertia_kg_m2;
            let peak = joint.e[1495..].iter().fold(0.0_f64, |most, e| most.max(e.abs()));
            assert!(peak <= 1.5 * predicted, "m {order}, {mass} kg at {pose}: {peak} {predicted}");
            closest = closest.max(peak / predicted);
            // No lock-up: back where it was.
            assert!(joint.e[2900..].iter().all(|e| e.abs() < 0.02 * peak.max(1e-4)));
            runs += 1;
        }
    }
    println!("{runs} picks and drops: the largest peak is {closest:.2} of its prediction");
    assert!(closest > 0.3, "the prediction is far off: {closest}");
}
