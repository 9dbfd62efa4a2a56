//! The law from positions: its observer has the poles it was made for, its steady errors are those of its order, its
//! prediction and its feed-forward are exact, and limits do not wind it up. Wrong if it confused a sample with the
//! next, a torque with the one before, or a sign.
#![allow(
    clippy::cast_possible_truncation,
    reason = "tests: a panic is the report, and single precision is one of them"
)]

use std::collections::VecDeque;

use phihat::{
    Command, Gain, GainError, JointGains, JointState, Limits, Measurement, PositionDesign,
    Reference,
};

const T: f64 = 1e-3;
const INERTIA: f64 = 0.8;

/// `det(z − (1 − ℓC)F)` at a point, for the chain `e, ė, φ/M̄, …` written out by hand, in time units of `T`.
fn determinant(l: &[f64], z: f64) -> f64 {
    let n = l.len();
    // Position and velocity under a force that is held, and φ, φ′, … each the sum of the next.
    let f = |i: usize, j: usize| match (i, j) {
        (0, 2) => -0.5,
        (1, 2) => -1.0,
        _ if i == j || (i + 1 == j && i != 1) => 1.0,
        _ => 0.0,
    };
    let mut a: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            (0..n).map(|j| f64::from(u8::from(i == j)) * z - f(i, j) + l[i] * f(0, j)).collect()
        })
        .collect();
    let mut det = 1.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|x, y| a[*x][k].abs().total_cmp(&a[*y][k].abs())).unwrap();
        if pivot != k {
            a.swap(pivot, k);
            det = -det;
        }
        det *= a[k][k];
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    det
}

/// `ℓ` for real poles: the determinant is affine in it, so as many points as poles decide it.
fn correction(poles: &[f64]) -> Vec<f64> {
    let n = poles.len();
    let wanted = |z: f64| poles.iter().map(|p| z - p).product::<f64>();
    let points: Vec<f64> = (0..n).map(|k| 1.5 + 0.7 * k as f64).collect();
    let mut rows: Vec<Vec<f64>> = points
        .iter()
        .map(|z| {
            let none = determinant(&vec![0.0; n], *z);
            let mut row: Vec<f64> = (0..n)
                .map(|i| {
                    let mut unit = vec![0.0; n];
                    unit[i] = 1.0;
                    determinant(&unit, *z) - none
                })
                .collect();
            row.push(wanted(*z) - none);
            row
        })
        .collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|x, y| rows[*x][k].abs().total_cmp(&rows[*y][k].abs())).unwrap();
        rows.swap(pivot, k);
        for i in 0..n {
            if i != k {
                let factor = rows[i][k] / rows[k][k];
                for j in k..=n {
                    rows[i][j] -= factor * rows[k][j];
                }
            }
        }
    }
    let powers = [1.0, T, T * T, T * T * T, T * T * T * T];
    (0..n).map(|k| rows[k][n] / rows[k][k] / powers[k]).collect()
}

fn design(correction: &[f64], share: f64, delay: usize) -> PositionDesign<'_> {
    PositionDesign {
        inertia: INERTIA,
        kp: 900.0,
        kd: 60.0,
        correction,
        velocity_correction: &[],
        share,
        delay,
        period: T,
    }
}

fn gains(poles: &[f64], share: f64, delay: usize) -> JointGains<f64> {
    JointGains::from_positions(&design(&correction(poles), share, delay)).unwrap()
}

/// A joint with a transport delay, moved exactly from sample to sample.
struct Joint {
    inertia: f64,
    q: f64,
    dq: f64,
    coming: VecDeque<f64>,
    acted: f64,
    state: JointState<f64>,
}

impl Joint {
    fn new(inertia: f64, delay: usize) -> Self {
        let coming = VecDeque::from(vec![0.0; delay]);
        Self { inertia, q: 0.0, dq: 0.0, coming, acted: 0.0, state: JointState::new() }
    }

    fn step(
        &mut self,
        gains: &JointGains<f64>,
        reference: &Reference<f64>,
        phi: f64,
    ) -> Command<f64> {
        self.move_on(gains, reference, (phi, 0.0))
    }

    /// One sample under a load that begins with a value and has a slope.
    fn move_on(
        &mut self,
        gains: &JointGains<f64>,
        reference: &Reference<f64>,
        (phi, slope): (f64, f64),
    ) -> Command<f64> {
        let m = Measurement { q: self.q, dq: self.dq, tau_applied: self.acted };
        let command = gains.update(&mut self.state, &m, reference);
        self.coming.push_back(command.tau);
        self.acted = self.coming.pop_front().unwrap();
        let ddq = (self.acted - phi) / self.inertia;
        let jerk = -slope / self.inertia;
        self.q += T * (self.dq + 0.5 * T * (ddq + T / 3.0 * jerk));
        self.dq += T * (ddq + 0.5 * T * jerk);
        command
    }
}

#[test]
fn the_estimate_has_the_poles_of_its_design() {
    for poles in [&[0.9, 0.92, 0.95][..], &[0.9, 0.92, 0.95, 0.85], &[0.9, 0.92, 0.95, 0.85, 0.8]] {
        for delay in 0..=4 {
            let gains = gains(poles, 0.3, delay);
            let mut joint = Joint::new(INERTIA, delay);
            let phi = 2.0;
            let errors: Vec<f64> = (0..40)
                .map(|_| joint.step(&gains, &Reference::default(), phi).phi_hat - phi)
                .collect();
            let mut c = vec![1.0];
            for p in poles {
                let mut next = vec![0.0; c.len() + 1];
                for (i, x) in c.iter().enumerate() {
                    next[i + 1] += x;
                    next[i] -= p * x;
                }
                c = next;
            }
            let largest = errors.iter().fold(0.0_f64, |w, v| w.max(v.abs()));
            // The first sample has nothing to carry on from.
            let residual = errors[1..]
                .windows(c.len())
                .map(|w| w.iter().zip(&c).map(|(x, c)| x * c).sum::<f64>().abs())
                .fold(0.0, f64::max);
            println!("{poles:?} d = {delay}: {:.1e}", residual / largest);
            assert!(residual < 1e-7 * largest, "{poles:?} d = {delay}: {residual:e} {largest:e}");
        }
    }
}

#[test]
fn steady_errors_are_those_of_the_order() {
    for (order, poles) in [(1, &[0.92, 0.93, 0.95][..]), (2, &[0.92, 0.93, 0.95, 0.9])] {
        for delay in [0, 1, 3] {
            for mu in [0.8, 1.0, 1.3] {
                let gains = gains(poles, 0.5, delay);
                let settle = |phi: f64, slope: f64| {
                    let mut joint = Joint::new(mu * INERTIA, delay);
                    for k in 0..8000 {
                        let now = phi + slope * f64::from(k) * T;
                        joint.move_on(&gains, &Reference::default(), (now, slope));
                    }
                    joint.q.abs()
                };
                let (constant, ramp) = (settle(3.0, 0.0), settle(0.0, 1.0));
                println!("m = {order}, d = {delay}, μ = {mu}: {constant:.1e} {ramp:.1e}");
                assert!(constant < 1e-12, "a constant load leaves {constant:e} rad");
                assert!((ramp > 1e-5) == (order == 1), "a ramp leaves {ramp:e} rad");
                assert!(order == 1 || ramp < 1e-12, "a ramp leaves {ramp:e} rad");
            }
        }
    }
}

/// `q_d`, `q̇_d` and `q̈_d` as the law wants them: what will act in its interval, `d` samples on.
fn previewed(k: usize, delay: usize) -> Reference<f64> {
    let velocity = |k: usize| 2.0 * (4.0 * k as f64 * T).cos();
    let ahead = (velocity(k + delay + 1) - velocity(k + delay)) / T;
    Reference { q: 0.5 * (4.0 * k as f64 * T).sin(), dq: velocity(k), ddq: ahead }
}

#[test]
fn a_reference_known_in_advance_leaves_the_residue_of_the_hold() {
    for delay in 0..=4 {
        let gains = gains(&[0.9, 0.92, 0.95], 0.4, delay);
        let mut joint = Joint::new(INERTIA, delay);
        // It starts on the reference, with the torques on their way that keep it there.
        joint.dq = 2.0;
        let fed = |k: usize| {
            let velocity = |k: usize| 2.0 * (4.0 * k as f64 * T).cos();
            INERTIA * (velocity(k + 1) - velocity(k)) / T
        };
        joint.coming = (0..delay).map(fed).collect();
        let mut worst = (0.0_f64, 0.0_f64);
        for k in 0..4000 {
            let wanted = previewed(k, delay);
            let e = joint.q - wanted.q;
            let late = k > 1000;
            worst.0 = worst.0.max(if late { e.abs() } else { 0.0 });
            worst.1 = worst.1.max(e.abs());
            joint.step(&gains, &wanted, 0.0);
        }
        // A kick of T³ max|q⃛_d|/12 per sample; the loop holds it for some fifty samples.
        let kick = T.powi(3) * 0.5 * 64.0 / 12.0;
        println!("d = {delay}: {:.2e} rad, {:.1} kicks", worst.0, worst.0 / kick);
        assert!(worst.0 < 100.0 * kick, "d = {delay}: {:e} rad, a kick is {kick:e}", worst.0);
        // Without preview: what is known one sample too late leaves more than a hundred times as much.
        let mut blind = Joint::new(INERTIA, delay);
        blind.dq = 2.0;
        let mut most = 0.0_f64;
        for k in 0..4000 {
            let t = k as f64 * T;
            let wanted = Reference { ddq: -8.0 * (4.0 * t).sin(), ..previewed(k, delay) };
            most = most.max(if k > 1000 { (blind.q - wanted.q).abs() } else { 0.0 });
            blind.step(&gains, &wanted, 0.0);
        }
        assert!(delay == 0 || most > 20.0 * worst.0, "d = {delay}: {most:e} against {:e}", worst.0);
    }
}

#[test]
fn a_delay_is_predicted_across() {
    // Where the joint is known, a delay only makes the same motion begin later: from where it is by then.
    let poles = [0.9, 0.92, 0.95];
    let prompt = gains(&poles, 1.0, 0);
    for delay in 1..=4 {
        let late = gains(&poles, 1.0, delay);
        let mut joint = Joint::new(INERTIA, delay);
        (joint.q, joint.dq) = (0.1, -0.4);
        let mut twin = Joint::new(INERTIA, 0);
        (twin.q, twin.dq) = (0.1 - 0.4 * delay as f64 * T, -0.4);
        for _ in 0..delay {
            joint.step(&late, &Reference::default(), 0.0);
        }
        let mut apart = 0.0_f64;
        for _ in 0..400 {
            joint.step(&late, &Reference::default(), 0.0);
            twin.step(&prompt, &Reference::default(), 0.0);
            apart = apart.max((joint.q - twin.q).abs());
        }
        assert!(apart < 1e-12 && joint.q.abs() < 1e-3, "d = {delay}: {apart:e} {}", joint.q);
    }
}

#[test]
fn limits_do_not_wind_it_up() {
    let free = gains(&[0.9, 0.92, 0.95], 0.4, 1);
    let limited = free.with_limits(Limits::new(Some(2.0), Some(400.0), T).unwrap());
    let mut joint = Joint::new(INERTIA, 1);
    // A load that the drive cannot bear for half a second, then none.
    let mut most = 0.0_f64;
    for k in 0..4000 {
        let phi = if k < 500 { 3.0 } else { 0.5 };
        let command = joint.step(&limited, &Reference::default(), phi);
        assert!(command.tau.abs() <= 2.0);
        most = most.max(joint.q.abs());
    }
    println!("left by {most:.3} rad, ends at {:.1e} rad", joint.q);
    assert!(joint.q.abs() < 1e-9 && most < 2.0, "{most} {}", joint.q);
    // It knew all the while what acted: φ̂ is φ although the torque could not be had.
    let mut joint = Joint::new(INERTIA, 1);
    let last = (0..400).map(|_| joint.step(&limited, &Reference::default(), 3.0).phi_hat).last();
    assert!((last.unwrap() - 3.0).abs() < 1e-6, "{last:?}");
}

#[test]
fn it_takes_over_from_a_torque_without_a_step() {
    for delay in 0..=4 {
        for (e, de) in [(0.0, 0.0), (2e-3, 0.0), (-1e-3, 0.05)] {
            let gains = gains(&[0.9, 0.92, 0.95], 1.0, delay);
            let mut state = JointState::new();
            let reference = Reference { q: 0.3, dq: 0.1, ddq: 0.7 };
            let m = Measurement { q: 0.3 + e, dq: 0.1 + de, tau_applied: 5.0 };
            assert!(gains.resume(&mut state, &m, &reference, 5.0));
            assert!((state.tau() - 5.0).abs() < 1e-15);
            // The joint goes on as expected: what the law makes of it is 5 N·m still.
            let push = (5.0 - INERTIA * 0.7 - phi_of(&state, &gains, &m, &reference)) / INERTIA;
            let next = Measurement {
                q: m.q + T * (0.1 + de) + 0.5 * T * T * (0.7 + push),
                dq: m.dq + T * (0.7 + push),
                tau_applied: 5.0,
            };
            let ahead =
                Reference { q: 0.3 + T * 0.1 + 0.5 * T * T * 0.7, dq: 0.1 + T * 0.7, ddq: 0.7 };
            let command = gains.update(&mut state, &next, &ahead);
            println!("d = {delay}, e = {e}, ė = {de}: {:.4} N·m", command.tau - 5.0);
            // A sample later the joint is closer, or farther: M̄ K_d K_p T e and M̄ (K_p − K_d²) T ė at most.
            let most = INERTIA * T * (60.0 * 900.0 * e.abs() + 2700.0 * de.abs()) + 1e-9;
            assert!((command.tau - 5.0).abs() < 1.1 * most, "d = {delay}: {}", command.tau);
        }
    }
}

/// `φ̂` of a state, as the next command reports it.
fn phi_of(
    state: &JointState<f64>,
    gains: &JointGains<f64>,
    m: &Measurement<f64>,
    reference: &Reference<f64>,
) -> f64 {
    let mut copy = *state;
    let nan = Measurement { q: f64::NAN, ..*m };
    gains.update(&mut copy, &nan, reference).phi_hat
}

#[test]
fn what_is_no_sample_changes_nothing() {
    let gains = gains(&[0.9, 0.92, 0.95], 0.4, 2);
    let mut joint = Joint::new(INERTIA, 2);
    for _ in 0..50 {
        joint.step(&gains, &Reference::default(), 1.0);
    }
    let before = joint.state;
    let bad = [f64::NAN, f64::INFINITY, 1e300];
    for x in bad {
        let m = Measurement { q: x, dq: 0.0, tau_applied: 0.0 };
        let command = gains.update(&mut joint.state, &m, &Reference::default());
        assert!(command.status.refused && command.tau.to_bits() == before.tau().to_bits());
        assert_eq!(joint.state, before);
    }
}

#[test]
fn designs_that_cannot_work_are_refused() {
    let good = correction(&[0.9, 0.92, 0.95]);
    let of = |design: PositionDesign<'_>| JointGains::<f64>::from_positions(&design).map(|_| ());
    assert_eq!(of(design(&good, 0.4, 4)), Ok(()));
    assert_eq!(of(design(&good, 0.4, 5)), Err(GainError::Delay { samples: 5 }));
    assert_eq!(of(design(&good, 1.5, 1)), Err(GainError::Share { value: 1.5 }));
    assert!(matches!(of(design(&good, 0.0, 1)), Err(GainError::NotPositive { .. })));
    assert!(matches!(of(design(&good[..2], 0.4, 1)), Err(GainError::Corrections { .. })));
    let velocity = PositionDesign { velocity_correction: &good[..2], ..design(&good, 0.4, 1) };
    assert!(matches!(of(velocity), Err(GainError::Corrections { .. })));
    // Poles just inside and just outside the unit circle are told apart, for every order.
    for others in [&[0.9, 0.92][..], &[0.9, 0.92, 0.95], &[0.9, 0.92, 0.95, 0.85], &[-0.5, 0.3]] {
        for (edge, stable) in [(0.9999, true), (1.0001, false), (-0.9999, true), (-1.0001, false)] {
            let poles: Vec<f64> = others.iter().copied().chain([edge]).collect();
            let order = poles.len() - 2;
            let found = of(design(&correction(&poles), 0.4, 1));
            let expected =
                if stable { Ok(()) } else { Err(GainError::UnstableEstimator { order }) };
            assert_eq!(found, expected, "{poles:?}");
        }
    }
    for at in 0..3 {
        let (mut position, mut velocity) = ([0.271, 28.5, -1000.0], [0.0; 3]);
        position[at] = f64::NAN;
        let found = of(design(&position, 0.4, 1));
        let named =
            matches!(found, Err(GainError::NotFinite { gain: Gain::Correction(i), .. }) if i == at);
        assert!(named, "{found:?}");
        velocity[at] = f64::INFINITY;
        let heard = PositionDesign { velocity_correction: &velocity, ..design(&good, 0.4, 1) };
        let (gain, value) = (Gain::VelocityCorrection(at), f64::INFINITY);
        assert_eq!(of(heard), Err(GainError::NotFinite { gain, value }));
    }
}

#[test]
fn a_velocity_is_a_second_measurement() {
    // With the velocity alone correcting φ̂, as a torque observer does; and the joint starts at an unknown speed.
    let position = [0.05, 5.0, -20.0];
    let velocity = [0.0, 0.2, -15.0];
    let of = PositionDesign { velocity_correction: &velocity, ..design(&position, 0.4, 1) };
    let gains = JointGains::<f64>::from_positions(&of).unwrap();
    let settled = |phi: f64| {
        let (mut q, mut dq, mut state, mut coming) = (0.0, 0.3, JointState::new(), 0.0);
        let mut acted = 0.0;
        let mut last = 0.0;
        for _ in 0..6000 {
            let m = Measurement { q, dq, tau_applied: acted };
            let command = gains.update(&mut state, &m, &Reference::default());
            acted = std::mem::replace(&mut coming, command.tau);
            let ddq = (acted - phi) / INERTIA;
            q += T * (dq + 0.5 * T * ddq);
            dq += T * ddq;
            last = command.phi_hat;
        }
        (q, last)
    };
    let (q, phi_hat) = settled(4.0);
    assert!(q.abs() < 1e-10 && (phi_hat - 4.0).abs() < 1e-8, "{q:e} {phi_hat}");
}

#[test]
fn a_velocity_that_corrects_nothing_is_not_heard() {
    let position = correction(&[0.9, 0.92, 0.95]);
    let silent = PositionDesign { velocity_correction: &[0.0; 3], ..design(&position, 0.4, 1) };
    let without = JointGains::<f64>::from_positions(&design(&position, 0.4, 1));
    assert_eq!(JointGains::<f64>::from_positions(&silent), without);
}

#[test]
fn single_precision_follows_double() {
    let good = correction(&[0.9, 0.92, 0.95]);
    let of = design(&good, 0.4, 1);
    let (wide, narrow) = (
        JointGains::<f64>::from_positions(&of).unwrap(),
        JointGains::<f32>::from_positions(&of).unwrap(),
    );
    let mut joint = Joint::new(INERTIA, 1);
    let mut single = JointState::<f32>::new();
    let mut most = 0.0_f64;
    for _ in 0..3000 {
        let m = Measurement { q: joint.q as f32, dq: 0.0, tau_applied: joint.acted as f32 };
        let command = joint.step(&wide, &Reference::default(), 2.0);
        let other = narrow.update(&mut single, &m, &Reference::default());
        most = most.max((command.tau - f64::from(other.tau)).abs());
    }
    assert!(most < 1e-3, "{most:e} N·m apart");
}
