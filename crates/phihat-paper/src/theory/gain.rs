//! The L2 gain (11), measured on loops that run, and its exact value over frequency.

use core::f64::consts::TAU;

use phihat_design::claims::{Certified, Optimality, UnitLaw, polynomial};
use phihat_design::prelude::*;

use crate::compose::{curve, lines, log_axis, number, three, words};
use crate::draw::Draw;
use crate::gains::{K_TILDE, K_TILDE_H3, all as laws, first, second_h3};
use crate::joint::{PaperForm, PhiCourse, largest, run};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{PaperNumber, Section, Statement, Verdict};
use phihat_report::kit::figure::{Bound, Figure, Panel};

/// A step that resolves the estimator \[s\].
const STEP: f64 = 2e-4;

/// The gain from φ to the cost of one certified law.
struct TheoryGain {
    name: &'static str,
    law: UnitLaw,
    certified: Certified,
    /// On every simulated φ.
    runs: Vec<(&'static str, f64)>,
    /// Frequency at which it is largest \[rad/s\], and its value there.
    peak: (f64, f64),
}

impl TheoryGain {
    fn of(name: &'static str, law: UnitLaw, k_tilde: f64) -> Result<Self, PartError> {
        let claim = Optimality::at(&law, k_tilde)?;
        let certified = claim.certified().ok_or(PartError::NoCertificate(name))?.clone();
        let on =
            |(signal, phi): &(&'static str, PhiCourse)| (*signal, gain_on(&law, &certified, phi));
        let runs = signals().iter().map(on).collect();
        let at = |omega: f64| gain_at(&law, &certified, omega);
        let higher = |p: f64, w: f64| if at(w) > at(p) { w } else { p };
        let omega = [0.0].into_iter().chain(grid()).reduce(higher).unwrap_or(f64::NAN);
        let peak = (omega, at(omega));
        Ok(Self { name, law, certified, runs, peak })
    }

    fn gamma2(&self) -> f64 {
        self.certified.gamma.powi(2)
    }

    fn most(&self) -> f64 {
        self.runs.iter().fold(0.0_f64, |most, (_, gain)| most.max(*gain))
    }

    fn numbers(&self) -> Vec<PaperNumber> {
        let name = |what: &str| format!("{what}, {}", self.name);
        vec![
            number(&name("γ²"), "", self.gamma2(), 1e-9),
            number(&name("largest gain on simulated φ"), "", self.most(), 1e-3),
            number(&name("largest gain over frequency"), "", self.peak.1, 1e-3),
        ]
    }
}

/// Frequencies from 0.1 to 10 000 rad/s.
fn grid() -> Vec<f64> {
    (0..=600).map(|k| 10.0_f64.powf(f64::from(k) / 120.0 - 1.0)).collect()
}

/// The gain from φ to the cost, where there is a certificate.
pub(super) fn l2_gain() -> Result<Section, PartError> {
    let all = [
        TheoryGain::of("H3", second_h3(), K_TILDE_H3)?,
        TheoryGain::of("m = 1", first(), K_TILDE)?,
    ];
    Ok(Section {
        id: "l2-gain".to_owned(),
        title: "(11): the gain from disturbance to cost".to_owned(),
        text: words(&[
            "Q and R are those of the certificates of m = 1 at the printed K̃ = 68.9 and of H3 at K̃ = 100; H1 and H2 \
             have none, so that there are no Q and R to ask about. The loop is solved exactly, the two integrals by \
             the trapezoidal rule at 0.2 ms, until nothing moves any more.",
        ]),
        statements: vec![bound(&all), smallest(&all), below_gamma(&all), not_in_l2()],
        tables: Vec::new(),
        figures: vec![figure(&all[0])],
    })
}

fn bound(all: &[TheoryGain]) -> Statement {
    let holds = |g: &TheoryGain| g.most() <= g.gamma2() && g.peak.1 <= g.gamma2();
    let share = |g: &TheoryGain| {
        let [most, peak] = [g.most(), g.peak.1].map(|gain| three((gain / g.gamma2()).into()));
        format!("{}: {most} of γ² at most on simulated φ, {peak} at the worst frequency", g.name)
    };
    let why = |g: &TheoryGain| {
        let runs = g.runs.iter().map(|(name, gain)| format!("{name}: {}", three((*gain).into())));
        format!(
            "{}, γ² = {}: {}; over frequency {} at {} rad/s.",
            g.name,
            three(g.gamma2().into()),
            runs.collect::<Vec<_>>().join("; "),
            three(g.peak.1.into()),
            three(g.peak.0.into())
        )
    };
    Published {
        id: "l2-gain-bound",
        place: "(11), Theorem 2",
        claim: "∫(xᵀQx + φ̂ᵀRφ̂) ≤ γ² ∫φ² from rest",
        paper: "≤ γ²",
    }
    .found(
        all.iter().map(share).collect::<Vec<_>>().join("; "),
        Verdict::of(all.iter().all(holds), false),
        format!(
            "{} With the printed b_0 (H1, H2) no K̃ gives a Q ≻ 0, and Theorem 2 states nothing.",
            all.iter().map(why).collect::<Vec<_>>().join(" ")
        ),
        all.iter().flat_map(TheoryGain::numbers).collect(),
    )
    .assuming(&["gains"])
}

/// "There also exists a smallest γ* > 0."
fn smallest(all: &[TheoryGain]) -> Statement {
    let star = |g: &TheoryGain| (g.name, g.peak.1.sqrt(), g.certified.gamma);
    let found: Vec<_> = all.iter().map(star).collect();
    let listed = found.iter().map(|(name, star, gamma)| {
        format!("{name}: γ* = {}, certified γ = {}", three((*star).into()), three((*gamma).into()))
    });
    Published {
        id: "gamma-star",
        place: "After (11)",
        claim: "There is a smallest γ* > 0 such that (11) holds for every γ > γ*",
        paper: "γ* > 0",
    }
    .found(
        listed.collect::<Vec<_>>().join("; "),
        Verdict::of(found.iter().all(|(_, star, gamma)| 0.0 < *star && star <= gamma), false),
        "With Q and R given, γ*² is the largest gain over frequency, positive and finite for a stable loop. In the \
         inverse problem Q and R come with γ: another γ at the same a_{m−1} is another K̃, and another cost.",
        found.iter().map(|(name, star, _)| number(&format!("γ*, {name}"), "", *star, 1e-3)).collect(),
    )
    .assuming(&["gains"])
}

/// "The L2 gain is always less than γ", after (11) has called γ² its bound.
fn below_gamma(all: &[TheoryGain]) -> Statement {
    let worst = |root: bool| {
        let gain =
            |g: &TheoryGain| if root { g.peak.1.sqrt() } else { g.peak.1 } / g.certified.gamma;
        all.iter().map(gain).fold(0.0_f64, f64::max)
    };
    let (squares, norms) = (worst(false), worst(true));
    Published {
        id: "gain-below-gamma",
        place: "After Theorem 2",
        claim: "The L₂ gain is less than γ",
        paper: "less than γ; (11): at most γ²",
    }
    .found(
        format!(
            "largest ratio of (11): {} of γ; its root, the gain between norms: {} of γ",
            three(squares.into()),
            three(norms.into())
        ),
        Verdict::of(norms <= 1.0, false),
        "Read as the ratio of norms, which (11) bounds by γ. (11) itself calls the ratio of the squared norms the \
         gain, and bounds it by γ²: by that word \"less than γ\" does not follow where γ > 1, as at m = 1 with γ = \
         1.2, though it is so at these gains.",
        vec![
            number("largest ratio of squares, as a share of γ", "", squares, 1e-3),
            number("largest ratio of norms, as a share of γ", "", norms, 1e-3),
        ],
    )
    .assuming(&["gains"])
}

fn figure(gain: &TheoryGain) -> Figure {
    let bound = Bound::at("γ²", gain.gamma2());
    let exact = |omega: f64| gain_at(&gain.law, &gain.certified, omega);
    let series = vec![curve("cost / disturbance", grid().into_iter().map(|w| [w, exact(w)]))];
    let axes = (log_axis("ω [rad/s]"), log_axis("gain"));
    let panel: Panel = lines("From φ to the cost, H3", axes, series, vec![bound]);
    Figure {
        id: "l2-gain".to_owned(),
        title: "Gain from φ to the cost of (11), over frequency".to_owned(),
        caption: "The paper has no such figure. The curve stays below γ² at every frequency shown."
            .to_owned(),
        panels: vec![panel],
    }
}

/// Pulses of φ, which end.
fn signals() -> Vec<(&'static str, PhiCourse)> {
    let steps = 20_000;
    let time = |k: usize| k as f64 * STEP;
    let joined =
        |f: &dyn Fn(f64) -> f64| PhiCourse::Joined((0..steps).map(|k| f(time(k))).collect());
    let window = |t: f64| if t < 2.0 { (TAU * t / 4.0).sin().powi(2) } else { 0.0 };
    let mut draw = Draw::new(11);
    let noise: Vec<f64> = (0..steps).map(|_| draw.between(-1.0, 1.0)).collect();
    vec![
        ("a push of 0.1 s", joined(&|t| f64::from(u8::from(t < 0.1)))),
        ("a push of 1 s", joined(&|t| f64::from(u8::from(t < 1.0)))),
        ("a burst at 69.6 rad/s", joined(&|t| window(t) * (69.6 * t).sin())),
        ("a burst at 20 rad/s", joined(&|t| window(t) * (20.0 * t).sin())),
        (
            "2 s of noise",
            PhiCourse::Joined((0..steps).map(|k| window(time(k)) * noise[k]).collect()),
        ),
    ]
}

/// `∫(xᵀQx + φ̂ᵀRφ̂)/∫φ²` of one run from rest.
fn gain_on(law: &UnitLaw, c: &Certified, phi: &PhiCourse) -> f64 {
    let (mut cost, mut energy) = (0.0, 0.0);
    for now in run(law, PaperForm::Ladder, &[], phi, (STEP, 20_000)) {
        let state: f64 = c.q.iter().zip(&now.x).map(|(q, x)| q * x * x).sum();
        cost += state + now.phi_hat * now.phi_hat / law.a_top();
        energy += now.phi * now.phi;
    }
    cost / energy
}

/// The gain at one frequency: `x_i = (jω)^{i−1} d/(D A_o)`, `φ̂ = −a_{m−1} g d/A_o`.
fn gain_at(law: &UnitLaw, c: &Certified, omega: f64) -> f64 {
    let w = omega * omega;
    let size = |p: &[f64]| polynomial::value(&polynomial::magnitude_squared(p), w);
    let state = polynomial::value(&c.q, w) / (size(&law.d()) * size(&law.a_o()));
    state + law.a_top() * size(&law.g()) / size(&law.a_o())
}

/// Gravity has infinite energy, and does no harm.
fn not_in_l2() -> Statement {
    let phi = 22.2;
    let energy = |t: f64| phi * phi * t;
    let (mut most, mut last) = (Vec::new(), 0.0_f64);
    for (name, law) in laws() {
        let rows =
            run(&law, PaperForm::Estimator, &[], &PhiCourse::polynomial(&[phi]), (1e-3, 10_000));
        most.push((name, largest(rows.iter().map(|x| x.e))));
        last = last.max(rows.last().map_or(f64::NAN, |x| x.e.abs()));
    }
    let bounded = most.iter().all(|(_, e)| *e < 0.1) && last < 1e-9;
    let listed = most.iter().map(|(name, e)| format!("{name}: {}", three((*e).into())));
    Published {
        id: "erratum-l2",
        place: "Sec. III, Sec. III-B",
        claim: "Stability for φ ∈ L₂[0, ∞) is stability of an arm",
        paper: "stable for φ ∈ L₂[0, ∞)",
    }
    .found(
        format!(
            "a constant φ = {phi} has ∫φ² = {} and {} after 1 and 100 s; |e| peaks at [rad] {}, and is at most \
                {last:.0e} after 10 s",
            three(energy(1.0).into()),
            three(energy(100.0).into()),
            listed.collect::<Vec<_>>().join("; "),
        ),
        // The statement needs ∫φ² to stay finite for what acts on an arm.
        Verdict::of(energy(100.0) < 1.01 * energy(1.0), bounded),
        "As a sentence about φ ∈ L₂ it is right. But gravity, friction and anything periodic are not in L₂[0, ∞), so \
         that (11) says nothing about them. Input-to-state stability does: bounded φ gives bounded x.",
        most.iter().map(|(name, e)| number(&format!("largest |e|, {name}"), "rad", *e, 1e-4)).collect(),
    )
    .assuming(&["gains", "phi-max"])
}
