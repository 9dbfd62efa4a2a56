//! The paper's recipe joint by joint, and its first step by (40). Wrong if a joint's gains were not those of the closed
//! form for its own limits, if (40) or the area under the impulse response were another number, or if gains that (40)
//! calls good were handed out where a φ exceeds a limit.

use std::path::Path;

use phihat_design::claims::least_by_40::by_40;
use phihat_design::claims::{ErrorLimits, MinimalGains, PaperError, RadiusGains, UnitLaw};
use phihat_design::{Arm, Gains, Outcome, Phi, PhiBasis, design};
use phihat_study::Study;

/// Limits of three joints: (∫e, e, ė), and φ_max.
const X: [[f64; 3]; 3] = [[0.005, 0.02, 0.2], [0.004, 0.01, 0.3], [0.01, 0.03, 0.15]];
const PHI: [f64; 3] = [20.0, 12.0, 35.0];

fn study(x: [[f64; 3]; 3], phi: [f64; 3], more: &str) -> Study {
    let list = |k: usize| format!("[{}, {}, {}]", x[0][k], x[1][k], x[2][k]);
    let text = format!(
        "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\nerror_integral_bound_rad_s = {}\n\
         error_bound_rad = {}\nvelocity_error_bound_rad_s = {}\n[design]\nmethod = \"paper\"\norders = \
         [1]\n[design.paper]\nphi_max = {phi:?}\n{more}\n[reference]\nkind = \"hold\"\nq_rad = 0.0\n",
        list(0),
        list(1),
        list(2),
    );
    Study::from_text(&text, "recipe.toml", Path::new(".")).unwrap()
}

fn made(study: &Study) -> Gains {
    let phi = |_: usize, _: f64| Phi {
        basis: PhiBasis::Typed,
        source: String::new(),
        size_nm: Some(1.0),
        rate_nm_s: 1.0,
        jump_nm: 0.0,
        motion: None,
    };
    match design(study, &Arm::of(study).unwrap(), &phi).unwrap() {
        Outcome::Designed(gains) => *gains,
        other @ Outcome::Infeasible(_) => unreachable!("{other:?}"),
    }
}

#[test]
fn each_joint_has_the_gains_of_its_own_limits() {
    let own = made(&study(X, PHI, "per_joint = true"));
    for (joint, ((x, phi), made_of)) in X.iter().zip(PHI).zip(&own.joints).enumerate() {
        // By hand, the paper's closed form with the sign of c that solves (44).
        let [integral, e, de] = *x;
        let k = 2.0 * phi / de;
        let kp = 2.0 * phi / (k * integral);
        let c = phi / (k * e);
        let kd = c + (c * c + 2.0 * kp).sqrt();
        let a = k.max(4.0 * kp.sqrt());
        let near =
            |is: f64, want: f64| assert!((is / want - 1.0).abs() < 1e-6, "{joint}: {is} {want}");
        near(made_of.kp_per_s2, kp);
        near(made_of.kd_per_s, kd);
        near(made_of.a[0], a);
        // The scalar recipe, told this joint's limits for all.
        let alone = made(&study([*x; 3], [phi; 3], ""));
        let same = &alone.joints[joint];
        assert_eq!((same.kp_per_s2, same.kd_per_s), (made_of.kp_per_s2, made_of.kd_per_s));
        assert_eq!(same.a, made_of.a);
    }
    assert!(own.method.contains("joint by joint") && own.method.contains("joint3: φ_max = 35"));
    // One law for all: the strictest of each limit, the largest φ.
    let all = made(&study(X, PHI, ""));
    let least = ErrorLimits { phi_max: 35.0, x_max: vec![0.004, 0.01, 0.15] };
    let least = MinimalGains::first_order(&least).unwrap();
    assert!(all.joints.iter().all(|joint| (joint.kp_per_s2 / least.kp - 1.0).abs() < 1e-12));
}

/// Areas under |x_i| after an impulse of φ, by Runge and Kutta on (4) and (9) and the trapezoidal rule.
fn areas(kp: f64, kd: f64, a0: f64) -> [f64; 3] {
    // ẍ-chain of (∫e, e, ė): ë = −K_d ė − K_p e − a_0(ė + K_d e + K_p ∫e) − φ.
    let rate = |x: [f64; 3]| {
        let hat = -a0 * (x[2] + kd * x[1] + kp * x[0]);
        [x[1], x[2], hat - kd * x[2] - kp * x[1]]
    };
    let along = |x: [f64; 3], k: [f64; 3], h: f64| core::array::from_fn(|i| x[i] + h * k[i]);
    let h = 0.1 / a0.max(kd);
    let (mut x, mut sums, mut t) = ([0.0, 0.0, -1.0], [0.0; 3], 0.0);
    let end = 40.0 / kp.sqrt().min(kp / kd);
    loop {
        if t >= end {
            return sums;
        }
        let k1 = rate(x);
        let k2 = rate(along(x, k1, h / 2.0));
        let k3 = rate(along(x, k2, h / 2.0));
        let k4 = rate(along(x, k3, h));
        let next: [f64; 3] =
            core::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        for i in 0..3 {
            sums[i] += 0.5 * h * (x[i].abs() + next[i].abs());
        }
        (x, t) = (next, t + h);
    }
}

/// The least eigenvalue of a symmetric 3 × 3 matrix, in closed form.
fn least_eigenvalue(m: [[f64; 3]; 3]) -> f64 {
    let trace = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
    let off = m[0][1].powi(2) + m[0][2].powi(2) + m[1][2].powi(2);
    let p = ((0..3).map(|i| (m[i][i] - trace).powi(2)).sum::<f64>() + 2.0 * off) / 6.0;
    let p = p.sqrt();
    let b = |i: usize, j: usize| (m[i][j] - if i == j { trace } else { 0.0 }) / p;
    let det = b(0, 0) * (b(1, 1) * b(2, 2) - b(1, 2) * b(2, 1))
        - b(0, 1) * (b(1, 0) * b(2, 2) - b(1, 2) * b(2, 0))
        + b(0, 2) * (b(1, 0) * b(2, 1) - b(1, 1) * b(2, 0));
    let angle = (det / 2.0).clamp(-1.0, 1.0).acos() / 3.0;
    trace + 2.0 * p * (angle + 2.0 * core::f64::consts::PI / 3.0).cos()
}

/// (22) and SB = (K_p, K_d, 1).
fn by_hand(kp: f64, kd: f64, a0: f64, k: f64) -> [f64; 3] {
    let sb = [kp, kd, 1.0];
    let q = [k * kp * kp, k * (kd * kd - 2.0 * kp), k];
    let matrix = core::array::from_fn(|i| {
        core::array::from_fn(|j| (2.0 * a0 - k) * sb[i] * sb[j] + if i == j { q[i] } else { 0.0 })
    });
    sb.map(|sb| 2.0 * sb / least_eigenvalue(matrix))
}

/// Gains at which (40) is false per entry: the worst φ makes more of ė.
#[test]
fn entries_of_40_are_those_by_hand_and_can_be_false() {
    let law = UnitLaw { kp: 6.321, kd: 6.537, a: vec![449.48] };
    let (is, want) = (by_40(&law, 418.8, 1.0), by_hand(6.321, 6.537, 449.48, 418.8));
    for (is, want) in is.iter().zip(want) {
        assert!((is / want - 1.0).abs() < 1e-6, "{is} {want}");
    }
    let l1 = areas(6.321, 6.537, 449.48);
    println!("(40) {want:?}, areas {l1:?}");
    assert!(want[2] < 0.85 * l1[2], "{want:?} {l1:?}");
}

#[test]
fn the_least_gains_by_40_are_least_and_their_rows_true() {
    let limits = ErrorLimits { phi_max: 22.2, x_max: vec![1e-3, 1e-2, 1e-1] };
    let found = RadiusGains::of(&limits).unwrap();
    let least = &found.by_40;
    println!("{found:?}");
    for (row, area) in found.rows.iter().zip(areas(least.kp, least.kd, least.k_tilde)) {
        assert!((row.worst / (22.2 * area) - 1.0).abs() < 2e-3, "{row:?} {area}");
    }
    let kept = |kp: f64, kd: f64, k: f64| {
        let bounds = by_hand(kp, kd, k, k);
        kd * kd > 2.0 * kp && bounds.iter().zip(&limits.x_max).all(|(b, x)| 22.2 * b <= *x)
    };
    assert!(kept(least.kp, least.kd, least.k_tilde * 1.001));
    // Nowhere on a grid is one per cent less enough.
    for i in -40..=40 {
        for j in -40..=40 {
            let (kp, kd) = (least.kp * 1.1_f64.powi(i), least.kd * 1.1_f64.powi(j));
            assert!(!kept(kp, kd, 0.99 * least.k_tilde), "{kp} {kd}");
        }
    }
}

/// (40) is false if the limit on ė decides; K̃ is then raised to the value that the areas require.
#[test]
fn where_40_is_false_the_gain_is_raised() {
    let limits = ErrorLimits { phi_max: 20.0, x_max: vec![0.4, 0.09, 0.01] };
    let found = RadiusGains::of(&limits).unwrap();
    println!("{found:?}");
    assert!(found.rows[2].refuted() && found.rows[2].worst > limits.x_max[2]);
    let (least, raised) = (&found.by_40, &found.gains);
    assert_eq!((least.kp, least.kd), (raised.kp, raised.kd));
    let at = |k: f64| 20.0 * areas(raised.kp, raised.kd, k)[2];
    assert!(at(raised.k_tilde) < 1.002 * 0.01 && at(0.99 * raised.k_tilde) > 0.01);
    let gains = made(&study([[0.4, 0.09, 0.01]; 3], [20.0; 3], "minimum_by = \"40\""));
    assert!(gains.method.contains("|ė|") && gains.method.contains("FALSE"), "{}", gains.method);
    assert!(gains.method.contains("K̃ raised"), "{}", gains.method);
    // Far too fast beside its outer loop for a claim, and it says so.
    assert!(gains.certificate.is_none() && gains.method.contains("no certificate: "));
}

#[test]
fn limits_that_make_no_sense_are_refused() {
    for x in [vec![1.0, 1.0], vec![0.0, 1.0, 1.0], vec![1.0, f64::NAN, 1.0]] {
        let refused = RadiusGains::of(&ErrorLimits { phi_max: 1.0, x_max: x });
        assert!(matches!(refused, Err(PaperError::Limit { .. } | PaperError::Order { .. })));
    }
    let second = ErrorLimits { phi_max: 22.2, x_max: vec![1e-4, 1e-3, 1e-2, 1e-1] };
    println!("(49): {:?}", RadiusGains::of(&second));
}
