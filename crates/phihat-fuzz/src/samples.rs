//! The controller under samples that no robot sends: torque stays a number inside its limits, and a refused sample
//! leaves nothing behind.

use phihat::{
    Form, JointDesign, JointGains, JointOptions, JointState, Limits, Measurement, ModeRequest,
    Options, PositionDesign, Reference, Sample, Stamp, Supervisor, SupervisorState,
};

use crate::choices::Choices;

const TORQUE: f64 = 87.0;
const RATE: f64 = 1000.0;
const PERIOD: f64 = 1e-3;

/// Numbers that break things, and those of an arm at work.
const VALUES: [f64; 24] = [
    0.0,
    -0.0,
    0.1,
    -0.2,
    0.3,
    1.0,
    -1.0,
    3.2,
    1e-3,
    -1e-3,
    10.0,
    -50.0,
    1e6,
    -1e9,
    1e100,
    1e305,
    -1e305,
    f64::MAX,
    f64::MIN,
    5e-324,
    1e-308,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// A number: most are an arm's; one in four anything.
fn value(choices: &mut Choices<'_>) -> Option<f64> {
    let byte = choices.byte()?;
    let small = byte as f64 / 256.0 - 0.5;
    Some(if byte % 4 > 0 { small } else { VALUES[byte / 4 % VALUES.len()] })
}

fn gains(order: usize, form: Form) -> Option<JointGains<f64>> {
    let a: &[f64] = match order % 4 {
        0 => &[70.0],
        1 => &[4900.0, 140.0],
        2 => &[125_000.0, 7500.0, 150.0],
        _ => &[2_560_000.0, 256_000.0, 9600.0, 160.0],
    };
    let design = JointDesign { inertia: 1.0, kp: 400.0, kd: 40.0, a, period: PERIOD, form };
    let limits = Limits::new(Some(TORQUE), Some(RATE), PERIOD).ok()?;
    Some(JointGains::new(&design).ok()?.with_limits(limits))
}

/// A law from positions, its observer's sampled poles all at 0.9.
fn seen(order: usize, delay: usize) -> Option<JointGains<f64>> {
    // Per sample, per sample squared and so on.
    let placed: &[f64] = match order % 3 {
        0 => &[0.271, 0.0285, -0.001],
        1 => &[0.3439, 0.054_175, -0.003_85, -0.0001],
        _ => &[0.409_51, 0.085_856_25, -0.009_267_5, -0.000_485, -0.000_01],
    };
    let mut correction = placed.to_vec();
    let mut scale = 1.0;
    for entry in &mut correction {
        *entry *= scale;
        scale /= PERIOD;
    }
    let design = PositionDesign {
        inertia: 1.0,
        kp: 400.0,
        kd: 40.0,
        correction: &correction,
        velocity_correction: &[],
        share: 0.4,
        delay: delay % 5,
        period: PERIOD,
    };
    let limits = Limits::new(Some(TORQUE), Some(RATE), PERIOD).ok()?;
    Some(JointGains::from_positions(&design).ok()?.with_limits(limits))
}

/// The bare law of one joint.
///
/// # Panics
///
/// A torque is not a number or outside its limits, or a refused sample changed something.
pub fn law(bytes: &[u8]) {
    let mut choices = Choices::of(bytes);
    let Some(first) = choices.byte() else { return };
    let form = if first & 4 > 0 { Form::Literal } else { Form::Observer };
    let drawn = if first & 8 > 0 { seen(first, first >> 4) } else { gains(first, form) };
    let Some(gains) = drawn else { panic!("good gains") };
    let mut state = JointState::new();
    let mut last = 0.0_f64;
    let mut next = || {
        let [q, dq, tau, qd, vd, ad] = [
            value(&mut choices)?,
            value(&mut choices)?,
            value(&mut choices)?,
            value(&mut choices)?,
            value(&mut choices)?,
            value(&mut choices)?,
        ];
        Some((Measurement { q, dq, tau_applied: tau }, Reference { q: qd, dq: vd, ddq: ad }))
    };
    while let Some((measurement, reference)) = next() {
        let before = state;
        let command = gains.update(&mut state, &measurement, &reference);
        assert!(command.tau.is_finite(), "{measurement:?} {reference:?}: {command:?}");
        assert!(command.tau.abs() <= TORQUE, "{command:?}");
        if command.status.refused {
            assert!(
                format!("{before:?}") == format!("{state:?}"),
                "a refused sample left something"
            );
        } else {
            assert!(
                (command.tau - last).abs() <= RATE * PERIOD * (1.0 + 1e-9) + 1e-9,
                "{last} {command:?}"
            );
        }
        last = command.tau;
    }
    // Whatever came: a good sample is answered.
    let rest = Measurement { q: 0.0, dq: 0.0, tau_applied: last };
    let command = gains.update(&mut state, &rest, &Reference::default());
    assert!(!command.status.refused, "a good sample is refused: {state:?}");
}

/// An arm of two joints behind its supervisor.
///
/// # Panics
///
/// A torque is not a number or outside its limits, or changes faster than its rate while the law runs.
pub fn supervisor(bytes: &[u8]) {
    let mut choices = Choices::of(bytes);
    let Some(first) = choices.byte() else { return };
    let drawn = if first & 4 > 0 { seen(first, first >> 3) } else { gains(first, Form::Observer) };
    let Some(gains) = drawn else { panic!("good gains") };
    let options = JointOptions {
        velocity_max: (first & 8 > 0).then_some(3.0),
        error_stop: (first & 16 > 0).then_some(0.5),
        frozen_travel: (first & 32 > 0).then_some(0.01),
        dead_zone: (first & 64 > 0).then_some(1e-3),
        oscillation: (first & 128 > 0).then_some(3.0),
        ..Default::default()
    };
    let arm = Supervisor::new([gains; 2], &[options; 2], &Options::new(1_000_000));
    let Ok(arm) = arm else { panic!("good options") };
    let mut state = SupervisorState::new();
    let (mut now, mut sequence) = (0_u64, 0_u64);
    while let Some(kind) = choices.byte() {
        let mode = [
            ModeRequest::Idle,
            ModeRequest::Arm,
            ModeRequest::Hold,
            ModeRequest::Track,
            ModeRequest::Stop,
        ][kind % 5];
        let clock = choices.byte_or_0();
        now = match clock % 8 {
            6 => u64::MAX - now,
            7 => now.wrapping_sub(1 << (clock / 8)),
            _ => now.wrapping_add(1_000_000),
        };
        sequence =
            if clock % 16 == 15 { sequence.wrapping_mul(7) } else { sequence.wrapping_add(1) };
        let mut value = || value(&mut choices).unwrap_or(0.0);
        let joints =
            [(); 2].map(|()| Measurement { q: value(), dq: value(), tau_applied: value() });
        let references = [(); 2].map(|()| Reference { q: value(), dq: value(), ddq: value() });
        let preset = [value(), value()];
        let fed = if kind & 32 > 0 { [value(), value()] } else { [0.0; 2] };
        let feed_forward = (kind & 32 > 0).then_some(&fed[..if kind & 128 > 0 { 1 } else { 2 }]);
        let sample = Sample { stamp: Stamp { sequence, t_ns: now }, now_ns: now, joints: &joints };
        let given = (kind & 64 > 0).then_some(&preset[..]);
        let request =
            phihat::Request { mode, references: &references, preset: given, feed_forward };
        let answer = arm.step(&mut state, &sample, &request);
        for command in answer.commands {
            assert!(command.tau.is_finite() && command.tau.abs() <= TORQUE, "{answer:?}");
        }
    }
}
