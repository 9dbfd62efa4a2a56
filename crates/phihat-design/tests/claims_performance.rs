//! For this to be wrong, a Runge–Kutta simulation, a frequency sweep and the bounds would have to agree with each other
//! and not with the loop.

use crate::claims_support::{Loop, Random, law, random_law};
use phihat_design::claims::polynomial;
use phihat_design::claims::{Attenuation, Iss, NormH, Optimality, PeakGains, UnitLaw, WorstCase};
use phihat_design::prelude::*;

/// The exact gains lie within one part in a million of both sides.
const GAP: f64 = 1e-6;

#[test]
fn published_figures() {
    let gains = PeakGains::of(&law(&[68.9]), 1.0).unwrap();
    gains.verify(&law(&[68.9])).unwrap();
    let expected = [3.628e-5, 5.069e-4, 1.696e-2];
    for (gain, expected) in gains.states.iter().zip(expected) {
        assert!((gain.upper / expected - 1.0).abs() < 3e-4, "{gain:?} {expected}");
    }
    // ∫e: the impulse response has one sign, so the gain is the one at rest, 1/(K_p a_0).
    assert!((gains.integral().unwrap().upper * 400.0 * 68.9 - 1.0).abs() < GAP);
    // φ̂ − φ = −s/(s + a_0) φ: 1 + ∫ a_0 e^{−a_0 t} = 2.
    assert!((gains.estimate.upper - 2.0).abs() < GAP && gains.estimate.lower > 2.0 - GAP);
    assert!((gains.error_bound(0.0, 22.2).unwrap() - 0.0113).abs() < 1e-4);
    assert!(gains.error(2).is_none());
}

#[test]
fn both_sides_are_close_and_enclose_a_simulation() {
    let (mut widest, mut worst): (f64, f64) = (0.0, 0.0);
    for order in 1..=4 {
        let mut random = Random(100 + order as u64);
        for case in 0..6 {
            let law = random_law(&mut random, order);
            let mu = if case % 2 == 0 { 1.0 } else { random.between(0.5, 1.3) };
            let Ok(gains) = PeakGains::of(&law, mu) else { continue };
            gains.verify(&law).unwrap();
            let brute = brute_force(&law, mu);
            for (i, (gain, brute)) in gains.states.iter().zip(&brute).enumerate() {
                widest = widest.max(gain.upper / gain.lower - 1.0);
                let off = (gain.upper / brute - 1.0).abs();
                worst = worst.max(off);
                assert!(off < 2e-4, "order {order}, case {case}, μ {mu}, x{i}: {gain:?} {brute}");
            }
            widest = widest.max(gains.estimate.upper / gains.estimate.lower - 1.0);
        }
    }
    println!("gap {widest:.1e}, against the simulation {worst:.1e}");
    assert!(widest < GAP, "{widest:e}");
}

/// `∫|x_i|` by simulation from `x_{n−1}(0) = −1/μ`.
fn brute_force(law: &UnitLaw, mu: f64) -> Vec<f64> {
    let mut plant = Loop::new(law, mu);
    let n = plant.x.len();
    plant.x[n - 1] = -1.0 / mu;
    let speed = law.denominator(mu)[0].powf(1.0 / n as f64);
    let dt = 2e-3 / speed.max(law.a_top());
    let mut sum = vec![0.0; n];
    let mut last = plant.x.clone();
    let end = 80.0 / law.kp.sqrt() / dt;
    for _ in (0..u32::MAX).take_while(|k| f64::from(*k) < end) {
        plant.step(0.0, dt);
        for i in 0..n {
            sum[i] += 0.5 * dt * (last[i].abs() + plant.x[i].abs());
        }
        last.copy_from_slice(&plant.x);
    }
    sum
}

#[test]
fn worst_phi_attains_the_gain() {
    let mut least: f64 = 1.0;
    for order in 1..=4 {
        let mut random = Random(200 + order as u64);
        for _ in 0..3 {
            let law = random_law(&mut random, order);
            let gains = PeakGains::of(&law, 1.0).unwrap();
            for index in 0..order + 2 {
                let worst = WorstCase::of(&law, 1.0, index).unwrap();
                let steps = 100_000;
                let dt = worst.peak_s / f64::from(steps);
                let mut plant = Loop::new(&law, 1.0);
                let mut peak: f64 = 0.0;
                for k in 0..steps {
                    plant.step(worst.phi((f64::from(k) + 0.5) * dt), dt);
                    peak = peak.max(plant.x[index].abs());
                }
                let share = peak / gains.states[index].upper;
                assert!(share <= 1.0 + 1e-6, "order {order}, x{index}: {share}");
                least = least.min(share);
            }
        }
    }
    println!("attained at least {least}");
    assert!(least > 0.95);
}

#[test]
fn window_of_the_continuous_loop() {
    let pid = law(&[68.9]);
    assert!(PeakGains::of(&pid, 12.2).is_ok());
    let no = PeakGains::of(&pid, 12.5).unwrap_err();
    assert!(no.inequality.contains("Hurwitz"), "{no}");
    assert!(NormH::of(&pid, 12.5).is_err());
    // Gains grow with the inertia that is not in M̄.
    let at = |mu| PeakGains::of(&pid, mu).unwrap().error(0).unwrap().upper;
    assert!(at(8.0) > at(1.0) && at(12.0) > 3.0 * at(8.0));
}

#[test]
fn exact_norm_against_a_sweep() {
    let mut gap: f64 = 0.0;
    for order in 1..=4 {
        let mut random = Random(300 + order as u64);
        for case in 0..100 {
            let law = random_law(&mut random, order);
            let mu = if case % 2 == 0 { 1.0 } else { random.between(0.6, 1.3) };
            let Ok(norm) = NormH::of(&law, mu) else { continue };
            let p = polynomial::magnitude_squared(&law.denominator(mu));
            let peak = (0..20_000)
                .map(|k| {
                    let w = (law.kp.sqrt() * 10_f64.powf(f64::from(k) / 4000.0 - 2.5)).powi(2);
                    (w.powi(i32::try_from(order).unwrap()) / polynomial::value(&p, w)).sqrt()
                })
                .fold(0.0, f64::max);
            assert!(peak <= norm.upper, "order {order}, case {case}: {peak} {norm:?}");
            assert!(
                peak >= norm.lower * (1.0 - 1e-5),
                "order {order}, case {case}: {peak} {norm:?}"
            );
            gap = gap.max(norm.upper / norm.lower - 1.0);
            let mut low = norm.clone();
            low.upper *= 1.0 - 4e-6;
            let why = low.verify(&law).unwrap_err();
            assert!(why.inequality.starts_with("upper²"), "{why}");
        }
    }
    println!("gap of the norm {gap:.1e}");
    assert!(gap < 2e-6);
}

#[test]
fn state_decays_and_answers_as_promised() {
    for order in 1..=4 {
        let mut random = Random(400 + order as u64);
        let laws = if std::env::var_os("PHIHAT_ALL").is_some() { 8 } else { 3 };
        for case in 0..laws {
            let law = random_law(&mut random, order);
            let k_tilde = Attenuation::of(&law).unwrap().k_tilde();
            let claim = k_tilde.map(|k| Optimality::at(&law, k).unwrap());
            let certified = claim.as_ref().and_then(Optimality::certified);
            let mut all = vec![Iss::of_loop(&law).unwrap()];
            all.extend(certified.map(|c| Iss::of(&law, c).unwrap()));
            for iss in all {
                iss.verify(&law).unwrap();
                decays(&law, &iss, &mut random, case);
                dissipates(&law, &iss, &mut random);
            }
        }
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn decays(law: &UnitLaw, iss: &Iss, random: &mut Random, case: usize) {
    let (mut free, mut driven) = (Loop::new(law, 1.0), Loop::new(law, 1.0));
    for (i, x) in free.x.iter_mut().enumerate() {
        *x = random.between(-1.0, 1.0) * 1e-2_f64.powi(i32::try_from(i).unwrap() % 3);
    }
    let (start, dt) = (norm(&free.x), 1e-4);
    let mut phi = 1.0;
    for k in 1..5000 {
        if random.between(0.0, 1.0) < 0.01 {
            phi = -phi;
        }
        free.step(0.0, dt);
        driven.step(phi, dt);
        let bound = iss.beta(f64::from(k) * dt) * start;
        assert!(norm(&free.x) <= bound * (1.0 + 1e-9), "case {case}, {law:?}");
        assert!(norm(&driven.x) <= iss.gain.upper, "case {case}, {law:?}");
    }
}

/// (27) at random states: V̇ from the state equation, not from W.
fn dissipates(law: &UnitLaw, iss: &Iss, random: &mut Random) {
    let a = law.closed_loop();
    let n = a.len();
    for _ in 0..100 {
        let x: Vec<f64> = (0..n)
            .map(|_| random.between(-1.0, 1.0) * 10_f64.powf(random.between(-6.0, 1.0)))
            .collect();
        let phi = random.between(-1.0, 1.0) * 10_f64.powf(random.between(-3.0, 3.0));
        let rate = |i: usize| -> f64 {
            let free: f64 = a[i].iter().zip(&x).map(|(a, x)| a * x).sum();
            free - if i + 1 == n { phi } else { 0.0 }
        };
        let (mut v_rate, mut size) = (0.0, 0.0);
        for i in 0..n {
            for j in 0..n {
                v_rate += x[i] * iss.s[i][j] * rate(j);
                size += (x[i] * iss.s[i][j] * rate(j)).abs();
            }
        }
        let limit = -iss.gamma1 * norm(&x).powi(2) + iss.gamma2 * phi * phi;
        assert!(v_rate <= limit + 1e-9 * size, "{law:?} {x:?} {phi}: {v_rate} {limit}");
    }
}
