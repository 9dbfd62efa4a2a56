//! For this to be wrong, the paper's printed numbers would have to satisfy equations they do not, or our corrected
//! equations fail on the numbers that need them.

use crate::claims_support::law;
use phihat_design::claims::paper::Feedback;
use phihat_design::claims::times;
use phihat_design::claims::weights::{conditions, q_diagonal};
use phihat_design::claims::{
    Attenuation, ErrorLimits, Iss, LevelRefused, MinimalGains, Optimality, PaperError, PaperRadius,
    UnitLaw,
};
use phihat_design::prelude::*;

fn refused(law: &UnitLaw, k_tilde: f64) -> LevelRefused {
    match Optimality::at(law, k_tilde).unwrap() {
        Optimality::Refuted(refused) => refused,
        other @ Optimality::Certified(_) => unreachable!("{other:?}"),
    }
}

fn near(value: f64, expected: f64, digits: f64) {
    assert!((value - expected).abs() <= digits, "{value} is not {expected}");
}

/// (18) prints Q33 = K̃ b_0 + …; with that the Riccati equation has a residual of the size of Q33 itself.
#[test]
fn erratum_of_18_is_b0_squared() {
    let law = law(&[4844.0, 139.2]);
    let (k_tilde, b0) = (100.0, 4844.0 / 139.2);
    let rest = (k_tilde - 2.0 * b0) * (law.kd * law.kd - 2.0 * law.kp);
    let q = q_diagonal(&law, k_tilde);
    let claim = Optimality::at(&law, k_tilde).unwrap();
    let s = &claim.certified().unwrap().s;
    // Entry (3, 3) of (13), 2 (S_23 − K_p S_34) − K̃ S_34² + Q_33 = 0, leaves no choice.
    let by_13 = k_tilde * s[2][3].powi(2) - 2.0 * (s[1][2] - law.kp * s[2][3]);
    near(q[2], k_tilde * b0 * b0 + rest, 1e-9 * q[2]);
    near(by_13, q[2], 1e-9 * q[2]);
    let printed = k_tilde * b0 + rest;
    println!("Q33: needed {by_13:.1}, printed formula {printed:.1}");
    assert!((by_13 - printed).abs() > 0.5 * by_13);
}

/// (18) and (22), entry by entry, with the correction.
#[test]
fn closed_forms_of_18_and_22() {
    let (k, b, kp, kd) = (100.0, 4844.0 / 139.2, 400.0, 40.0);
    let claim = Optimality::at(&law(&[4844.0, 139.2]), k).unwrap();
    let c = claim.certified().unwrap();
    let s12 = b * kp * kp + b * b * k * kp + b * k * kp * kd;
    let s23 = b * kd * kd + k * kp + b * k * kd + kp * kd - b * kp;
    let s = [
        [b * k * kp * kp + b * b * k * kp * kd, s12, b * k * kp + b * kp * kd, b * kp],
        [s12, b * b * k * kd + b * k * kd * kd + k * kp * kd + kp * kp, s23, kp + b * kd],
        [b * k * kp + b * kp * kd, s23, kd * kd + b * k + k * kd, kd + b],
        [b * kp, kp + b * kd, kd + b, 1.0],
    ];
    for i in 0..4 {
        for j in 0..4 {
            near(c.s[i][j] / s[i][j], 1.0, 1e-12);
        }
    }
    let claim = Optimality::at(&law(&[69.6]), 68.9).unwrap();
    let q = &claim.certified().unwrap().q;
    for (q_i, of_22) in q.iter().zip([68.9 * 160_000.0, 68.9 * 800.0, 68.9]) {
        near(q_i / of_22, 1.0, 1e-12);
    }
}

#[test]
fn table_2_is_judged_by_name() {
    // (C), used in the experiments; a_i from hypothesis H1.
    let c2 = refused(&law(&[69.6 * 69.6, 69.6]), 68.9);
    assert_eq!(c2.to_string(), "refused on A3 with Q44 = -70.3000");
    assert!(Optimality::at(&law(&[69.6]), 68.9).unwrap().certified().is_some());
    // (B), m = 1: K_d = 0.
    let b1 = refused(&UnitLaw { kp: 78.0, kd: 0.0, a: vec![3.5] }, 3.3);
    assert_eq!((&*b1.condition, &*b1.quantity), ("B2", "Q22"));
    near(b1.value, -3.3 * 156.0, 1e-9);
    // (A), m = 2: b_0 = 0.
    let a2 = refused(&UnitLaw { kp: 57.0, kd: 39.9, a: vec![0.0, 180.0] }, 174.7);
    assert_eq!((&*a2.condition, &*a2.quantity, a2.value.to_bits()), ("A1", "Q11", 0));
    // (A), m = 1, and (B), m = 2, have certificates.
    let a1 = Optimality::at(&UnitLaw { kp: 200.0, kd: 32.3, a: vec![230.0] }, 222.0).unwrap();
    assert!(a1.certified().is_some());
    let b2 = UnitLaw { kp: 100.0, kd: 20.0, a: vec![20.0 * 70.0, 70.0] };
    assert!(Optimality::at(&b2, 63.4).unwrap().certified().is_some());
    // H1 at any K̃: a_1² < 2a_0 leaves no room at all.
    let h1 = Attenuation::of(&law(&[69.6 * 69.6, 69.6])).unwrap();
    assert!(h1.diagonal.is_none() && h1.return_difference.is_none());
    // H2: a_1 = 139.2, a_0 = 9688 is just infeasible, H3 certified with γ = 0.16.
    let h2 = Attenuation::of(&law(&[9688.32, 139.2])).unwrap();
    assert!(h2.return_difference.is_none(), "{h2:?}");
    let h3 = Optimality::at(&law(&[4844.0, 139.2]), 100.0).unwrap();
    near(h3.certified().unwrap().gamma, 0.16, 3e-4);
    let names: Vec<_> = conditions(&law(&[4844.0, 139.2]), 100.0).iter().map(|c| c.name).collect();
    assert_eq!(names, ["A1", "A2", "A3"]);
}

/// (48): ∫e 1e-3, e 1e-2, ė 1e-1.
#[test]
fn minimum_gains_of_the_first_order() {
    let limits = ErrorLimits { phi_max: 22.2, x_max: vec![1e-3, 1e-2, 1e-1] };
    let min = MinimalGains::first_order(&limits).unwrap();
    near(min.k_tilde, 444.0, 1e-9);
    near(min.kp, 100.0, 1e-9);
    near(min.kd, 20.0, 1e-9);
    min.verify(&limits, Feedback::Ignored).unwrap();
    // Table 2 (A) continues with K̃ = 222, half of what (44) asks for: K_p 200 and, with "+ c", K_d 32.3.
    let k_tilde: f64 = 222.0;
    let kp = 2.0 * 22.2 / (k_tilde * 1e-3);
    let c = 22.2 / (k_tilde * 1e-2);
    near(kp, 200.0, 1e-9);
    near(c + (c * c + 2.0 * kp).sqrt(), 32.3, 0.07);
    assert!(((c * c + 2.0 * kp).sqrt() - c - 32.3).abs() > 10.0);
    let newton = MinimalGains::newton(&limits, Feedback::Ignored).unwrap();
    near(newton.k_tilde / min.k_tilde, 1.0, 1e-9);
    near(newton.kd / min.kd, 1.0, 1e-9);
}

#[test]
fn newton_finds_minimum_gains_of_every_order() {
    for m in 1..=4_i32 {
        for feedback in [Feedback::Ignored, Feedback::Included] {
            let x_max = (-m..=1).map(|i| 10_f64.powi(i - 2)).collect();
            let limits = ErrorLimits { phi_max: 22.2, x_max };
            let min = MinimalGains::newton(&limits, feedback).unwrap();
            println!("m = {m}, {feedback:?}: {min:?}");
            min.verify(&limits, feedback).unwrap();
            let mut wrong = min.clone();
            wrong.kd *= 1.001;
            assert!(wrong.verify(&limits, feedback).is_err());
        }
    }
    let nonsense = ErrorLimits { phi_max: 22.2, x_max: vec![1e-3, 0.0, 0.1] };
    assert!(matches!(
        MinimalGains::first_order(&nonsense),
        Err(PaperError::Limit { index: 2, value }) if value.to_bits() == 0
    ));
}

/// Rows of (44) at m = 2 by elimination, in other code: for a given K_p, row 1 gives b_0 K̃/(K̃ − 2b_0), row 4 b_0,
/// row 3 K_d, the larger root (the other is negative); the rest of row 2 changes its sign at a root.
fn roots_by_elimination(phi: f64, x: [f64; 4], with_term: bool) -> Vec<[f64; 4]> {
    let row_2 = |kp: f64| -> [f64; 4] {
        let beta = x[3] / (kp * x[0]);
        let kd_of = |b: f64| {
            let c = x[3] / x[2];
            0.5 * (c + (c * c + 4.0 * (2.0 * kp + c * b - beta * b)).sqrt())
        };
        let row_4 = |b: f64| {
            let kd = kd_of(b);
            let sum = b * kp * x[0] + (kp + b * kd) * x[1] + (kd + b) * x[2] + x[3];
            phi * (beta / b - 1.0) - b * x[3] - if with_term { beta * sum } else { 0.0 }
        };
        // It falls from +∞ to below 0 at b_0 = β, where K̃ has no limit.
        let (mut low, mut high) = (1e-12 * beta, beta);
        for _ in 0..80 {
            let middle = (low * high).sqrt();
            if row_4(middle) > 0.0 { low = middle } else { high = middle }
        }
        // Where K_d stops being real, the halves end without a root of row 4.
        let solved = row_4(low).abs() < 1e-6 * phi * beta / low;
        let (b, kd) = (low, if solved { kd_of(low) } else { f64::NAN });
        let left = (kp * kp + beta * b * (kd * kd - 2.0 * kp)) * x[1] - (kp + b * kd) * x[3];
        [left, 2.0 * b * beta / (beta - b), kd, b]
    };
    let grid: Vec<f64> =
        (0..=8000).map(|i| 10_f64.powf(-3.000_123 + f64::from(i) * 1.25e-3)).collect();
    let changes = grid.windows(2).filter(|two| row_2(two[0])[0] * row_2(two[1])[0] < 0.0);
    let refined = changes.map(|two| {
        let (mut low, mut high) = (two[0], two[1]);
        let sign = row_2(low)[0].signum();
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if row_2(middle)[0] * sign > 0.0 { low = middle } else { high = middle }
        }
        let [_, k_tilde, kd, b] = row_2(low);
        [k_tilde, low, kd, b]
    });
    let mut roots: Vec<[f64; 4]> = refined.collect();
    roots.sort_by(|a, b| a[0].total_cmp(&b[0]));
    roots
}

/// (44) at (49) and φ_max = 22.2 has three roots; the gains of least K̃ have the printed K_p and K_d of Table 2 (B).
#[test]
fn every_root_of_the_second_order() {
    let x = [1e-4, 1e-3, 1e-2, 1e-1];
    for (feedback, least) in
        [(Feedback::Ignored, [463.17, 9.586]), (Feedback::Included, [57.58, 7.422])]
    {
        let limits = ErrorLimits { phi_max: 22.2, x_max: x.to_vec() };
        let roots = MinimalGains::roots(&limits, feedback).unwrap();
        let want = roots_by_elimination(22.2, x, feedback == Feedback::Included);
        println!("{feedback:?}: {roots:?}, by elimination {want:?}");
        assert_eq!((roots.len(), want.len()), (3, 3));
        for (root, want) in roots.iter().zip(&want) {
            let is = [root.k_tilde, root.kp, root.kd, root.b[0]];
            for (is, want) in is.iter().zip(want) {
                near(is / want, 1.0, 1e-6);
            }
        }
        near(roots[0].k_tilde, least[0], 0.01);
        near(roots[0].b[0], least[1], 1e-3);
        near(roots[0].kp, 100.0, 1e-3);
        near(roots[0].kd, 20.0, 1e-3);
        assert_eq!(MinimalGains::newton(&limits, feedback).unwrap(), roots[0]);
    }
}

/// Other limits: as many roots as elimination has.
#[test]
fn roots_at_other_limits() {
    let mut counts = [0; 3];
    for (k, phi) in [0.4, 3.0, 22.2].into_iter().enumerate() {
        for ratio in [6.0, 10.0, 20.0] {
            let x = [1e-4, 1e-3, 1e-3 * ratio, 1e-2 * ratio];
            for (feedback, term) in [(Feedback::Ignored, false), (Feedback::Included, true)] {
                let limits = ErrorLimits { phi_max: phi, x_max: x.to_vec() };
                let roots = MinimalGains::roots(&limits, feedback).map_or(0, |roots| roots.len());
                let want = roots_by_elimination(phi, x, term).len();
                assert_eq!(roots, want, "{phi} {ratio} {feedback:?}");
                counts[k] += roots;
            }
        }
    }
    println!("roots at each φ: {counts:?}");
}

#[test]
fn outer_loop_from_times() {
    // Textbook: critically damped, 2 % after 5.834/ω, 10–90 % in 3.358/ω.
    let (kp, kd) = times::from_settling_time(0.5834, 1.0);
    near(kp, 100.0, 0.05);
    near(kd, 20.0, 0.01);
    let (kp, _) = times::from_rise_time(0.3358, 1.0);
    near(kp, 100.0, 0.05);
    // ζ = 0.5: 1.638/ω; ζ = 2: 8.23/ω.
    near(times::from_rise_time(1.638, 0.5).0, 1.0, 0.01);
    near(times::from_rise_time(8.23, 2.0).0, 1.0, 0.01);
    assert_eq!(times::estimator(2, 400.0, 4.0), [6400.0, 160.0]);
}

/// (40) with the paper's own gains says |x| ≤ 207, and as an ultimate bound still more.
#[test]
fn bound_40_is_vacuous() {
    let law = law(&[69.6]);
    let claim = Optimality::at(&law, 68.9).unwrap();
    let iss = Iss::of(&law, claim.certified().unwrap()).unwrap();
    let radius = PaperRadius::of(&iss);
    radius.verify(&law, &iss).unwrap();
    println!("(40): {}, corrected: {}", radius.printed * 22.2, radius.corrected * 22.2);
    near(radius.printed * 22.2, 207.0, 5.0);
    assert!(radius.corrected > 100.0 * radius.printed);
}
