//! The seam for other controllers.

use crate::support::read;
use phihat::{Form, JointDesign, JointGains};
use phihat_sim::{BLOCK, Driver, Moment, SimError, Simulation, Stepped, Trace, TraceWriter};
use phihat_study::Study;

const INERTIA: [f64; 3] = [0.42, 0.18, 0.14];

fn study(limits: &str) -> Study {
    let text = format!(
        "duration_s = 1.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 60.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n[spec]\nsettle_s = 0.5\n\
         [loop]\ndelay_samples = 1\n{limits}\n\
         [reference]\nkind = \"sines\"\ncenter = \"ready\"\n\
         [[reference.sine]]\namplitude_rad = 0.3\nfrequency_hz = 0.5\n"
    );
    read(&text)
}

/// PD plus acceleration, as one would write it outside of the project.
#[derive(Debug)]
struct Outside {
    spoil: Option<f64>,
}

impl Driver for Outside {
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (m, r) = (&moment.sample.joints[i], &moment.references[i]);
            *tau = INERTIA[i] * (r.ddq - 40.0 * (m.dq - r.dq) - 400.0 * (m.q - r.q));
        }
        if let Some(from) = self.spoil
            && moment.t > from
        {
            tau[1] = f64::NAN;
        }
    }
}

#[test]
fn a_driver_sees_and_moves_what_the_law_does() {
    // With a_0 next to nothing the law of order 1 is PD plus acceleration.
    let study = study("");
    let gains = INERTIA.map(|inertia| {
        let (a, form) = (&[1e-12][..], Form::Observer);
        JointGains::new(&JointDesign { inertia, kp: 400.0, kd: 40.0, a, period: 1e-3, form })
            .unwrap()
    });
    let law = Simulation::new(&study, &gains).unwrap().run(|_| {}).trace;
    let driver = Box::new(Outside { spoil: None });
    let own = Simulation::driven(&study, driver, &INERTIA).unwrap().run(|_| {}).trace;
    for (law, own) in law.joints.iter().zip(&own.joints) {
        let far = law.e.iter().zip(&own.e).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let largest = law.e.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        assert!(largest > 1e-3 && far < 1e-9, "{}: {far:e} of {largest:e}", law.name);
    }
}

#[test]
fn the_limits_of_the_study_act_on_a_driver_and_nan_is_no_torque() {
    let study = study("torque_max_nm = 2.0\ntorque_rate_max_nm_s = 100.0");
    let driver = Box::new(Outside { spoil: Some(0.5) });
    let trace = Simulation::driven(&study, driver, &INERTIA).unwrap().run(|_| {}).trace;
    for joint in &trace.joints {
        assert!(joint.tau_command.iter().all(|tau| tau.abs() <= 2.0), "{}", joint.name);
        let step = joint.tau_command.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        assert!(step <= 0.1 + 1e-12, "{}: {step}", joint.name);
        assert!(joint.saturated.iter().any(|s| *s) || joint.rate_limited.iter().any(|s| *s));
    }
    let held = trace.joints[1].tau_command[501];
    assert!(trace.joints[1].tau_command[501..].iter().all(|tau| (tau - held).abs() < 1e-300));
}

#[test]
fn a_loop_that_is_taken_by_the_hand_goes_where_a_driver_goes() {
    let study = study("torque_max_nm = 2.0\ntorque_rate_max_nm_s = 100.0");
    let driver = Box::new(Outside { spoil: Some(0.5) });
    let whole = Simulation::driven(&study, driver, &INERTIA).unwrap().run(|_| {});
    let mut run = Stepped::new(&study, &INERTIA).unwrap();
    assert!(matches!(run.step(&[0.0; 2]), Err(SimError::JointCount { gains: 2, robot: 3 })));
    while !run.is_over() {
        let law = |i: usize| {
            let (m, r) = (&run.sensed()[i], &run.wanted()[i]);
            let spoiled = i == 1 && run.t() > 0.5;
            let tau = INERTIA[i] * (r.ddq - 40.0 * (m.dq - r.dq) - 400.0 * (m.q - r.q));
            if spoiled { f64::NAN } else { tau }
        };
        let tau = [law(0), law(1), law(2)];
        run.step(&tau).unwrap();
    }
    run.step(&[1.0; 3]).unwrap();
    let (trace, ended) = run.end();
    assert!(trace == whole.trace, "another trace");
    assert_eq!((ended.divergence, ended.told_max), (whole.divergence, whole.told_max));
}

/// Wrong if a sample or an integral were lost where the record is taken in parts, or if room were reserved
/// for the whole run.
#[test]
fn a_record_that_is_taken_in_parts_is_that_of_the_whole() {
    let mut study = study("");
    study.duration = 6.0;
    let mut whole = Stepped::new(&study, &INERTIA).unwrap();
    let mut run = Stepped::in_blocks(&study, &INERTIA).unwrap();
    assert!(whole.trace().t_ns.capacity() >= 6000 && run.trace().t_ns.capacity() == BLOCK);
    let mut parts = TraceWriter::new(Vec::new());
    let mut room = Trace::default();
    while !run.is_over() {
        let tau = [0.3 * run.t().sin(), 0.2, -0.1];
        run.step(&tau).unwrap();
        whole.step(&tau).unwrap();
        if run.trace().len() == 700 {
            if room.joints.is_empty() {
                room = Trace::new(&names(&study), study.control.period_ns, 700);
            }
            room = run.hand_over(room);
            parts.block(&room).unwrap();
        }
    }
    let (rest, ended) = run.end();
    assert_eq!(rest.len(), 6000 % 700);
    parts.block(&rest).unwrap();
    let (trace, whole_ended) = whole.end();
    let mut file = Vec::new();
    trace.write_csv(&mut file).unwrap();
    assert!(parts.finish().unwrap() == file, "another record");
    assert_eq!(ended.told_max, whole_ended.told_max);
}

fn names(study: &Study) -> Vec<String> {
    study.robot.joint_names()
}
