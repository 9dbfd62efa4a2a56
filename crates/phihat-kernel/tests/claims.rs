//! Claims about random joints against eigenvalues, dense samples of the circle and inertia that moves. Wrong if an arm
//! that is proved stable grows, if a margin goes beyond what dense sampling finds, or if hardly anything were proved.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix};
use phihat_kernel::{
    JointLoop, Law, MovingInertia, Number, Polynomial, Range, Setting, Unproved, any_speed, decays,
    delay, frozen, modulus, moving, phase,
};

use crate::random::{Dice, alone, law, matrix, radius, setting};

/// Joints that are stable alone at `μ = 1`, with their loops; without a drive, and with the same velocity's source.
fn arm(dice: &mut Dice, count: usize) -> (Vec<(Law, Setting)>, Vec<JointLoop>) {
    let mut own = Vec::new();
    while own.len() < count {
        let states = dice.below(3);
        let (law, mut setting) = (law(dice, states), setting(dice));
        setting.drive = None;
        if radius(&alone(&law, &setting, 1.0)) < 0.999 {
            own.push((law, setting));
        }
    }
    let joints = own.iter().map(|(law, setting)| JointLoop::new(law, setting).unwrap()).collect();
    (own, joints)
}

/// A random symmetric `W` with its spectrum in a range, both ends among it.
fn inertia(dice: &mut Dice, n: usize, (low, high): (f64, f64)) -> DMatrix<f64> {
    let random = DMatrix::from_fn(n, n, |_, _| dice.roll());
    let turn = random.qr().q();
    let value = |i: usize, dice: &mut Dice| match i {
        0 => low,
        1 => high,
        _ => dice.between(low, high),
    };
    let diagonal = DMatrix::from_fn(n, n, |i, j| if i == j { value(i, dice) } else { 0.0 });
    &turn * diagonal * turn.transpose()
}

/// `M⁻¹` from `W` and the joints' nominal inertias.
fn inverse(joints: &[(Law, Setting)], w: &DMatrix<f64>) -> DMatrix<f64> {
    let inverse = w.clone().try_inverse().unwrap();
    let root = |i: usize| joints[i].1.inertia.sqrt();
    DMatrix::from_fn(w.nrows(), w.nrows(), |i, j| inverse[(i, j)] / root(i) / root(j))
}

fn range(low: f64, high: f64) -> Range {
    Range::new(low, high).unwrap()
}

#[test]
fn no_frozen_arm_that_is_proved_grows() {
    let mut dice = Dice(11);
    let (mut proved, mut refused, mut grew) = (0, 0, 0);
    for _ in 0..150 {
        let n = 2 + dice.below(2);
        let (own, joints) = arm(&mut dice, n);
        let spread = 1.0 + 8.0 * dice.between(0.0, 1.0).powi(2);
        let (low, high) = (1.0 / spread, spread);
        let holds = frozen(&joints, &range(low, high)).is_ok();
        for _ in 0..10 {
            let w = inertia(&mut dice, n, (low, high));
            let found = radius(&matrix(&own, &inverse(&own, &w)));
            assert!(!(holds && found >= 1.0), "{found} {low} {high} {own:?}");
            grew += u32::from(found > 1.0);
        }
        if holds { proved += 1 } else { refused += 1 }
    }
    println!("{proved} proved, {refused} refused, {grew} of their postures grow");
    assert!(proved > 40 && refused > 20 && grew > 20);
}

#[test]
fn a_window_ends_where_a_root_crosses() {
    let mut dice = Dice(12);
    let mut edges = 0;
    for _ in 0..60 {
        let (own, joints) = arm(&mut dice, 1);
        let grows = |mu: f64| radius(&alone(&own[0].0, &own[0].1, mu)) > 1.0;
        for far in [1e-3, 1e3] {
            // The edge next to 1, if the loop is stable all the way.
            let grid: Vec<f64> = (0..=400).map(|k| f64::powf(far, f64::from(k) / 400.0)).collect();
            let Some(at) = grid.iter().position(|mu| grows(*mu)) else { continue };
            let (mut inside, mut outside) = (grid[at - 1], grid[at]);
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if grows(middle) { outside = middle } else { inside = middle }
            }
            edges += 1;
            let holds = |mu: f64| frozen(&joints, &range(mu.min(1.0), mu.max(1.0))).is_ok();
            let hair = 1e-7 * far.ln().signum();
            assert!(holds(inside * (1.0 - hair)), "{inside} {own:?}");
            assert!(!holds(inside * (1.0 + hair)), "{inside} {own:?}");
        }
    }
    println!("{edges} edges");
    assert!(edges > 40);
}

#[test]
fn no_arm_that_may_move_grows_while_it_moves() {
    let mut dice = Dice(13);
    let (mut proved, mut refused) = ([0, 0], 0);
    for _ in 0..100 {
        let n = 2;
        let (own, joints) = arm(&mut dice, n);
        let spread = 1.0 + 4.0 * dice.between(0.0, 1.0).powi(2);
        let (low, high) = (1.0 / spread, spread);
        let any = any_speed(&joints, &range(low, high)).is_ok();
        let rate = dice.between(0.002, 0.02);
        let period = own[0].1.period;
        let of = |taps: &[f64]| {
            let drift = 3.0 * low * high;
            moving(&joints, &MovingInertia { range: range(low, high), rate, period, drift, taps })
                .is_ok()
        };
        let sizes = [-3.0, -1.0, -0.3, -0.1, 0.1, 0.3, 1.0, 3.0];
        let bounded = !any && sizes.iter().any(|h| of(&[*h]) || of(&[0.0, *h]));
        if !any && !bounded {
            refused += 1;
            continue;
        }
        proved[usize::from(any)] += 1;
        // From one inertia to another at the rate that is proved, or at once: products of samples must shrink.
        let mut product = DMatrix::identity(1, 1);
        let (mut at, mut grown) = (inertia(&mut dice, n, (low, high)), 0.0);
        let mut target = at.clone();
        for k in 0..3000 {
            if k % 40 == 0 {
                target = inertia(&mut dice, n, (low, high));
            }
            let way = &target - &at;
            let far = way.clone().symmetric_eigenvalues().amax();
            let step = if any { f64::INFINITY } else { rate * period };
            at += way * (step / far).min(1.0);
            let a = matrix(&own, &inverse(&own, &at));
            product = if k == 0 { a } else { a * product };
            let size = product.norm();
            grown += size.ln();
            product /= size;
        }
        assert!(grown < 0.0, "{grown} {own:?}");
    }
    println!("{proved:?} proved at a rate and at any speed, {refused} refused");
    assert!(proved[1] > 10 && refused > 5);
}

/// `N`, `Δ` at a point of the circle.
fn values(joint: &JointLoop, theta: f64) -> [Complex<f64>; 2] {
    let z = Complex::from_polar(1.0, theta);
    [&joint.back, &joint.open].map(|p: &Polynomial| {
        let c = p.coefficients().iter().map(Number::near);
        c.rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * z + c)
    })
}

/// A matrix with the roots of a polynomial as its eigenvalues.
fn companion(p: &Polynomial) -> DMatrix<f64> {
    let c: Vec<f64> = p.coefficients().iter().map(Number::near).collect();
    let n = p.degree();
    DMatrix::from_fn(n, n, |i, j| match i {
        0 => -c[n - 1 - j] / c[n],
        _ => f64::from(u8::from(i == j + 1)),
    })
}

#[test]
fn margins_are_those_of_dense_samples() {
    let mut dice = Dice(14);
    let grid: Vec<f64> =
        (0..=30_000).map(|k| PI * 1e-4_f64.powf(f64::from(k) / 30_000.0)).collect();
    let (mut lags, mut counted) = (0, 0);
    for _ in 0..40 {
        let (own, joints) = arm(&mut dice, 1);
        let joint = &joints[0];
        let (low, high) = (0.95, 1.1);
        if frozen(&joints, &range(low, high)).is_err() {
            continue;
        }
        let (mut least, mut turn, mut lag) = (1.0_f64, PI, f64::INFINITY);
        for theta in &grid {
            let [n, d] = values(joint, *theta);
            let l = n / d;
            // Nearest of 1 + L/μ to 0: at an end, or where L/μ is next to −1.
            let inner = -l.norm_sqr() / l.re;
            for mu in [low, high, inner.clamp(low, high)] {
                least = least.min((l / mu + 1.0).norm());
            }
            if (low..=high).contains(&l.norm()) {
                let angle = (-l).arg();
                turn = turn.min(angle.abs());
                lag = lag.min(angle.rem_euclid(2.0 * PI) / theta);
            }
        }
        let over = range(low, high);
        // Samples of the circle miss a little of the worst.
        let both = |inside: Result<(), Unproved>, outside: Result<(), Unproved>| {
            assert_eq!((inside, outside.is_ok()), (Ok(()), false), "{least} {turn} {lag} {own:?}");
        };
        both(modulus(joint, &over, least * 0.999), modulus(joint, &over, least * 1.001));
        if turn < PI {
            both(phase(joint, &over, turn * 0.998), phase(joint, &over, turn * 1.002));
            both(delay(joint, &over, lag * 0.998), delay(joint, &over, lag * 1.002));
            lags += 1;
            // Whole samples more of delay: eigenvalues say the same.
            for late in (1..5_u8).take_while(|late| f64::from(*late) < lag * 0.998) {
                let shift = std::iter::repeat_n(Number::zero(), usize::from(late));
                let open = shift.chain(joint.open.coefficients().iter().cloned()).collect();
                assert!(
                    radius(&companion(&joint.back.plus(&Polynomial::new(open)))) < 1.0,
                    "{late}"
                );
                counted += 1;
            }
        }
    }
    println!("{lags} lags, {counted} whole samples");
    assert!(lags > 15 && counted > 10, "{lags} {counted}");
}

#[test]
fn a_radius_that_decays_is_told_from_one_that_does_not() {
    for x in [0.0_f64, 1e-9, 0.0045, 0.3, 0.5] {
        let of = |share: f64| Number::of((-x).exp() * share).unwrap();
        let x = Number::of(x).unwrap();
        assert!(decays(&of(1.0 - 4e-16), &x) && !decays(&of(1.0 + 4e-16), &x), "{x:?}");
    }
    assert!(!decays(&Number::of(1.0).unwrap(), &Number::of(-1e-300).unwrap()));
}

#[test]
fn claims_that_make_no_sense_are_refused() {
    let (_, joints) = arm(&mut Dice(15), 1);
    let over = range(1.0, 1.0);
    for bad in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        assert_eq!(modulus(&joints[0], &over, bad), Err(Unproved::NoClaim));
    }
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        assert_eq!(phase(&joints[0], &over, bad), Err(Unproved::NoClaim));
        assert_eq!(delay(&joints[0], &over, bad), Err(Unproved::NoClaim));
        let good =
            MovingInertia { range: over.clone(), rate: 0.0, period: 0.01, drift: 1.0, taps: &[] };
        for motion in [
            MovingInertia { rate: bad, ..good.clone() },
            MovingInertia { period: bad, ..good.clone() },
            MovingInertia { drift: bad, ..good.clone() },
        ] {
            assert_eq!(moving(&joints, &motion), Err(Unproved::NoClaim));
        }
    }
    // Words of an answer.
    let at = Unproved::At { joint: Some(2), theta: 0.5 };
    assert_eq!(at.to_string(), "joint 2 fails at 0.500000 rad/sample");
}
