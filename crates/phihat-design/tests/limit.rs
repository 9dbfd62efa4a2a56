//! The limit of linear laws: figures of another solver in another language; the law of the result, played
//! against a joint by itself, and its worst signals; random laws, none of which is below. Wrong if a law were
//! better than the bound from below, or the law of the result not as good as reported.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use crate::sampled_support::{Outside, Random, Rig, plain, record};
use phihat::{
    Form, JointGains, JointState, Measurement, PositionDesign, Reference, VelocitySource,
};
use phihat_design::sampled::LoopModel;
use phihat_design::{JointRecord, Limit, LimitError, LimitRequest, beside_limit, limit};
use phihat_design::{Phi, PhiBasis, PositionObserver};

/// Joint 6 of a Panda at its nominal inertia.
const WRIST: LimitRequest = LimitRequest {
    inertia: 0.6699,
    phi_rate: 2.577,
    phi_jump: 0.3,
    quantum: TAU / 262_144.0,
    torque_change_max: 1.0,
    delay: 1,
    period: 1e-3,
};

#[test]
fn figures_of_another_solver() {
    // The same programme in SciPy, by HiGHS' interior point method; in mrad, to three digits.
    let scaled = |ratio: f64| LimitRequest { inertia: ratio * WRIST.inertia, ..WRIST };
    let shoulder = LimitRequest { inertia: 2.1437, phi_rate: 9.8127, ..WRIST };
    for (request, expected) in [
        (scaled(0.312), 0.126),
        (scaled(3.243), 0.069),
        (shoulder, 0.083),
        (LimitRequest { torque_change_max: 0.5, ..WRIST }, 0.120),
        (LimitRequest { delay: 0, ..WRIST }, 0.075),
        (LimitRequest { delay: 3, ..WRIST }, 0.127),
    ] {
        let found = limit(&request).unwrap();
        println!("{:.6} … {:.6} mrad, {}", 1e3 * found.low_rad, 1e3 * found.high_rad, found.length);
        assert!(found.low_rad <= found.high_rad && found.high_rad < 1.0001 * found.low_rad);
        assert!((1e3 * found.high_rad - expected).abs() < 5.1e-4, "{found:?} {expected}");
        assert!(found.torque_change <= request.torque_change_max);
    }
    let found = limit(&WRIST).unwrap();
    // To seven digits.
    assert!((1e3 * found.low_rad - 0.090_760_2).abs() < 1e-7, "{}", found.low_rad);
    assert!((1e3 * found.high_rad - 0.090_760_2).abs() < 1e-7, "{}", found.high_rad);
}

/// `M q̈ = τ − φ` with both held over a sample, and the torque late by whole samples.
struct Joint {
    request: LimitRequest,
    late: VecDeque<f64>,
    q: f64,
    dq: f64,
}

impl Joint {
    fn new(request: LimitRequest) -> Self {
        Self { request, late: vec![0.0; request.delay].into(), q: 0.0, dq: 0.0 }
    }

    fn step(&mut self, tau: f64, phi: f64) {
        self.late.push_back(tau);
        let ddq = (self.late.pop_front().unwrap() - phi) / self.request.inertia;
        let t = self.request.period;
        self.q += t * self.dq + 0.5 * t * t * ddq;
        self.dq += t * ddq;
    }
}

/// Errors and torques of a joint, given the law, `φ` and the errors of the encoder.
fn play(
    request: LimitRequest,
    mut law: impl FnMut(f64) -> f64,
    phi: &[f64],
    read: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let mut joint = Joint::new(request);
    let mut played = (Vec::new(), Vec::new());
    for (phi, read) in phi.iter().zip(read) {
        let tau = law(joint.q + read);
        played.0.push(joint.q);
        played.1.push(tau);
        joint.step(tau, *phi);
    }
    played
}

/// The law of a limit: its own joint, moved by the torques alone, and `r` on what differs.
fn youla(request: LimitRequest, found: &Limit) -> impl FnMut(f64) -> f64 {
    let mut own = Joint::new(request);
    let mut differences = VecDeque::new();
    let r = found.law.clone();
    move |measured| {
        differences.push_front(measured - own.q);
        let u: f64 = r.iter().zip(&differences).map(|(r, difference)| r * difference).sum();
        own.step(request.inertia * u, 0.0);
        request.inertia * u
    }
}

fn size(signal: &[f64]) -> f64 {
    signal.iter().map(|x| x.abs()).sum()
}

/// `Σ_{i ≤ k}`.
fn summed(signal: &[f64]) -> Vec<f64> {
    let add = |sum: &mut f64, x: &f64| {
        *sum += x;
        Some(*sum)
    };
    signal.iter().scan(0.0, add).collect()
}

/// Differences from sample to sample, from 0.
fn changes(signal: &[f64]) -> Vec<f64> {
    (0..signal.len()).map(|k| signal[k] - if k == 0 { 0.0 } else { signal[k - 1] }).collect()
}

/// Impulse responses with a law: of `e` to φ̇ \[1/(N·m/s)\], φ \[1/(N·m)\] and the encoder, and of the
/// torque's change to the encoder.
struct Impulses {
    ramp: Vec<f64>,
    jump: Vec<f64>,
    read: Vec<f64>,
    change: Vec<f64>,
}

impl Impulses {
    fn of<L: FnMut(f64) -> f64>(
        request: LimitRequest,
        law: impl Fn() -> L,
        samples: usize,
    ) -> Self {
        let mut unit = vec![0.0; samples];
        let none = unit.clone();
        unit[0] = 1.0;
        let (jump, _) = play(request, law(), &unit, &none);
        let (read, tau) = play(request, law(), &none, &unit);
        let ramp = summed(&jump).iter().map(|sum| request.period * sum).collect();
        Self { ramp, jump, read, change: changes(&tau) }
    }

    fn error(&self, request: &LimitRequest) -> f64 {
        size(&self.ramp) * request.phi_rate
            + size(&self.jump) * request.phi_jump
            + size(&self.read) * 0.5 * request.quantum
    }
}

#[test]
fn the_law_found_is_as_good_as_told() {
    for request in [WRIST, LimitRequest { delay: 3, phi_rate: 0.0, ..WRIST }] {
        let found = limit(&request).unwrap();
        let samples = 2 * found.length;
        let impulses = Impulses::of(request, || youla(request, &found), samples);
        // It has ended where it says so. Without φ̇ a law need not integrate, and the sum stays.
        for signal in [&impulses.jump, &impulses.read, &impulses.change] {
            assert!(size(&signal[found.length + 1..]) < 1e-6 * size(signal));
        }
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        if request.phi_rate > 0.0 {
            near(size(&impulses.ramp) * request.inertia, found.ramp);
            near(impulses.error(&request), found.high_rad);
        }
        near(size(&impulses.jump) * request.inertia, found.jump);
        near(size(&impulses.read), found.read);
        let change = 0.5 * request.quantum * size(&impulses.change);
        near(change, found.torque_change);
        assert!(change < 1.000_001 * request.torque_change_max);

        // The signals with the signs of the responses, backwards in time, reach the bound.
        let last = samples - 1;
        let worst = |response: &[f64], most: f64| -> Vec<f64> {
            (0..samples).map(|k| most * response[last - k].signum()).collect()
        };
        let steps = worst(&impulses.ramp, request.phi_rate * request.period);
        let jumps = worst(&impulses.jump, request.phi_jump);
        let phi: Vec<f64> = summed(&steps).iter().zip(&jumps).map(|(a, b)| a + b).collect();
        let read = worst(&impulses.read, 0.5 * request.quantum);
        let (e, _) = play(request, youla(request, &found), &phi, &read);
        near(e[last], found.high_rad);
        let read = worst(&impulses.change, 0.5 * request.quantum);
        let (_, tau) = play(request, youla(request, &found), &vec![0.0; samples], &read);
        near(tau[last] - tau[last - 1], found.torque_change);
    }
}

/// A state feedback on an observer of position, velocity and `φ`, whose torque goes a share of the way per sample.
#[derive(Debug, Clone, Copy)]
struct Observed {
    request: LimitRequest,
    feedback: [f64; 2],
    /// Correction by a position error: position, velocity, `φ/M`.
    correction: [f64; 3],
    share: f64,
}

impl Observed {
    fn law(self) -> impl FnMut(f64) -> f64 {
        let mut own = Joint::new(self.request);
        let (mut phi, mut u) = (0.0, 0.0);
        move |measured| {
            let wrong = measured - own.q;
            own.q += self.correction[0] * wrong;
            own.dq += self.correction[1] * wrong;
            phi -= self.correction[2] * wrong;
            let wanted = phi - self.feedback[0] * own.q - self.feedback[1] * own.dq;
            u += self.share * (wanted - u);
            let m = self.request.inertia;
            own.step(m * u, m * phi);
            m * u
        }
    }
}

/// A number between two, logarithmically even, the same in every run.
fn around(seed: &mut u64, low: f64, high: f64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    low * (high / low).powf((*seed >> 11) as f64 / (1_u64 << 53) as f64)
}

#[test]
fn no_random_law_is_below() {
    // At 250 Hz: responses are short, and the many limits quick.
    let slow = LimitRequest { period: 4e-3, quantum: TAU / 65_536.0, ..WRIST };
    let (mut seed, mut laws, mut least) = (5, 0, f64::INFINITY);
    let all = if std::env::var_os("PHIHAT_ALL").is_some() { 36 } else { 12 };
    while laws < all {
        let request = LimitRequest { delay: laws % 3, ..slow };
        let t = request.period;
        let omega = around(&mut seed, 20.0, 80.0);
        let pole = (-omega * t * around(&mut seed, 1.5, 6.0)).exp();
        let law = Observed {
            request,
            feedback: [omega * omega, omega * around(&mut seed, 1.0, 2.5)],
            correction: [
                1.0 - pole.powi(3),
                1.5 * (1.0 - pole).powi(2) * (1.0 + pole) / t,
                (1.0 - pole).powi(3) / (t * t),
            ],
            share: around(&mut seed, 0.2, 1.0),
        };
        let impulses = Impulses::of(request, || law.law(), 3000);
        // It is a law where its responses die out.
        if size(&impulses.ramp[2500..]) > 1e-9 * size(&impulses.ramp) {
            continue;
        }
        laws += 1;
        let torque_change_max = 0.5 * request.quantum * size(&impulses.change);
        let limit = limit(&LimitRequest { torque_change_max, ..request }).unwrap();
        let ratio = impulses.error(&request) / limit.low_rad;
        assert!(ratio >= 1.0, "{law:?} {ratio}");
        least = f64::min(least, ratio);
    }
    println!("least of {laws} laws: {least:.3} times the limit");
    // If all were far away, this would show nothing.
    assert!(least < 1.5, "{least}");
}

#[test]
fn an_exact_position_leaves_what_happens_before_any_law_acts() {
    for delay in 0..3 {
        let found = limit(&LimitRequest { quantum: 0.0, delay, ..WRIST }).unwrap();
        let (d, t) = (delay as f64 + 1.0, WRIST.period);
        // The fall of d + 1 samples, and as much to come back.
        let fall = t * t * d * d * WRIST.phi_jump / WRIST.inertia;
        assert!(found.low_rad > 0.999 * fall && found.low_rad < 1.02 * fall);
        assert!(found.low_rad <= found.high_rad && found.high_rad < 1.1 * found.low_rad);
        assert!(found.torque_change.abs() < f64::MIN_POSITIVE);
        let fine = limit(&LimitRequest { quantum: 1e-8, delay, ..WRIST }).unwrap();
        assert!(fine.high_rad > found.low_rad);
    }
}

#[test]
fn the_limit_falls_with_the_torque_and_rises_with_the_encoder() {
    let of = |torque_change_max, bits| {
        let quantum = TAU / f64::from(1_u32 << bits);
        limit(&LimitRequest { torque_change_max, quantum, period: 4e-3, ..WRIST }).unwrap()
    };
    assert!(of(2.0, 18).high_rad < of(1.0, 18).low_rad);
    assert!(of(1.0, 18).high_rad < of(1.0, 16).low_rad);
    // Encoder and torque scale together: twice the φ, the step and the change is twice the error.
    let (one, two) = (of(1.0, 17), of(2.0, 16));
    let double =
        LimitRequest { phi_rate: 2.0 * WRIST.phi_rate, phi_jump: 2.0 * WRIST.phi_jump, ..WRIST };
    let quantum = TAU / 65_536.0;
    let two_phi =
        limit(&LimitRequest { torque_change_max: 2.0, quantum, period: 4e-3, ..double }).unwrap();
    assert!((two_phi.high_rad / one.high_rad - 2.0).abs() < 1e-3);
    assert!(two.high_rad < two_phi.low_rad);
}

#[test]
fn bad_input_is_refused_by_name() {
    let refused = |request: LimitRequest| limit(&request).unwrap_err();
    let number = |request: LimitRequest, name: &str| {
        let error = refused(request);
        assert!(
            matches!(&error, LimitError::Number { name: told, .. } if *told == name),
            "{error}"
        );
        assert!(error.to_string().starts_with(name));
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        number(LimitRequest { inertia: bad, ..WRIST }, "inertia");
        number(LimitRequest { period: bad, ..WRIST }, "period");
        number(LimitRequest { torque_change_max: bad, ..WRIST }, "torque_change_max");
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        number(LimitRequest { phi_rate: bad, ..WRIST }, "phi_rate");
        number(LimitRequest { phi_jump: bad, ..WRIST }, "phi_jump");
        number(LimitRequest { quantum: bad, ..WRIST }, "quantum");
    }
    assert_eq!(refused(LimitRequest { phi_rate: 0.0, phi_jump: 0.0, ..WRIST }), LimitError::NoPhi);
    assert!(matches!(refused(LimitRequest { delay: 1000, ..WRIST }), LimitError::Delay { .. }));
    assert_eq!(refused(LimitRequest { inertia: 1e-310, ..WRIST }), LimitError::Scale);
    // A torque that hardly moves the joint: a law would have to be longer than any that is tried.
    let stiff = refused(LimitRequest { inertia: 1e6, ..WRIST });
    assert!(matches!(stiff, LimitError::NoLaw { low_rad, .. } if low_rad > 0.0), "{stiff}");
}

/// The core's own law in its loop, at a ratio of inertia.
fn rig(law: &JointRecord, model: &LoopModel, mu: f64) -> Rig {
    let Some(own) = &law.observer else { return Rig::new(law, model, mu) };
    let any = record(100.0, 20.0, &[30.0], law.inertia_kg_m2);
    let mut rig = Rig::new(&any, &LoopModel { form: Form::Observer, ..*model }, mu);
    rig.gains = JointGains::from_positions(&PositionDesign {
        inertia: law.inertia_kg_m2,
        kp: law.kp_per_s2,
        kd: law.kd_per_s,
        correction: &own.correction,
        velocity_correction: &[],
        share: own.share,
        delay: own.delay_samples as usize,
        period: model.period_s,
    })
    .unwrap();
    rig.state = JointState::new();
    let _ = rig.gains.update(&mut rig.state, &Measurement::default(), &Reference::default());
    rig
}

/// Error bound and torque change of the core's law, summed up over its answers to one sample of `φ` and of a
/// wrong reading; `None` where they do not die out.
fn summed_up(
    law: &JointRecord,
    model: &LoopModel,
    mu: f64,
    phi: &Phi,
    quantum: f64,
) -> Option<[f64; 2]> {
    let answers = |first: Outside| {
        let mut rig = rig(law, model, mu);
        let answer = |k: usize| {
            let q = rig.q;
            let now = if k == 0 { first } else { Outside::default() };
            (q, rig.step(&now).tau)
        };
        let (q, tau): (Vec<f64>, Vec<f64>) = (0..3000).map(answer).unzip();
        (q, tau)
    };
    let (jump, _) = answers(Outside { phi: 1.0, ..Outside::default() });
    let (read, tau) = answers(Outside { encoder: 1.0, ..Outside::default() });
    let ramp: Vec<f64> = summed(&jump).iter().map(|sum| model.period_s * sum).collect();
    let dies = size(&ramp[2500..]) < 1e-9 * size(&ramp) && size(&read[2500..]) < 1e-9 * size(&read);
    let error =
        size(&ramp) * phi.rate_nm_s + size(&jump) * phi.jump_nm + size(&read) * 0.5 * quantum;
    dies.then_some([error, 0.5 * quantum * size(&changes(&tau))])
}

fn wrist_phi() -> Phi {
    Phi {
        basis: PhiBasis::Typed,
        source: "typed".to_owned(),
        size_nm: None,
        rate_nm_s: 2.577,
        jump_nm: 0.3,
        motion: None,
    }
}

#[test]
fn a_law_of_the_core_beside_the_limit() {
    let phi = wrist_phi();
    let (quantum, period_s) = (TAU / 65_536.0, 4e-3);
    let mut random = Random(3);
    let (mut kinds, mut least) = ([0; 2], f64::INFINITY);
    let wanted = if std::env::var_os("PHIHAT_ALL").is_some() { 10 } else { 4 };
    for case in 0..200 {
        let (kind, delay) = (case % 2, case / 2 % 3);
        let omega = random.around(15.0, 50.0);
        let damping = random.around(1.0, 2.5);
        let pole = (-omega * period_s * random.around(1.5, 5.0)).exp();
        let base = record(omega * omega, damping * omega, &[random.around(1.5, 5.0) * omega], 0.67);
        let correction = vec![
            1.0 - pole.powi(3),
            1.5 * (1.0 - pole).powi(2) * (1.0 + pole) / period_s,
            -(1.0 - pole).powi(3) / (period_s * period_s),
        ];
        let share = random.around(0.3, 1.0);
        let own = PositionObserver {
            correction,
            share,
            delay_samples: delay,
            innovation_filter: Vec::new(),
        };
        let positions = JointRecord { a: Vec::new(), observer: Some(own), ..base.clone() };
        let law = [base, positions][kind as usize].clone();
        let model = LoopModel {
            period_s,
            form: [Form::Observer, Form::Positions][kind as usize],
            velocity: VelocitySource::Differenced,
            ..plain(delay)
        };
        let range = (0.8, 1.4);
        let Ok(found) = beside_limit(&law, &model, (&phi, quantum), range) else { continue };
        let Some([error, _]) = summed_up(&law, &model, 1.0, &phi, quantum) else { continue };
        // What is told is what the core does: at M̄, and nothing over the range is larger.
        assert!((found.own_rad / error - 1.0).abs() < 1e-6, "{found:?} {error}");
        for mu in [0.8, 1.0, 1.4] {
            let [error, change] = summed_up(&law, &model, mu, &phi, quantum).unwrap();
            assert!(error <= found.range_rad * (1.0 + 1e-6), "{found:?} {mu} {error}");
            assert!(change <= found.torque_noise_nm * (1.0 + 1e-6), "{found:?} {mu} {change}");
        }
        assert!(found.times_limit() >= 1.0 && found.times_lightest() >= 1.0, "{found:?}");
        assert!(found.price_of_range() >= found.times_limit());
        least = least.min(found.times_limit());
        kinds[kind as usize] += 1;
        if kinds.iter().all(|count| *count >= wanted) {
            break;
        }
    }
    println!("{kinds:?} laws with feedback and from positions; least {least:.3} times the limit");
    assert!(kinds.iter().all(|count| *count >= wanted), "{kinds:?}");
    assert!(least < 2.5, "{least}");
}

#[test]
fn what_the_limit_does_not_cover_is_not_compared() {
    let phi = wrist_phi();
    let law = record(400.0, 40.0, &[70.0], 0.67);
    let lags = LoopModel {
        velocity: VelocitySource::Differenced,
        drive_bandwidth_hz: Some(100.0),
        ..plain(1)
    };
    for (model, quantum) in
        [(plain(1), 1e-4), (lags, 1e-4), (LoopModel { drive_bandwidth_hz: None, ..lags }, 0.0)]
    {
        let refused = beside_limit(&law, &model, (&phi, quantum), (0.8, 1.4)).unwrap_err();
        assert!(matches!(refused, LimitError::NotCovered { .. }), "{refused}");
    }
}
