//! The test vectors in `vectors/controller.txt`: this crate, its C library and its Python package answer them with the
//! same bits. What the numbers should be is tested elsewhere; here they are written down
//! (`PHIHAT_BLESS=1 cargo test -p phihat vectors`) and kept.

use std::fmt::Write as _;
use std::path::Path;

use phihat::{
    Command, Form, InnovationSection, JointDesign, JointGains, JointState, Limits, Measurement,
    PositionDesign, Reference, update_joints,
};

const HEADER: &str = "\
# Test vectors of the controller, by tests/vectors.rs. Decimals read back to the same bits.
# case NAME JOINTS PERIOD_S
# joint FORM ORDER INERTIA KP KD A_0 ... A_(ORDER-1) TORQUE_MAX TORQUE_RATE_MAX       one line per joint
# joint positions ORDER INERTIA KP KD CORRECTION_0 ... CORRECTION_(ORDER+1)           of a law from positions, likewise;
#       VELOCITY_CORRECTION_0 ... VELOCITY_CORRECTION_(ORDER+1)                       all zero: the velocity is not used
#       SHARE DELAY_SAMPLES TORQUE_MAX TORQUE_RATE_MAX                                (one line, broken here)
# joint filtered ORDER ... SHARE DELAY_SAMPLES                                        the same with an innovation filter
#       SECTIONS C_0 C_1 B_0 B_1 ... TORQUE_MAX TORQUE_RATE_MAX                       of so many sections; 0: none
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

/// Of laws from positions: order, whether a velocity corrects, whether limits act. The joints have a delay each.
const SEEN: [(&str, usize, bool, bool); 7] = [
    ("positions_1", 1, false, false),
    ("positions_1_velocity", 1, true, true),
    ("positions_2", 2, false, true),
    ("positions_2_velocity", 2, true, false),
    ("positions_3", 3, false, true),
    ("positions_3_velocity", 3, true, true),
    ("positions_resumed", 2, false, true),
];

const DELAYS: [usize; 3] = [0, 1, 3];

/// Likewise of laws with an innovation filter; the joints have as many sections each.
const FILTERED: [(&str, usize, bool, bool); 3] = [
    ("filtered_1", 1, false, false),
    ("filtered_3_velocity", 3, true, true),
    ("filtered_resumed", 2, false, true),
];

const SECTIONS: [usize; 3] = [1, 2, 0];

/// Of observers of each order, in time units of a sample, with poles at 0.70 to 0.80.
const CORRECTIONS: [&[f64]; 3] = [
    &[0.58, 0.162, -0.015],
    &[0.698, 0.302, -0.0605, -0.0042],
    &[0.764, 0.422, -0.127, -0.0175, -0.000_924],
];

/// Likewise by velocity; little enough that the observer stays stable.
const VELOCITY_CORRECTION: [f64; 5] = [0.1, 0.2, -0.015, -0.0008, -0.000_02];

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

fn limits(draw: &mut Draw, limited: bool) -> [f64; 2] {
    let drawn = [draw.within(5.0, 90.0), draw.within(500.0, 4000.0)];
    if limited { drawn } else { [f64::INFINITY; 2] }
}

fn checked(of: [f64; 2]) -> Limits<f64> {
    let [torque, rate] = of.map(|limit| limit.is_finite().then_some(limit));
    Limits::new(torque, rate, 1e-3).unwrap()
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
    let limits = limits(draw, limited);
    let mut values = vec![inertia, kp, kd];
    values.extend(&a);
    values.extend(limits);
    line(text, &format!("joint {} {order}", word(form)), &values);
    let design = JointDesign { inertia, kp, kd, a: &a, period: 1e-3, form };
    JointGains::new(&design).unwrap().with_limits(checked(limits))
}

/// A law from positions, and what its line begins with. The first number that corrects is in \[1\], the
/// others in as many \[1/s\] more each.
fn seen(
    draw: &mut Draw,
    (order, delay): (usize, usize),
    velocity: bool,
) -> (Vec<f64>, JointGains<f64>) {
    let (inertia, w) = (draw.within(0.05, 3.0), draw.within(5.0, 30.0));
    let (kp, kd, share) = (w * w, 2.0 * w, draw.within(0.2, 1.0));
    let mut scaled = |of: &[f64], first: f64| {
        let mut unit = first;
        let mut values = Vec::new();
        for value in of {
            values.push(value * draw.within(0.95, 1.05) * unit);
            unit *= 1e3;
        }
        values
    };
    let correction = scaled(CORRECTIONS[order - 1], 1.0);
    let states = correction.len();
    let on_velocity =
        if velocity { scaled(&VELOCITY_CORRECTION[..states], 1e-3) } else { vec![0.0; states] };
    let mut values = vec![inertia, kp, kd];
    values.extend(&correction);
    values.extend(&on_velocity);
    values.extend([share, delay as f64]);
    let design = PositionDesign {
        inertia,
        kp,
        kd,
        correction: &correction,
        velocity_correction: &on_velocity,
        share,
        delay,
        period: 1e-3,
    };
    (values, JointGains::from_positions(&design).unwrap())
}

fn seeing(
    text: &mut String,
    draw: &mut Draw,
    of: (usize, usize),
    velocity: bool,
    limited: bool,
) -> JointGains<f64> {
    let (mut values, gains) = seen(draw, of, velocity);
    let limits = limits(draw, limited);
    values.extend(limits);
    line(text, &format!("joint positions {}", of.0), &values);
    gains.with_limits(checked(limits))
}

/// The same with an innovation filter of so many sections.
fn filtered(
    text: &mut String,
    draw: &mut Draw,
    of: (usize, usize),
    (sections, velocity): (usize, bool),
    limited: bool,
) -> JointGains<f64> {
    let (mut values, mut gains) = seen(draw, of, velocity);
    let section = |_| {
        let c1 = draw.within(0.1, 0.6);
        let rates = [c1 * draw.within(0.1, 0.9), c1];
        InnovationSection { rates, weights: [draw.within(200.0, 900.0), draw.within(-900.0, 0.0)] }
    };
    let own: Vec<InnovationSection> = (0..sections).map(section).collect();
    values.push(sections as f64);
    for section in &own {
        values.extend(section.rates);
        values.extend(section.weights);
    }
    if !own.is_empty() {
        gains = gains.with_innovation_filter(&own).unwrap();
    }
    let limits = limits(draw, limited);
    values.extend(limits);
    line(text, &format!("joint filtered {}", of.0), &values);
    gains.with_limits(checked(limits))
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

/// One case: a wandering arm, a not-finite sample in the middle, and a take-over in the cases named so.
fn case(
    text: &mut String,
    seed: u64,
    (name, n): (&str, usize),
    joint: impl Fn(&mut String, &mut Draw, usize) -> JointGains<f64>,
) {
    let mut draw = Draw(seed);
    writeln!(text, "case {name} {n} 0.001").unwrap();
    let gains: Vec<_> = (0..n).map(|i| joint(text, &mut draw, i)).collect();
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
        if k == 10 && name.ends_with("_resumed") {
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
    for (i, (name, form, order, n, limited)) in CASES.into_iter().enumerate() {
        let own =
            |text: &mut String, draw: &mut Draw, _: usize| joint(text, draw, form, order, limited);
        case(&mut text, 1000 + i as u64, (name, n), own);
    }
    let torque_observers = text.len();
    for (i, (name, order, velocity, limited)) in SEEN.into_iter().enumerate() {
        let own = |text: &mut String, draw: &mut Draw, joint: usize| {
            seeing(text, draw, (order, DELAYS[joint]), velocity, limited)
        };
        case(&mut text, 2000 + i as u64, (name, DELAYS.len()), own);
    }
    for (i, (name, order, velocity, limited)) in FILTERED.into_iter().enumerate() {
        let own = |text: &mut String, draw: &mut Draw, joint: usize| {
            filtered(text, draw, (order, DELAYS[joint]), (SECTIONS[joint], velocity), limited)
        };
        case(&mut text, 3000 + i as u64, (name, DELAYS.len()), own);
    }
    for part in [&text[..torque_observers], &text[torque_observers..]] {
        for flag in ["1", "2", "4"] {
            let met =
                part.lines().any(|l| l.starts_with("answer") && l.split(' ').any(|w| w == flag));
            assert!(met, "flag {flag} occurs in no vector");
        }
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
