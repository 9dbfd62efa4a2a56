//! Designs, before anything runs. Wrong if an estimator with a root in the right half-plane were accepted or a stable
//! one refused, or if the start gains had another pole than is said.

use crate::arm::Dice;
use phihat::{
    Form, GainError, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
};

const T: f64 = 1e-3;

fn made(a: &[f64], form: Form) -> Result<JointGains<f64>, GainError> {
    JointGains::new(&JointDesign { inertia: 0.7, kp: 400.0, kd: 40.0, a, period: T, form })
}

/// The product of factors, each low to high without its leading 1; likewise the answer.
fn product(factors: &[&[f64]]) -> Vec<f64> {
    let mut all = vec![1.0];
    for factor in factors {
        let mut next = vec![0.0; all.len() + factor.len()];
        for (i, a) in all.iter().enumerate() {
            for (j, b) in factor.iter().chain(&[1.0]).enumerate() {
                next[i + j] += a * b;
            }
        }
        all = next;
    }
    all.pop();
    all
}

#[test]
fn an_estimator_is_accepted_exactly_where_its_roots_are_stable() {
    let mut dice = Dice(14);
    let (mut accepted, mut refused) = ([0; 5], [0; 5]);
    while refused[3].min(refused[4]).min(accepted[3]) < 3000 {
        // A pair of roots whose real part has either sign, and one or two stable roots or another pair.
        let w = dice.within(0.3, 3.0);
        let damping = dice.within(-0.5, 0.5);
        let pair = [w * w, 2.0 * damping * w];
        let (one, other) = (dice.within(0.1, 6.0), dice.within(0.1, 6.0));
        let second = [one * one, 2.0 * dice.within(0.05, 2.0) * one];
        let a = match dice.bits() % 3 {
            0 => product(&[&pair, &[one]]),
            1 => product(&[&pair, &[one], &[other]]),
            _ => product(&[&pair, &second]),
        };
        // Where a coefficient is not positive that is what is said; roots on the border are the next test's.
        if a.iter().any(|c| *c <= 0.0) || damping.abs() < 1e-9 {
            continue;
        }
        let order = a.len();
        let is = made(&a, Form::Observer);
        if damping > 0.0 {
            assert!(is.is_ok(), "{a:?}");
            accepted[order] += 1;
        } else {
            assert_eq!(is, Err(GainError::UnstableEstimator { order }), "{a:?}");
            refused[order] += 1;
        }
    }
    println!("accepted by order {accepted:?}, refused {refused:?}");
}

#[test]
fn roots_on_the_border_are_not_stable() {
    // (s² + 3)(s + 2), (s² + 1)(s² + s + 1), (s² + 2)(s + 1)²: exact in binary.
    for a in [&[6.0, 3.0, 2.0][..], &[1.0, 1.0, 2.0, 1.0], &[2.0, 4.0, 3.0, 2.0]] {
        assert_eq!(made(a, Form::Observer), Err(GainError::UnstableEstimator { order: a.len() }));
    }
}

/// `φ̂` of laws fed with the same lively signals, from the second sample on.
fn estimates(law: &JointGains<f64>) -> Vec<f64> {
    let mut state = JointState::new();
    let phi_hat = |k: u32| {
        let t = f64::from(k) * T;
        let m =
            Measurement { q: 0.0, dq: 0.2 * (31.0 * t).sin(), tau_applied: 5.0 + (47.0 * t).cos() };
        law.update(&mut state, &m, &Reference::default()).phi_hat
    };
    (0..300).map(phi_hat).collect()
}

#[test]
fn start_gains_of_first_order_have_the_geometric_mean_of_the_sampled_poles() {
    for poles in
        [&[70.0, 70.0][..], &[20.0, 300.0], &[90.0, 40.0, 500.0], &[15.0, 60.0, 61.0, 900.0]]
    {
        let factors: Vec<[f64; 1]> = poles.iter().map(|p| [*p]).collect();
        let factors: Vec<&[f64]> = factors.iter().map(|f| &f[..]).collect();
        let law = made(&product(&factors), Form::Observer).unwrap();
        let limits = Limits::new(Some(50.0), Some(1e4), T).unwrap();
        let first = law.with_limits(limits).first_order();
        assert_eq!((law.order(), first.order()), (poles.len(), 1));
        assert_eq!(first.limits(), &limits);
        assert!((first.inertia() - 0.7).abs() < 1e-15);
        // Sampled, a pole at −p lies 1 − e^{−pT} from 1.
        let mean =
            poles.iter().map(|p| (-(-p * T).exp_m1()).ln()).sum::<f64>() / poles.len() as f64;
        let same = [-(-mean.exp()).ln_1p() / T];
        let want = made(&same, Form::Observer).unwrap().with_limits(limits);
        for (is, want) in estimates(&first).iter().zip(estimates(&want)) {
            assert!((is - want).abs() <= 1e-11 * (1.0 + want.abs()), "{poles:?}: {is} {want}");
        }
    }
    // What is first order already is left alone.
    for form in [Form::Observer, Form::Literal] {
        let law = made(&[70.0], form).unwrap();
        assert_eq!(law.first_order(), law);
    }
    // The literal form has no sampled poles: a_0 of the first order is the m-th root of a_0.
    for a in
        [&[4900.0, 140.0][..], &[64_000.0, 4800.0, 120.0], &[810_000.0, 108_000.0, 5400.0, 120.0]]
    {
        let law = made(a, Form::Literal).unwrap().first_order();
        let want = made(&[a[0].powf(1.0 / a.len() as f64)], Form::Literal).unwrap();
        assert_eq!(law.order(), 1);
        same_law(&law, &want);
    }
}

/// Two laws answer errors alike.
fn same_law(is: &JointGains<f64>, want: &JointGains<f64>) {
    let mut states = [JointState::new(); 2];
    for k in 0..400_u32 {
        let t = f64::from(k) * T;
        let (q, dq) = (0.02 * (9.0 * t).sin() + 0.01, 0.18 * (9.0 * t).cos());
        let m = Measurement { q, dq, tau_applied: 5.0 + (47.0 * t).cos() };
        let r = Reference { q: 0.003, dq: 0.1, ddq: 0.4 };
        let [a, b] = &mut states;
        let (is, want) = (is.update(a, &m, &r).tau, want.update(b, &m, &r).tau);
        assert!((is - want).abs() <= 1e-11 * (1.0 + want.abs()), "{k}: {is} against {want}");
    }
}

/// The slower literal law is the one designed with `a_i f^{m−i}`; the slower observer of order 1 has a sampled pole
/// `f` times as far from 1.
#[test]
fn slower_gains_are_those_of_the_slower_polynomial() {
    for a in [
        &[69.6][..],
        &[4844.0, 139.2],
        &[64_000.0, 4800.0, 120.0],
        &[810_000.0, 108_000.0, 5400.0, 120.0],
    ] {
        let m = a.len();
        let law = made(a, Form::Literal).unwrap();
        for f in [1.0, 0.575, 0.1_f64] {
            let scaled: Vec<f64> =
                a.iter().zip(0..).map(|(a, i)| a * f.powi(i32::try_from(m).unwrap() - i)).collect();
            same_law(&law.slower(f).unwrap(), &made(&scaled, Form::Literal).unwrap());
        }
        for f in [0.0, -0.5, 1.001, f64::NAN, f64::INFINITY] {
            let refused = law.slower(f);
            assert!(refused.is_none(), "{f}: {refused:?}");
        }
    }
    let sampled = |a: f64| -(-a * T).exp_m1() / T;
    for f in [0.9, 0.3] {
        let slower = made(&[70.0], Form::Observer).unwrap().slower(f).unwrap();
        let pole = -(-f * sampled(70.0) * T).ln_1p() / T;
        same_law(&slower, &made(&[pole], Form::Observer).unwrap());
    }
    // The sampled poles of second order: both f times as far from 1.
    let slower = made(&product(&[&[70.0], &[200.0]]), Form::Observer).unwrap().slower(0.4).unwrap();
    let pole = |p: f64| -(-0.4 * sampled(p) * T).ln_1p() / T;
    let want = made(&product(&[&[pole(70.0)], &[pole(200.0)]]), Form::Observer).unwrap();
    same_law(&slower, &want);
}

#[test]
fn limits_say_what_they_are() {
    let limits = Limits::<f64>::new(Some(30.0), Some(1500.0), 2e-3).unwrap();
    assert!((limits.torque() - 30.0).abs() < 1e-12 && (limits.step() - 3.0).abs() < 1e-12);
    for none in [Limits::<f64>::none(), Limits::new(None, None, T).unwrap()] {
        assert!(none.torque() == f64::INFINITY && none.step() == f64::INFINITY);
    }
}
