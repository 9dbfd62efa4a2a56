//! For this to be wrong, `verify` would have to accept evidence with one number changed, or refuse it for
//! another reason.

use crate::claims_support::{Random, law, random_law};
use phihat_design::claims::{
    Attenuation, Certified, Iss, NormH, Optimality, PeakGain, PeakGains, UnitLaw,
};
use phihat_design::prelude::*;

const OFF: f64 = 1.0 + 1e-6;

fn certified(law: &UnitLaw) -> Certified {
    let k_tilde = Attenuation::of(law).unwrap().k_tilde().unwrap();
    Optimality::at(law, k_tilde).unwrap().certified().unwrap().clone()
}

fn refusal(law: &UnitLaw, certified: &Certified) -> String {
    Optimality::Certified(certified.clone()).verify(law).unwrap_err().inequality
}

fn laws() -> Vec<UnitLaw> {
    let mut random = Random(7);
    let mut out = vec![law(&[69.6]), law(&[4844.0, 139.2])];
    for case in 0..100 {
        let law = random_law(&mut random, 1 + case % 4);
        if Attenuation::of(&law).unwrap().diagonal.is_some() {
            out.push(law);
        }
    }
    out
}

#[test]
fn every_number_of_a_certificate_counts() {
    let all = laws();
    println!("{} laws", all.len());
    for law in all {
        let (good, n) = (certified(&law), law.order() + 2);
        let change = |f: &dyn Fn(&mut Certified)| {
            let mut bad = good.clone();
            f(&mut bad);
            refusal(&law, &bad)
        };
        assert_eq!(change(&|c| c.k_tilde *= OFF), "K̃ + 1/γ² = a_{m−1}");
        assert_eq!(change(&|c| c.gamma *= OFF), "K̃ + 1/γ² = a_{m−1}");
        assert_eq!(change(&|c| c.gamma *= -1.0), "γ > 0");
        assert_eq!(change(&|c| c.k_tilde = f64::NAN), "K̃ > 0");
        assert_eq!(change(&|c| c.s[0][1] *= OFF), "S = Sᵀ ∈ ℝ^{(m+2)×(m+2)}");
        assert_eq!(change(&|c| c.s[0][0] = f64::NAN), "S = Sᵀ ∈ ℝ^{(m+2)×(m+2)}");
        assert_eq!(change(&|c| c.q.push(1.0)), "Q and d are of size m+2");
        for i in 0..n {
            assert_eq!(change(&|c| c.q[i] *= OFF), format!("Q{0}{0} of (W1)", i + 1));
            assert_eq!(change(&|c| c.q[i] *= -1.0), format!("Q{0}{0} > 0", i + 1));
            assert_eq!(change(&|c| c.worst[i] *= OFF), "d = BᵀSx/γ²");
            for j in 0..=i {
                let why = change(&|c| {
                    c.s[i][j] *= OFF;
                    c.s[j][i] = c.s[i][j];
                });
                let expected = if i + 1 == n { "a_{m−1} BᵀS = K" } else { "|AᵀS + SA" };
                assert!(why.starts_with(expected), "S{i}{j}: {why}, {law:?}");
            }
        }
    }
}

/// A certificate belongs to one law: no gain of the law may change.
#[test]
fn every_gain_of_the_law_counts() {
    for law in laws() {
        let good = Optimality::Certified(certified(&law));
        good.verify(&law).unwrap();
        for i in 0..law.order() + 2 {
            let mut other = law.clone();
            match i {
                0 => other.kp *= OFF,
                1 => other.kd *= OFF,
                _ => other.a[i - 2] *= OFF,
            }
            assert!(good.verify(&other).is_err(), "gain {i} of {law:?}");
        }
    }
}

#[test]
fn a_refusal_must_be_true_too() {
    let experiment = law(&[69.6 * 69.6, 69.6]);
    let Optimality::Refuted(good) = Optimality::at(&experiment, 68.9).unwrap() else {
        unreachable!()
    };
    let check = |law: &UnitLaw, refused| Optimality::Refuted(refused).verify(law);
    check(&experiment, good.clone()).unwrap();
    let mut bad = good.clone();
    bad.value *= OFF;
    assert_eq!(check(&experiment, bad).unwrap_err().inequality, "Q44");
    let mut bad = good.clone();
    bad.condition = "A2".to_owned();
    assert_eq!(check(&experiment, bad).unwrap_err().inequality, "A2 fails");
    let mut feasible = good;
    feasible.k_tilde = 100.0;
    assert_eq!(check(&law(&[4844.0, 139.2]), feasible).unwrap_err().inequality, "Q44 ≤ 0");
}

#[test]
fn edges_of_attenuation_count() {
    for law in laws() {
        let good = Attenuation::of(&law).unwrap();
        let refused = |f: &dyn Fn(&mut Attenuation)| {
            let mut bad = good.clone();
            f(&mut bad);
            bad.verify(&law).unwrap_err().inequality
        };
        let a_top = law.a_top();
        let shift = |k: f64, share: f64| k + share * a_top;
        let gamma = |k: f64| Some(1.0 / (a_top - k).sqrt());
        let interval = good.diagonal.unwrap();
        assert_eq!(refused(&|c| c.gamma_diagonal = None), "γ is stated where K̃ is");
        let why = refused(&|c| {
            c.diagonal = None;
            c.gamma_diagonal = None;
        });
        assert_eq!(why, "no K̃ has q_i > 0 for all i");
        if interval.low > 0.0 {
            for (share, expected) in [(-1e-4, "> 0 inside"), (1e-4, "some q_i ≤ 0 beyond low")] {
                let low = shift(interval.low, share);
                let why = refused(&|c| {
                    c.diagonal.as_mut().unwrap().low = low;
                    c.gamma_diagonal = gamma(low);
                });
                assert!(why.contains(expected), "{why} {law:?}");
            }
        }
        let least = good.return_difference.unwrap();
        if least > 0.0 {
            for (share, expected) in [(-1e-4, "just above K̃_min"), (1e-4, "just below K̃_min")] {
                let why = refused(&|c| {
                    c.return_difference = Some(shift(least, share));
                    c.gamma_return_difference = gamma(shift(least, share));
                });
                assert!(why.contains(expected), "{why} {law:?}");
            }
        }
    }
}

#[test]
fn every_constant_of_stability_counts() {
    for law in laws().into_iter().take(30) {
        let good = Iss::of(&law, &certified(&law)).unwrap();
        let refused = |f: &dyn Fn(&mut Iss)| {
            let mut bad = good.clone();
            f(&mut bad);
            bad.verify(&law).unwrap_err().inequality
        };
        // The check knows the gain more closely than it is claimed.
        let (more, far) = (1.0 + 1e-5, 2.0);
        assert_eq!(refused(&|c| c.s_min *= more), "S ≽ s_min I");
        assert_eq!(refused(&|c| c.w_min *= more), "W ≽ w_min I");
        assert_eq!(refused(&|c| c.rate *= more), "W ≽ 2λS");
        assert_eq!(refused(&|c| c.s_max /= more), "‖S‖_F ≤ s_max");
        assert_eq!(refused(&|c| c.overshoot /= more), "overshoot = √(s_max/s_min)");
        assert_eq!(refused(&|c| c.sb_norm /= more), "|SB|");
        assert_eq!(refused(&|c| c.gamma1 *= more), "γ₁ = w_min/4");
        assert_eq!(refused(&|c| c.gamma2 /= more), "γ₂ = |SB|²/w_min");
        assert_eq!(refused(&|c| c.gain.upper /= far), "∫‖e^{(A−BK)τ}‖dτ ≤ its bound");
        assert_eq!(refused(&|c| c.gain.lower *= far), "∫‖e^{(A−BK)τ}‖dτ ≥ its lower bound");
        assert_eq!(refused(&|c| c.k_tilde = Some(2.1 * law.a_top())), "a_{m−1} > K̃/2 (α > ½)");
        assert_eq!(refused(&|c| c.s[0][1] *= more), "S = Sᵀ");
    }
}

#[test]
fn every_gain_of_performance_counts() {
    for law in laws().into_iter().take(12) {
        let good = PeakGains::of(&law, 1.0).unwrap();
        for i in 0..good.states.len() {
            let mut bad = good.clone();
            bad.states[i].upper /= OFF;
            let why = bad.verify(&law).unwrap_err().inequality;
            assert_eq!(why, format!("‖G_x{}‖₁ ≤ its bound", i + 1));
        }
        let mut bad = good.clone();
        bad.estimate.lower *= OFF;
        let why = bad.verify(&law).unwrap_err().inequality;
        assert_eq!(why, "‖G_(φ̂−φ)‖₁ ≥ its lower bound");
        let mut bad = good.clone();
        bad.states.push(PeakGain { lower: 0.0, upper: 1.0 });
        assert_eq!(bad.verify(&law).unwrap_err().inequality, "gains of m+2 states");
        let norm = NormH::of(&law, 1.0).unwrap();
        let refused = |f: &dyn Fn(&mut NormH)| {
            let mut bad = norm.clone();
            f(&mut bad);
            bad.verify(&law).unwrap_err().inequality
        };
        assert_eq!(refused(&|c| c.lower *= OFF), "|G(jω*)| ≥ lower");
        assert_eq!(refused(&|c| c.frequency_rad_s *= 1.1), "|G(jω*)| ≥ lower");
        assert!(refused(&|c| c.upper /= 1.0 + 4e-6).starts_with("upper²"));
        assert_eq!(refused(&|c| c.mu = -1.0), "μ > 0");
    }
}

/// Without its feature `float_roundtrip`, serde_json may miss the last bit: the claim must survive that.
#[test]
fn claims_survive_text_and_refuse_unknown_keys() {
    let law = law(&[4844.0, 139.2]);
    let claim = Optimality::at(&law, 100.0).unwrap();
    let text = serde_json::to_string(&claim).unwrap();
    serde_json::from_str::<Optimality>(&text).unwrap().verify(&law).unwrap();
    let extra = text.replacen("\"k_tilde\"", "\"colour\":1,\"k_tilde\"", 1);
    assert!(serde_json::from_str::<Optimality>(&extra).is_err());
    let attenuation = serde_json::to_string(&Attenuation::of(&law).unwrap()).unwrap();
    serde_json::from_str::<Attenuation>(&attenuation).unwrap().verify(&law).unwrap();
    let iss = Iss::of(&law, claim.certified().unwrap()).unwrap();
    let iss = serde_json::to_string(&iss).unwrap();
    serde_json::from_str::<Iss>(&iss).unwrap().verify(&law).unwrap();
    let gains = serde_json::to_string(&PeakGains::of(&law, 1.0).unwrap()).unwrap();
    serde_json::from_str::<PeakGains>(&gains).unwrap().verify(&law).unwrap();
    let norm = serde_json::to_string(&NormH::of(&law, 1.0).unwrap()).unwrap();
    serde_json::from_str::<NormH>(&norm).unwrap().verify(&law).unwrap();
}

#[test]
fn nonsense_is_refused_before_it_is_computed() {
    for (bad, expected) in [
        (law(&[]), "m ≥ 1"),
        (law(&[1.0; 5]), "m ≤ 4"),
        (law(&[f64::NAN]), "|gain| < ∞"),
        (law(&[100.0, 0.0]), "a_{m−1} > 0"),
    ] {
        assert_eq!(Optimality::at(&bad, 1.0).unwrap_err().inequality, expected);
        assert_eq!(Attenuation::of(&bad).unwrap_err().inequality, expected);
        assert_eq!(Iss::of_loop(&bad).unwrap_err().inequality, expected);
        assert_eq!(PeakGains::of(&bad, 1.0).unwrap_err().inequality, expected);
        assert_eq!(NormH::of(&bad, 1.0).unwrap_err().inequality, expected);
    }
}
