//! A rod on a hinge has closed-form answers. Wrong if an effect of the world had the wrong size, sign or
//! timing.

use crate::support::{ROD_INERTIA, gains, rod_study, run};
use phihat::{Delay, JointState, Measurement, Reference};

const G: f64 = 9.81;
const HOLD: &str = "[reference]\nkind = \"hold\"\nq_rad = 0.3\n";
const FLAT: &str = "gravity_m_s2 = [0.0, 0.0, 0.0]\n";

fn last(values: &[f64]) -> f64 {
    values[values.len() - 1]
}

#[test]
fn without_gravity_the_loop_is_the_exact_sampled_double_integrator() {
    let study = rod_study(
        "duration_s = 1.0",
        &format!("[world]\n{FLAT}[start]\nq_rad = 0.31\ndq_rad_s = 0.2\n{HOLD}"),
    );
    let trace = run(&study).trace;
    // J q̈ = τ under zero-order hold, solved exactly; independent of the simulator's integrator.
    let law = gains(&study)[0];
    let (mut state, mut q, mut dq, mut tau) = (JointState::new(), 0.31, 0.2, 0.0);
    let t = 1e-3;
    let reference = Reference { q: 0.3, dq: 0.0, ddq: 0.0 };
    for k in 0..1000 {
        assert!((trace.joints[0].q[k] - q).abs() < 1e-12, "sample {k}");
        assert!((trace.joints[0].dq[k] - dq).abs() < 1e-10, "sample {k}");
        tau = law.update(&mut state, &Measurement { q, dq, tau_applied: tau }, &reference).tau;
        q += t * dq + 0.5 * t * t * tau / ROD_INERTIA;
        dq += t * tau / ROD_INERTIA;
    }
}

#[test]
fn held_torque_is_the_weight_of_rod_and_payload() {
    let payload = "payload = { frame = \"tool\", mass_kg = 0.7, com_m = [0.1, 0.0, 0.0], \
                   inertia_kg_m2 = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0] }\n";
    let study = rod_study("duration_s = 3.0", &format!("[world]\n{payload}{HOLD}"));
    let joint = &run(&study).trace.joints[0];
    // Positive angles about +y turn +x towards −z: holding the weight up takes negative torque.
    let weight = -(2.0 * 0.5 + 0.7 * 1.1) * G * 0.3_f64.cos();
    assert!((last(&joint.tau_applied) - weight).abs() < 1e-6, "{}", last(&joint.tau_applied));
    assert!((last(&joint.phi_hat) - weight).abs() < 1e-6);
    assert!((last(&joint.phi) - weight).abs() < 1e-6);
    assert!(last(&joint.e).abs() < 1e-9);
}

#[test]
fn sliding_at_constant_speed_costs_viscous_and_coulomb_friction() {
    let world = format!(
        "[world]\n{FLAT}coulomb_extra_nm = 0.4\nviscous_extra_nm_s_rad = 0.6\nsubsteps = 4\n"
    );
    let motion = "[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n[[reference.sine]]\n\
                  amplitude_rad = 2.0\nfrequency_hz = 0.05\nphase_rad = 0.0\n";
    let study = rod_study("duration_s = 2.0", &format!("{world}{motion}"));
    let trace = run(&study).trace;
    let joint = &trace.joints[0];
    let k = joint.q.len() - 1;
    let expected = 0.4 + 0.6 * joint.dq[k] + ROD_INERTIA * joint.ddq[k];
    assert!(joint.dq[k] > 0.1, "the joint must slide: {}", joint.dq[k]);
    assert!((joint.tau_applied[k] - expected).abs() < 1e-4, "{} {expected}", joint.tau_applied[k]);
    // φ = τ − M̄ q̈ is friction alone, as M̄ is the inertia.
    assert!((joint.phi[k] - (0.4 + 0.6 * joint.dq[k])).abs() < 1e-4);
}

#[test]
fn transport_delay_is_whole_samples() {
    for delay in [0, 1, 3] {
        let study = rod_study(
            "duration_s = 0.3",
            &format!("[loop]\ndelay_samples = {delay}\n[start]\nq_rad = 0.31\n{HOLD}"),
        );
        let joint = &run(&study).trace.joints[0];
        for k in 0..200 {
            assert_eq!(joint.tau_applied[k + delay].to_bits(), joint.tau_command[k].to_bits());
        }
        assert!(joint.tau_applied[..delay].iter().all(|tau| tau.to_bits() == 0));
    }
    assert!(Delay::<f64>::new(9).is_err());
}

#[test]
fn drive_follows_its_first_order_law() {
    let hz: f64 = 40.0;
    let study = rod_study(
        "duration_s = 0.2",
        &format!("[world]\ndrive_bandwidth_hz = {hz}\n[start]\nq_rad = 0.31\n{HOLD}"),
    );
    let joint = &run(&study).trace.joints[0];
    let (rate, t) = (core::f64::consts::TAU * hz, 1e-3);
    let mut tau = 0.0;
    for k in 0..200 {
        let demand = joint.tau_command[k];
        // ∫₀ᵀ of the exact exponential, by 2000 midpoints.
        let mean = (0..2000)
            .map(|i| demand + (tau - demand) * (-rate * t * (f64::from(i) + 0.5) / 2000.0).exp())
            .sum::<f64>()
            / 2000.0;
        assert!((joint.tau_applied[k] - mean).abs() < 1e-6 * (1.0 + mean.abs()), "sample {k}");
        tau = demand + (tau - demand) * (-rate * t).exp();
    }
}

#[test]
fn encoder_rounds_to_its_quanta_and_velocity_is_their_difference() {
    let sensor = "[sensor]\nencoder_bits = 14\nvelocity = \"differenced\"\n";
    let study = rod_study("duration_s = 0.3", &format!("{sensor}[start]\nq_rad = 0.32\n{HOLD}"));
    let joint = &run(&study).trace.joints[0];
    let quantum = core::f64::consts::TAU / 16384.0;
    for k in 1..300 {
        let count = joint.q_measured[k] / quantum;
        assert!((count - count.round()).abs() < 1e-9);
        assert!((joint.q_measured[k] - joint.q[k]).abs() <= 0.5 * quantum + 1e-15);
        let difference = (joint.q_measured[k] - joint.q_measured[k - 1]) * 1e3;
        assert!((joint.dq_measured[k] - difference).abs() < 1e-9);
    }
}

#[test]
fn velocity_filter_is_the_sampled_first_order_low_pass() {
    let sensor = "[sensor]\nvelocity = \"measured\"\nvelocity_filter_hz = 50.0\n";
    let study = rod_study("duration_s = 0.2", &format!("{sensor}[start]\nq_rad = 0.32\n{HOLD}"));
    let joint = &run(&study).trace.joints[0];
    let pole = (-core::f64::consts::TAU * 50.0 * 1e-3).exp();
    for k in 1..200 {
        let expected = pole * joint.dq_measured[k - 1] + (1.0 - pole) * joint.dq[k];
        assert!((joint.dq_measured[k] - expected).abs() < 1e-12);
    }
}

#[test]
fn a_push_is_felt_for_as_long_as_it_lasts() {
    let push =
        "[[world.push]]\njoint = \"hinge\"\ntorque_nm = 3.0\nstart_s = 0.5\nduration_s = 0.25\n";
    let study = rod_study("duration_s = 1.0", &format!("[world]\n{FLAT}{push}{HOLD}"));
    let trace = run(&study).trace;
    let joint = &trace.joints[0];
    for k in 0..1000 {
        // J q̈ = τ + push, so φ = τ − M̄ q̈ = −push.
        let expected = if (500..750).contains(&k) { -3.0 } else { 0.0 };
        assert!((joint.phi[k] - expected).abs() < 1e-9, "sample {k}: {}", joint.phi[k]);
    }
}

#[test]
fn a_run_that_diverges_stops_and_says_where() {
    // M̄ twenty times the inertia at one sample of delay: far below the window.
    let mut study = rod_study(
        "duration_s = 5.0",
        &format!("[loop]\ndelay_samples = 1\n[start]\nq_rad = 0.31\n{HOLD}"),
    );
    study.gains.as_mut().unwrap().inertia = vec![20.0 * ROD_INERTIA];
    study.control.torque_max = None;
    study.spec.error_bound = Some(vec![1e-3]);
    let outcome = run(&study);
    let divergence = outcome.divergence.unwrap();
    assert_eq!(divergence.joint, "hinge");
    assert!(divergence.t < 5.0 && outcome.trace.len() < 5000);
    assert!(!phihat_sim::Metrics::of(&outcome.trace, &study).within_spec);
}

#[test]
fn friction_too_stiff_for_the_step_is_refused_with_the_step_it_needs() {
    let world = "[world]\ncoulomb_extra_nm = 5.0\n";
    let study = rod_study("duration_s = 1.0", &format!("{world}{HOLD}"));
    let error = phihat_sim::Simulation::new(&study, &gains(&study)).unwrap_err().to_string();
    // λT/2 = 5/(1e-3·0.52)·1e-3/2 = 4.8.
    assert!(error.contains("hinge") && error.contains("5 or more"), "{error}");
}
