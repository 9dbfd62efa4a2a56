//! Computing time of a tube: `cargo bench -p phihat-design --bench tube` prints one JSON line per study and
//! duration, with the time of the search for the gains alongside.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a benchmark stops on a bad set-up")]

use std::time::Instant;

use phihat_design::tube::{Desired, tube};
use phihat_design::{Arm, Gains, Outcome, design};
use phihat_sim::{Demand, Motion};
use phihat_study::Study;
use phihat_synthesis::phi_along;

/// An error of 2 mrad with an unknown payload and friction, on a motion of two sines.
fn study(robot: &str, duration: f64) -> Study {
    let text = format!(
        r#"
duration_s = {duration:?}
[robot]
name = "{robot}"
[spec]
error_bound_rad = 2e-3
settle_s = 0.4
[design]
payload_max_kg = 0.5
coulomb_max_nm = 0.2
settling_time_s = 1.0
[sensor]
encoder_bits = 20
[loop]
torque_rate_max_nm_s = "none"
[reference]
kind = "sines"
center = "ready"
fade_in_s = 0.2
[[reference.sine]]
amplitude_rad = 0.15
frequency_hz = 0.25
"#
    );
    Study::from_text(&text, "bench", ".".as_ref()).unwrap()
}

fn gains(study: &Study) -> Gains {
    let demand = Demand::along(study).unwrap();
    let arm = Arm::of(study).unwrap();
    let phi = |joint, inertia| phi_along(&demand, joint, inertia);
    match design(study, &arm, &phi).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no:?}"),
    }
}

fn main() {
    // Without `--bench` it only has to work: tests run it so.
    let measured = std::env::args().any(|word| word == "--bench");
    let (robots, durations, runs): (&[_], &[_], _) = if measured {
        (&["planar3r", "ur5", "panda"], &[2.5, 5.0, 10.0], 3)
    } else {
        (&["planar3r"], &[0.5], 1)
    };
    for robot in robots {
        for &duration in durations {
            let study = study(robot, duration);
            let start = Instant::now();
            let gains = gains(&study);
            let searched = start.elapsed().as_secs_f64();
            let motion = Motion::of(&study).unwrap();
            let desired = Desired::of(&study, |joint, t| motion.told(joint, t));
            let mut times: Vec<f64> = (0..runs)
                .map(|_| {
                    let start = Instant::now();
                    let found = tube(&study, &gains, &desired).unwrap();
                    assert!(found.joints.iter().all(|joint| joint.error_bound_rad.is_finite()));
                    start.elapsed().as_secs_f64()
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let joints = gains.joints.len();
            let each =
                1e3 * times[runs / 2] / (duration * f64::from(u32::try_from(joints).unwrap()));
            let tube = times[runs / 2];
            print!(
                r#"{{"robot":"{robot}","joints":{joints},"duration_s":{duration},"search_s":{searched:.3},"#
            );
            println!(r#""tube_s":{tube:.3},"tube_ms_per_s_and_joint":{each:.2}}}"#);
        }
    }
}
