//! A tick of the supervised controller touches no new memory. Wrong if a million ticks after warm-up cause one
//! page fault. (One test in its file: page faults are counted for the whole process.)
#![cfg(target_os = "linux")]

use phihat::{
    Form, JointDesign, JointGains, JointOptions, Limits, Measurement, ModeRequest, Options,
    Reference, Request, Sample, Stamp, Supervisor, SupervisorState,
};

/// Page faults of this thread so far, minor and major: fields 10 and 12 of `stat`.
fn page_faults() -> u64 {
    let text = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
    // The second field, a name in parentheses, may hold spaces.
    let fields: Vec<&str> = text.rsplit_once(')').unwrap().1.split_whitespace().collect();
    fields[7].parse::<u64>().unwrap() + fields[9].parse::<u64>().unwrap()
}

fn ticks(
    arm: &Supervisor<f64, 7>,
    state: &mut SupervisorState<f64, 7>,
    from: u64,
    count: u64,
) -> f64 {
    let mut sum = 0.0;
    for k in from..from + count {
        let t_ns = k * 1_000_000;
        let q = 0.3 + 1e-7 * (k % 1000) as f64;
        let joints = [Measurement { q, dq: 1e-4, tau_applied: 1.0 }; 7];
        let references = [Reference { q: 0.3, dq: 0.0, ddq: 0.0 }; 7];
        // Every now and then a sample is lost, repeated or not a number.
        let joints =
            if k % 997 == 0 { [Measurement { q: f64::NAN, ..joints[0] }; 7] } else { joints };
        let sequence = if k % 1009 == 0 { k - 1 } else { k };
        let sample = Sample { stamp: Stamp { sequence, t_ns }, now_ns: t_ns, joints: &joints };
        let mode = match k {
            0..10 => ModeRequest::Idle,
            10 => ModeRequest::Arm,
            11 => ModeRequest::Hold,
            _ => ModeRequest::Track,
        };
        let request = Request { mode, references: &references, preset: None, feed_forward: None };
        sum += arm.step(state, &sample, &request).commands[0].tau;
    }
    sum
}

#[test]
fn f28_a_million_ticks_cause_no_page_fault() {
    let design = JointDesign {
        inertia: 0.8,
        kp: 400.0,
        kd: 40.0,
        a: &[4900.0, 140.0],
        period: 1e-3,
        form: Form::Observer,
    };
    let limits = Limits::new(Some(87.0), Some(1000.0), 1e-3).unwrap();
    let gains = JointGains::<f64>::new(&design).unwrap().with_limits(limits);
    let joint = JointOptions {
        velocity_max: Some(2.5),
        error_stop: Some(0.1),
        frozen_travel: Some(1e-3),
        ..Default::default()
    };
    let arm = Supervisor::new([gains; 7], &[joint; 7], &Options::new(1_000_000)).unwrap();
    let mut state = SupervisorState::new();
    let mut sum = ticks(&arm, &mut state, 1, 10_000);
    // What else happens to the process may show once: the least of three counts.
    let faults = (0..3_u64).map(|round| {
        let before = page_faults();
        sum += ticks(&arm, &mut state, 10_001 + round * 1_000_000, 1_000_000);
        page_faults() - before
    });
    let least = faults.min();
    assert!(sum.is_finite() && page_faults() > 0, "page faults are counted");
    assert_eq!(least, Some(0), "page faults in a million ticks");
}
