//! The test vectors in `vectors/controller.txt`: this crate, its C library and its Python package answer them with the
//! same bits. What the numbers should be is tested elsewhere; here they are written down
//! (`PHIHAT_BLESS=1 cargo test -p phihat --test vectors`) and kept.

#![allow(clippy::unwrap_used, reason = "a test's helpers may")]

use std::fmt::Write as _;
use std::path::Path;

use phihat::{
    Command, Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
    update_joints,
};

const HEADER: &str = "\
# Test vectors of the controller, by tests/vectors.rs. Decimals read back to the same bits.
# case NAME JOINTS PERIOD_S
# joint FORM ORDER INERTIA KP KD A_0 ... A_(ORDER-1) TORQUE_MAX TORQUE_RATE_MAX       one line per joint
# sample Q DQ TAU_APPLIED Q_DES DQ_DES DDQ_DES      each one number per joint; what goes in
# answer TAU PHI_HAT FLAGS                          flags: 1 saturated, 2 rate limited, 4 refused
# resume Q DQ TAU_APPLIED Q_DES DQ_DES DDQ_DES TAU  takes over at a torque; answers nothing
";

const SAMPLES: usize = 40;

/// Form, order, joints, limits.
const CASES: [(&str, Form, usize, usize, bool); 8] = [
    ("observer_1", Form::Observer, 1, 1, false),
    ("observer_2", Form::Observer, 2, 1, false),
    ("observer_3", Form::Observer, 3, 2, true),
    ("observer_4", Form::Observer, 4, 3, false),
    ("arm", Form::Observer, 2, 7, true),
    ("arm_resumed", Form::Observer, 1, 7, true),
    ("literal_1", Form::Literal, 1, 2, false),
    ("literal_2", Form::Literal, 2, 3, true),
];

/// Numbers in [0, 1) from a counter (SplitMix64): no state but the count.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

fn line(text: &mut String, verb: &str, values: &[f64]) {
    text.push_str(verb);
    for value in values {
        write!(text, " {value}").unwrap();
    }
    text.push('\n');
}

fn word(form: Form) -> &'static str {
    if form == Form::Literal { "literal" } else { "observer" }
}

/// Coefficients of `(s + w)^m`, low to high, without the leading 1: stable for any `w`.
fn coefficients(w: f64, order: usize) -> Vec<f64> {
    let mut a = vec![1.0];
    for _ in 0..order {
        let mut next = vec![0.0; a.len() + 1];
        for (i, c) in a.iter().enumerate() {
            next[i] += w * c;
            next[i + 1] += c;
        }
        a = next;
    }
    a.pop();
    a
}

fn joint(
    text: &mut String,
    draw: &mut Draw,
    form: Form,
    order: usize,
    limited: bool,
) -> JointGains<f64> {
    let (inertia, w) = (draw.within(0.05, 3.0), draw.within(5.0, 30.0));
    let a = coefficients(draw.within(20.0, 90.0), order);
    let (kp, kd) = (w * w, 2.0 * w);
    let (torque, rate) = (draw.within(5.0, 90.0), draw.within(500.0, 4000.0));
    let (torque, rate) = if limited { (Some(torque), Some(rate)) } else { (None, None) };
    let mut values = vec![inertia, kp, kd];
    values.extend(&a);
    values.extend([torque, rate].map(|limit| limit.unwrap_or(f64::INFINITY)));
    line(text, &format!("joint {} {order}", word(form)), &values);
    let design = JointDesign { inertia, kp, kd, a: &a, period: 1e-3, form };
    let limits = Limits::new(torque, rate, 1e-3).unwrap();
    JointGains::new(&design).unwrap().with_limits(limits)
}

fn columns(measurements: &[Measurement<f64>], references: &[Reference<f64>]) -> Vec<f64> {
    let mut values: Vec<f64> = measurements.iter().map(|m| m.q).collect();
    values.extend(measurements.iter().map(|m| m.dq));
    values.extend(measurements.iter().map(|m| m.tau_applied));
    values.extend(references.iter().map(|r| r.q));
    values.extend(references.iter().map(|r| r.dq));
    values.extend(references.iter().map(|r| r.ddq));
    values
}

fn flags(command: &Command<f64>) -> f64 {
    let s = command.status;
    f64::from(u8::from(s.saturated))
        + f64::from(2 * u8::from(s.rate_limited))
        + f64::from(4 * u8::from(s.refused))
}

/// One case: a wandering arm, a not-finite sample in the middle, and a take-over in the case named so.
fn case(
    text: &mut String,
    seed: u64,
    (name, form, order, n, limited): (&str, Form, usize, usize, bool),
) {
    let mut draw = Draw(seed);
    writeln!(text, "case {name} {n} 0.001").unwrap();
    let gains: Vec<_> = (0..n).map(|_| joint(text, &mut draw, form, order, limited)).collect();
    let mut states = vec![JointState::new(); n];
    let mut commands = vec![Command::default(); n];
    let mut measurements = vec![Measurement::<f64>::default(); n];
    let mut references = vec![Reference::<f64>::default(); n];
    for k in 0..SAMPLES {
        for i in 0..n {
            let (m, r) = (&mut measurements[i], &mut references[i]);
            let before = if m.dq.is_finite() { m.dq } else { 0.0 };
            m.dq = before + draw.within(-0.05, 0.05);
            m.q += 1e-3 * m.dq;
            m.tau_applied = commands[i].tau + draw.within(-0.2, 0.2);
            r.ddq = draw.within(-2.0, 2.0);
            r.dq += 1e-3 * r.ddq;
            r.q += 1e-3 * r.dq;
        }
        if k == SAMPLES / 2 {
            measurements[n - 1].dq = f64::NAN;
        }
        if k == 10 && name == "arm_resumed" {
            let tau: Vec<f64> = (0..n).map(|_| draw.within(-4.0, 4.0)).collect();
            for i in 0..n {
                assert!(gains[i].resume(&mut states[i], &measurements[i], &references[i], tau[i]));
            }
            line(text, "resume", &[columns(&measurements, &references), tau].concat());
        }
        line(text, "sample", &columns(&measurements, &references));
        update_joints(&gains, &mut states, &measurements, &references, &mut commands);
        let mut answer: Vec<f64> = commands.iter().map(|c| c.tau).collect();
        answer.extend(commands.iter().map(|c| c.phi_hat));
        answer.extend(commands.iter().map(flags));
        line(text, "answer", &answer);
    }
}

#[test]
fn the_vectors_are_what_this_crate_answers() {
    let mut text = HEADER.to_owned();
    for (i, of) in CASES.into_iter().enumerate() {
        case(&mut text, 1000 + i as u64, of);
    }
    for flag in ["1", "2", "4"] {
        let met = text.lines().any(|l| l.starts_with("answer") && l.split(' ').any(|w| w == flag));
        assert!(met, "flag {flag} occurs in no vector");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/controller.txt");
    if std::env::var_os("PHIHAT_BLESS").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, &text).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    let changed = kept.lines().zip(text.lines()).position(|(kept, now)| kept != now);
    let where_ = changed.map(|line| line + 1);
    assert_eq!(where_, None, "line of {} that this crate answers differently", path.display());
    assert_eq!(kept.len(), text.len());
}
