//! Claims about the continuous law: honest ones pass, each figure a little beyond the result is refused, and
//! closed forms are met.
//! Wrong if a level of attenuation, a weight of a game, a norm, a gain or a constant of stability passed that
//! the law has not.

use crate::edits::{Edit, Passed};
use phihat_certificate::{
    Attenuation, Iss, LevelRefused, NormH, Optimality, PaperRadius, PeakGain, PeakGains, UnitLaw,
};
use phihat_design::prelude::*;

/// Relative distance of an edited figure from the result.
const BEYOND: f64 = 1e-4;

/// Laws of every order: with a game, without one, and with one above a level only.
fn laws() -> Vec<UnitLaw> {
    let law = |kp: f64, kd: f64, a: &[f64]| UnitLaw { kp, kd, a: a.to_vec() };
    vec![
        law(400.0, 40.0, &[60.0]),
        // K_d² < 2K_p: no diagonal weights.
        law(400.0, 20.0, &[60.0]),
        law(400.0, 40.0, &[3600.0, 120.0]),
        law(400.0, 20.0, &[3600.0, 120.0]),
        // Little damping: only near a_{m−1}.
        law(100.0, 30.0, &[6400.0, 130.0]),
        law(90.0, 25.0, &[27e3, 2700.0, 90.0]),
        law(90.0, 25.0, &[810e3, 108e3, 5400.0, 120.0]),
    ]
}

fn gamma(law: &UnitLaw, k_tilde: f64) -> f64 {
    1.0 / (law.a_top() - k_tilde).sqrt()
}

/// An edited claim, its `γ` those of its `K̃`.
fn stated(found: &Attenuation, law: &UnitLaw, edit: &dyn Fn(&mut Attenuation)) -> Attenuation {
    let mut other = found.clone();
    edit(&mut other);
    other.gamma_diagonal = other.diagonal.map(|i| gamma(law, i.low));
    other.gamma_return_difference = other.return_difference.map(|k| gamma(law, k));
    other
}

#[test]
fn levels_of_attenuation_are_neither_lower_nor_higher_than_they_are() {
    let mut passed = Passed::default();
    let (mut with, mut without) = (0, 0);
    for law in laws() {
        let about = format!("{law:?}");
        let verify = |a: &Attenuation| a.verify(&law);
        let found = Attenuation::of(&law).unwrap();
        passed.edits(
            &about,
            &found,
            verify,
            &[
                ("γ of the weights alone", |a| a.gamma_diagonal = a.gamma_diagonal.xor(Some(1.0))),
                ("γ of the difference alone", |a| {
                    a.gamma_return_difference = a.gamma_return_difference.xor(Some(1.0));
                }),
                ("blocked at no frequency", |a| a.blocking_w = Some(-1.0)),
            ],
        );
        let at = |edit: &dyn Fn(&mut Attenuation)| verify(&stated(&found, &law, edit));
        if let Some(own) = found.diagonal {
            with += 1;
            let step = BEYOND * (own.high - own.low);
            for low in [own.low - step, own.low + step] {
                let checked = at(&|a| a.diagonal.as_mut().unwrap().low = low);
                // From 0 on nothing is in the way below: more than 0 is a claim less.
                if own.low > 0.0 || low < 0.0 {
                    passed.refused(&format!("low {low} {own:?} {about}"), &checked);
                }
            }
            let checked = at(&|a| a.diagonal.as_mut().unwrap().high = own.high + step);
            passed.refused(&format!("high {own:?} {about}"), &checked);
            let swapped = phihat_certificate::Interval { low: own.high, high: own.low };
            passed.refused(&about, &at(&|a| a.diagonal = Some(swapped)));
            passed.refused(&format!("denied {about}"), &at(&|a| a.diagonal = None));
        } else {
            without += 1;
            let top = law.a_top();
            let some = phihat_certificate::Interval { low: 0.3 * top, high: 0.9 * top };
            passed.refused(&about, &at(&|a| a.diagonal = Some(some)));
        }
    }
    assert!(with > 0 && without > 0, "{with} {without}");
    passed.none(25);
}

#[test]
fn levels_of_the_return_difference_are_neither_lower_nor_higher_than_they_are() {
    let mut passed = Passed::default();
    let mut above = 0;
    for law in laws() {
        let about = format!("{law:?}");
        let found = Attenuation::of(&law).unwrap();
        let at = |edit: &dyn Fn(&mut Attenuation)| stated(&found, &law, edit).verify(&law);
        let least = found.return_difference;
        if let Some(least) = least.filter(|k| *k > 0.0) {
            above += 1;
            for k in [least * (1.0 - BEYOND), least * (1.0 + BEYOND), -least] {
                let checked = at(&|a| a.return_difference = Some(k));
                passed.refused(&format!("K̃ {k} of {least} {about}"), &checked);
            }
        }
        if least.is_some() {
            passed.refused(&about, &at(&|a| a.return_difference = None));
            passed.refused(&about, &at(&|a| a.return_difference = Some(law.a_top())));
        }
        if least == Some(0.0) {
            passed.refused(&about, &at(&|a| a.blocking_w = Some(1.0)));
        }
    }
    assert!(above > 0);
    passed.none(10);
}

#[test]
fn a_game_is_the_laws_own_in_every_entry() {
    let mut passed = Passed::default();
    for law in laws() {
        let Some(k_tilde) = Attenuation::of(&law).unwrap().k_tilde() else { continue };
        let found = Optimality::at(&law, k_tilde).unwrap();
        let about = format!("{law:?}");
        passed.holds(&about, found.verify(&law));
        let Optimality::Certified(own) = &found else { panic!("{found:?}") };
        let n = own.q.len();
        let mut refused = |what: &str, edit: &dyn Fn(&mut phihat_certificate::Certified)| {
            let mut other = own.clone();
            edit(&mut other);
            passed.refused(&format!("{what} {about}"), &Optimality::Certified(other).verify(&law));
        };
        refused("K̃", &|c| c.k_tilde *= 1.0 + 1e-9);
        refused("γ", &|c| c.gamma *= 1.0 - 1e-9);
        refused("−γ", &|c| c.gamma = -c.gamma);
        refused("both", &|c| {
            c.k_tilde *= 1.01;
            c.gamma = gamma(&law, c.k_tilde);
        });
        refused("a weight less", &|c| c.q.truncate(n - 1));
        refused("a worst less", &|c| c.worst.truncate(n - 1));
        refused("a row less", &|c| c.s.truncate(n - 1));
        for i in 0..n {
            refused("q", &|c| c.q[i] *= 1.0 + 1e-8);
            refused("−q", &|c| c.q[i] = -c.q[i]);
            refused("worst", &|c| c.worst[i] *= 1.0 + 1e-9);
            refused("a short row", &|c| c.s[i].truncate(n - 1));
            for j in 0..=i {
                let size = (own.s[i][i] * own.s[j][j]).sqrt();
                let shift = |c: &mut phihat_certificate::Certified, by: f64| {
                    c.s[i][j] += by * size;
                    c.s[j][i] = c.s[i][j];
                };
                refused("S", &|c| shift(c, 1e-3));
                refused("S", &|c| shift(c, -1e-3));
                if i != j {
                    refused("S uneven", &|c| c.s[i][j] *= 1.0 + 1e-9);
                }
            }
        }
    }
    passed.none(100);
}

#[test]
fn a_refusal_names_the_condition_that_fails() {
    // Order, damping, K̃ and the paper's condition that fails first from the end; the quantity says so in numbers.
    let law = |kp: f64, kd: f64, a: &[f64]| UnitLaw { kp, kd, a: a.to_vec() };
    let cases = [
        (law(400.0, 20.0, &[60.0]), 30.0, "B2"),
        (law(400.0, 20.0, &[3600.0, 120.0]), 90.0, "A2"),
        (law(400.0, 40.0, &[3600.0, 120.0]), 40.0, "A3"),
    ];
    let mut passed = Passed::default();
    for (law, k_tilde, condition) in &cases {
        let found = Optimality::at(law, *k_tilde).unwrap();
        let Optimality::Refuted(own) = &found else { panic!("{found:?}") };
        assert_eq!(own.condition, *condition, "{own:?}");
        passed.holds(condition, found.verify(law));
        let names = ["A1", "A2", "A3", "B1", "B2", "xyzzy", ""];
        for name in names.into_iter().filter(|name| name != condition) {
            let other = LevelRefused { condition: name.into(), ..own.clone() };
            passed.refused(name, &Optimality::Refuted(other).verify(law));
        }
        // The quantity's own name says as much as the paper's.
        for name in [own.quantity.clone(), format!("{} > 0", own.quantity)] {
            let other = LevelRefused { condition: name, ..own.clone() };
            passed.holds(condition, Optimality::Refuted(other).verify(law));
        }
        let edits: [Edit<LevelRefused>; 5] = [
            ("another value", |r| r.value *= 1.0 + 1e-8),
            ("its negative", |r| r.value = -r.value),
            ("another quantity", |r| r.quantity = "K_p".into()),
            ("no quantity", |r| r.quantity = String::new()),
            ("another K̃", |r| r.k_tilde *= 1.01),
        ];
        let verify = |r: &LevelRefused| Optimality::Refuted(r.clone()).verify(law);
        passed.edits(condition, own, verify, &edits);
    }
    // Where weights exist nothing is refused, whatever is said of it.
    let fine = law(400.0, 40.0, &[3600.0, 120.0]);
    for (quantity, value) in [("Q11", -1.0), ("Q44", -1e-3), ("K̃", -1.0), ("a_i", -1.0)] {
        let refused = LevelRefused {
            k_tilde: 90.0,
            condition: format!("{quantity} > 0"),
            quantity: quantity.into(),
            value,
        };
        passed.refused(quantity, &Optimality::Refuted(refused).verify(&fine));
    }
    // K̃ outside of (0, a_{m−1}), and gains that are not positive.
    let named = |k_tilde: f64, condition: &str, quantity: &str, value: f64| {
        let (condition, quantity) = (condition.to_owned(), quantity.to_owned());
        Optimality::Refuted(LevelRefused { k_tilde, condition, quantity, value })
    };
    passed.holds("below", named(-1.0, "K̃ > 0", "K̃", -1.0).verify(&fine));
    passed.holds("none", named(0.0, "K̃ > 0", "K̃", 0.0).verify(&fine));
    passed.holds("above", named(121.0, "K̃ < a_{m−1}", "a_{m−1} − K̃", -1.0).verify(&fine));
    passed.holds("at", named(120.0, "K̃ < a_{m−1}", "a_{m−1} − K̃", 0.0).verify(&fine));
    passed.refused("inside", &named(119.0, "K̃ < a_{m−1}", "a_{m−1} − K̃", 1.0).verify(&fine));
    passed.none(30);
}

/// `|G(jω)|` from `φ` to the error, `M̄ = 1`: `ω^m/|D A_o + (μ−1)s^{m+2}|`.
fn size(law: &UnitLaw, mu: f64, w: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (k, c) in law.denominator(mu).into_iter().enumerate() {
        let term = c * w.powi(i32::try_from(k).unwrap());
        match k % 4 {
            0 => re += term,
            1 => im += term,
            2 => re -= term,
            _ => im -= term,
        }
    }
    w.powi(i32::try_from(law.order()).unwrap()) / f64::hypot(re, im)
}

#[test]
fn the_norm_is_the_largest_size_of_the_response() {
    let mut passed = Passed::default();
    for law in laws() {
        let at = |k: i32| 1e-2 * 1.0005_f64.powi(k);
        let (mut most, mut where_at) = (0.0, 0.0);
        for w in (0..30_000).map(at) {
            let here = size(&law, 1.0, w);
            (most, where_at) = if here > most { (here, w) } else { (most, where_at) };
        }
        let about = format!("{law:?}");
        let verify = |n: &NormH| n.verify(&law);
        let near = |lower: f64, upper: f64| NormH {
            mu: 1.0,
            lower: most * lower,
            upper: most * upper,
            frequency_rad_s: where_at,
        };
        let edits: [Edit<NormH>; 9] = [
            ("upper", |n| n.upper *= 1.0 - 3e-5),
            ("lower", |n| n.lower *= 1.0 + 3e-5),
            ("another frequency", |n| n.frequency_rad_s *= 1.05),
            ("no frequency", |n| n.frequency_rad_s = f64::INFINITY),
            ("its negative", |n| n.frequency_rad_s = -n.frequency_rad_s),
            ("negative upper", |n| n.upper = -n.upper),
            ("negative lower", |n| n.lower = -n.lower),
            ("no upper", |n| n.upper = 0.0),
            ("no lower", |n| n.lower = 0.0),
        ];
        passed.edits(&about, &near(1.0 - 1e-5, 1.0 + 1e-5), verify, &edits);
    }
    passed.none(60);
}

#[test]
fn peak_gains_are_held_from_both_sides() {
    let mut passed = Passed::default();
    for law in laws().into_iter().step_by(2) {
        for mu in if law.order() == 1 { vec![0.8, 1.5] } else { vec![1.0] } {
            let found = PeakGains::of(&law, mu).unwrap();
            let about = format!("{law:?} {mu}");
            passed.holds(&about, found.verify(&law));
            for i in 0..=found.states.len() {
                let mut refused = |what: &str, edit: &dyn Fn(&mut PeakGain)| {
                    let mut other = found.clone();
                    edit(other.states.get_mut(i).unwrap_or(&mut other.estimate));
                    passed.refused(&format!("{what} of {i}: {about}"), &other.verify(&law));
                };
                refused("upper", &|gain| gain.upper *= 1.0 - BEYOND);
                refused("lower", &|gain| gain.lower *= 1.0 + BEYOND);
                if i == 0 {
                    refused("negative lower", &|gain| gain.lower = -1e-9);
                    refused("no upper", &|gain| gain.upper = f64::INFINITY);
                }
            }
            let mut other = found.clone();
            other.states.pop();
            passed.refused(&about, &other.verify(&law));
        }
    }
    passed.none(50);
}

#[test]
fn real_poles_keep_the_sign_of_what_they_let_through() {
    // Between real poles every impulse response is positive: its area is the gain at rest, 1/(K_p a_0).
    let law = UnitLaw { kp: 300.0, kd: 40.0, a: vec![60.0] };
    let area = 1.0 / (300.0 * 60.0);
    let found = PeakGains::of(&law, 1.0).unwrap();
    let mut claim = found.clone();
    claim.states[0] = PeakGain { lower: area * (1.0 - 1e-7), upper: area * (1.0 + 1e-7) };
    claim.verify(&law).unwrap();
    claim.states[0].upper = area * (1.0 - 1e-7);
    claim.states[0].lower = 0.0;
    assert!(claim.verify(&law).is_err());
    claim.states[0] = PeakGain { lower: area * (1.0 + 1e-7), upper: 1.0 };
    assert!(claim.verify(&law).is_err());
}

#[test]
fn constants_of_input_to_state_stability_are_the_largest_that_hold() {
    let mut passed = Passed::default();
    for law in laws().into_iter().step_by(2) {
        let own = Attenuation::of(&law).unwrap().k_tilde();
        let game = own.map(|k| Optimality::at(&law, k).unwrap());
        let of_game =
            game.as_ref().and_then(Optimality::certified).map(|c| Iss::of(&law, c).unwrap());
        for found in of_game.into_iter().chain([Iss::of_loop(&law).unwrap()]) {
            let about = format!("{law:?} {:?}", found.k_tilde);
            let verify = |i: &Iss| i.verify(&law);
            let edits: [Edit<Iss>; 14] = [
                ("s_min", |i| {
                    i.s_min *= 1.0 + BEYOND;
                    i.overshoot = (i.s_max / i.s_min).sqrt();
                }),
                ("s_max", |i| {
                    i.s_max *= 1.0 - BEYOND;
                    i.overshoot = (i.s_max / i.s_min).sqrt();
                }),
                ("no s_min", |i| {
                    i.s_min = -i.s_min;
                    i.overshoot = (i.s_max / i.s_min).sqrt();
                }),
                ("w_min", |i| {
                    let share = 1.0 + BEYOND;
                    i.w_min *= share;
                    i.gamma2 /= share;
                    i.gamma1 /= share;
                }),
                ("rate", |i| i.rate *= 1.0 + BEYOND),
                ("no rate", |i| i.rate = 0.0),
                ("overshoot", |i| i.overshoot *= 1.0 - 1e-9),
                ("‖SB‖", |i| i.sb_norm *= 1.0 - 1e-9),
                ("γ₁", |i| i.gamma1 *= 1.0 - 1e-9),
                ("γ₂", |i| i.gamma2 *= 1.0 - 1e-9),
                ("gain", |i| i.gain.upper *= 0.8),
                ("gain from below", |i| i.gain.lower *= 1.25),
                ("a row less", |i| i.s.truncate(2)),
                ("uneven", |i| i.s[1][0] *= 1.0 + 1e-9),
            ];
            passed.edits(&about, &found, verify, &edits);
            let radius = PaperRadius::of(&found);
            let verify = |p: &PaperRadius| p.verify(&law, &found);
            let edits: [Edit<PaperRadius>; 2] = [
                ("printed", |p| p.printed *= 1.0 - 1e-8),
                ("corrected", |p| p.corrected *= 1.0 - 1e-8),
            ];
            passed.edits(&about, &radius, verify, &edits);
        }
    }
    passed.none(100);
}
