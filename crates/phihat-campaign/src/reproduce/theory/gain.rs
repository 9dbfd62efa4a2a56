//! The L2 gain (11), measured on loops that run, and its exact value over frequency.

use core::f64::consts::TAU;

use phihat_design::claims::{Certified, Law, Optimality, polynomial};

use super::super::compose::{curve, lines, log_axis, number, three, words};
use super::super::draw::Draw;
use super::super::gains::{K_TILDE_H3, second_h3};
use super::super::joint::{Form, Phi, run};
use super::super::record::{Bound, Figure, Panel, Section, Statement, Verdict};
use super::super::said::Said;

/// A step that resolves the estimator \[s\].
const STEP: f64 = 2e-4;

/// The gain from φ to the cost, at H3.
pub(super) fn l2_gain() -> Result<Section, String> {
    let law = second_h3();
    let claim = Optimality::at(&law, K_TILDE_H3).map_err(|e| e.to_string())?;
    let c = claim.certified().ok_or("H3 has a certificate at K̃ = 100")?;
    let gamma2 = c.gamma * c.gamma;
    let mut measured = Vec::new();
    for (name, phi) in signals() {
        measured.push((name, gain_on(&law, c, &phi)));
    }
    let most = measured.iter().fold(0.0_f64, |most, (_, gain)| most.max(*gain));
    let grid: Vec<f64> = (0..=600).map(|k| 10.0_f64.powf(f64::from(k) / 120.0 - 1.0)).collect();
    let exact = |omega: f64| gain_at(&law, c, omega);
    let peak = grid.iter().copied().fold(grid[0], |p, w| if exact(w) > exact(p) { w } else { p });
    let text = measured.iter().map(|(name, gain)| format!("{name}: {}", three((*gain).into())));
    let statement = Said {
        id: "l2-gain-bound",
        place: "(11), Theorem 2",
        claim: "∫(xᵀQx + φ̂ᵀRφ̂) ≤ γ² ∫φ² from rest",
        paper: "≤ γ²",
    }
    .found(
        format!(
            "{} of γ² at most on simulated φ, {} at the worst frequency",
            three((most / gamma2).into()),
            three((exact(peak) / gamma2).into())
        ),
        Verdict::of(most <= gamma2 && exact(peak) <= gamma2, false),
        format!(
            "Gains H3, γ² = {}. Runs: {}. Over frequency the largest gain is {} at {} rad/s.",
            three(gamma2.into()),
            text.collect::<Vec<_>>().join("; "),
            three(exact(peak).into()),
            three(peak.into())
        ),
        vec![
            number("γ²", "", gamma2, 1e-9),
            number("largest gain on simulated φ", "", most, 1e-3),
            number("largest gain over frequency", "", exact(peak), 1e-3),
        ],
    )
    .assuming(&["gains"]);
    let figure = figure(&grid, exact, gamma2);
    Ok(Section {
        id: "l2-gain".to_owned(),
        title: "(11): the gain from disturbance to cost".to_owned(),
        text: words(&[
            "Q and R are those of the certificate of H3 at K̃ = 100. The loop is solved exactly, the two \
                       integrals by the trapezoidal rule at 0.2 ms, until nothing moves any more.",
        ]),
        statements: vec![statement, not_in_l2(&law)],
        tables: Vec::new(),
        figures: vec![figure],
    })
}

fn figure(grid: &[f64], exact: impl Fn(f64) -> f64, gamma2: f64) -> Figure {
    let bound = Bound { label: "γ²".to_owned(), value: gamma2, both: false };
    let series = vec![curve("cost / disturbance", grid.iter().map(|w| [*w, exact(*w)]))];
    let axes = (log_axis("ω [rad/s]"), log_axis("gain"));
    let panel: Panel = lines("From φ to the cost, H3", axes, series, vec![bound]);
    Figure {
        id: "l2-gain".to_owned(),
        title: "Gain from φ to the cost of (11), over frequency".to_owned(),
        caption: "The paper has no such figure. The curve stays below γ² at every frequency."
            .to_owned(),
        panels: vec![panel],
    }
}

/// Pulses of φ, which end.
fn signals() -> Vec<(&'static str, Phi)> {
    let steps = 20_000;
    let time = |k: usize| k as f64 * STEP;
    let joined = |f: &dyn Fn(f64) -> f64| Phi::Joined((0..steps).map(|k| f(time(k))).collect());
    let window = |t: f64| if t < 2.0 { (TAU * t / 4.0).sin().powi(2) } else { 0.0 };
    let mut draw = Draw(11);
    let noise: Vec<f64> = (0..steps).map(|_| draw.between(-1.0, 1.0)).collect();
    vec![
        ("a push of 0.1 s", joined(&|t| f64::from(u8::from(t < 0.1)))),
        ("a push of 1 s", joined(&|t| f64::from(u8::from(t < 1.0)))),
        ("a burst at 69.6 rad/s", joined(&|t| window(t) * (69.6 * t).sin())),
        ("a burst at 20 rad/s", joined(&|t| window(t) * (20.0 * t).sin())),
        ("2 s of noise", Phi::Joined((0..steps).map(|k| window(time(k)) * noise[k]).collect())),
    ]
}

/// `∫(xᵀQx + φ̂ᵀRφ̂)/∫φ²` of one run from rest.
fn gain_on(law: &Law, c: &Certified, phi: &Phi) -> f64 {
    let (mut cost, mut energy) = (0.0, 0.0);
    for now in run(law, Form::Ladder, &[], phi, (STEP, 20_000)) {
        let state: f64 = c.q.iter().zip(&now.x).map(|(q, x)| q * x * x).sum();
        cost += state + now.phi_hat * now.phi_hat / law.a_top();
        energy += now.phi * now.phi;
    }
    cost / energy
}

/// The same at one frequency: `x_i = (jω)^{i−1} d/(D A_o)`, `φ̂ = −a_{m−1} g d/A_o`.
fn gain_at(law: &Law, c: &Certified, omega: f64) -> f64 {
    let w = omega * omega;
    let size = |p: &[f64]| polynomial::value(&polynomial::magnitude_squared(p), w);
    let state = polynomial::value(&c.q, w) / (size(&law.d()) * size(&law.a_o()));
    state + law.a_top() * size(&law.g()) / size(&law.a_o())
}

/// Gravity has infinite energy, and does no harm.
fn not_in_l2(law: &Law) -> Statement {
    let phi = 22.2;
    let energy = |t: f64| phi * phi * t;
    let rows = run(law, Form::Estimator, &[], &Phi::polynomial(&[phi]), (1e-3, 10_000));
    let most = rows.iter().fold(0.0_f64, |most, x| most.max(x.e.abs()));
    let last = rows.last().map_or(f64::NAN, |x| x.e.abs());
    let bounded = most < 0.1 && last < 1e-9;
    Said {
        id: "erratum-l2",
        place: "Sec. III-B",
        claim: "The loop is stable for φ ∈ L₂[0, ∞)",
        paper: "φ ∈ L₂[0, ∞)",
    }
    .found(
        format!(
            "a constant φ = {phi} has ∫φ² = {} and {} after 1 and 100 s; |e| peaks at {} rad and ends at {:.0e}",
            three(energy(1.0).into()),
            three(energy(100.0).into()),
            three(most.into()),
            last
        ),
        // The statement needs ∫φ² to stay finite for what acts on an arm.
        Verdict::of(energy(100.0) < 1.01 * energy(1.0), bounded),
        "Gravity, friction and anything periodic are not in L₂[0, ∞), so that (11) says nothing about them. \
         Input-to-state stability does: bounded φ gives bounded x.",
        vec![number("largest |e|", "rad", most, 1e-4)],
    )
    .assuming(&["phi-max"])
}
