//! Theorem 5: the bound (40) as printed, as it can be proven, a bound that is sharp, and the worst case measured.

use phihat_design::claims::matrix::{apply, dot};
use phihat_design::claims::{
    Certified, Iss, Law, Optimality, PaperRadius, PeakGains, Refutation, WorstCase,
};

use super::super::compose::{number, three, words};
use super::super::draw::Draw;
use super::super::gains::{K_TILDE_H3, PHI_MAX, first, second_h3};
use super::super::joint::{Form, Phi, flow, largest, length, run};
use super::super::record::{Section, Statement, Table, Verdict};
use super::super::said::Said;
use super::rows::componentwise;

/// One law with everything that bounds its state, per unit of φ.
struct Bounds {
    name: &'static str,
    law: Law,
    certified: Certified,
    radius: PaperRadius,
    iss: Iss,
    peaks: PeakGains,
    /// Largest |e|, |ė|, |x| met on the worst φ of each state.
    measured: [f64; 3],
}

impl Bounds {
    fn of(name: &'static str, law: Law, k_tilde: f64) -> Result<Self, String> {
        let text = |e: Refutation| e.to_string();
        let claim = Optimality::at(&law, k_tilde).map_err(text)?;
        let certified = claim.certified().ok_or(format!("{name} has no certificate"))?.clone();
        let iss = Iss::of(&law, &certified).map_err(text)?;
        let radius = PaperRadius::of(&iss);
        let peaks = PeakGains::of(&law, 1.0).map_err(text)?;
        let measured = worst_met(&law).map_err(text)?;
        Ok(Self { name, law, certified, radius, iss, peaks, measured })
    }

    /// `√Σ‖G_{x_i}‖₁²`: a bound of |x|.
    fn peak(&self) -> f64 {
        length(&self.peaks.states.iter().map(|gain| gain.upper).collect::<Vec<_>>())
    }

    fn error(&self) -> f64 {
        self.peaks.error(0).map_or(f64::NAN, |gain| gain.upper)
    }

    fn velocity(&self) -> f64 {
        self.peaks.velocity_error(0).map_or(f64::NAN, |gain| gain.upper)
    }
}

/// Runs from rest on the φ that is worst for each state.
fn worst_met(law: &Law) -> Result<[f64; 3], Refutation> {
    let mut met = [0.0_f64; 3];
    for index in 0..law.order() + 2 {
        let worst = WorstCase::of(law, 1.0, index)?;
        // Only the last two seconds count: everything before has been forgotten.
        let from = (worst.peak_s - 2.0).max(0.0);
        let dt = 1e-4;
        let steps = steps((worst.peak_s - from) / dt);
        let phi = (0..=steps).map(|k| worst.phi(from + k as f64 * dt)).collect();
        let rows = run(law, Form::Ladder, &[], &Phi::Joined(phi), (dt, steps));
        let new = [
            largest(rows.iter().map(|x| x.e)),
            largest(rows.iter().map(|x| x.de)),
            largest(rows.iter().map(|x| length(&x.x))),
        ];
        for (most, new) in met.iter_mut().zip(new) {
            *most = most.max(new);
        }
    }
    Ok(met)
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "two seconds over a tenth of a millisecond"
)]
fn steps(count: f64) -> usize {
    count.round().clamp(1.0, 1e6) as usize
}

/// Theorem 5 and (44).
pub(super) fn theorem_5(draws: usize) -> Result<Section, String> {
    let all = [
        Bounds::of("m = 1, Table 2 (C), a_0 = 69.6", first(), 68.9)?,
        Bounds::of("m = 2, H3", second_h3(), K_TILDE_H3)?,
    ];
    let statements = vec![
        vacuous(&all[0]),
        outside(&all[0], draws),
        not_invariant(&all[0]),
        sharp(&all),
        componentwise()?,
    ];
    Ok(Section {
        id: "theorem-5".to_owned(),
        title: "Theorem 5: how large the errors get".to_owned(),
        text: words(&[
            "|x| of (40) adds rad·s, rad and rad/s. φ comes from outside here, at M̄ = 1 and bounded by \
                       φ_max; the worst φ switches between ±φ_max and is computed, not guessed.",
        ]),
        statements,
        tables: vec![table(&all)],
        figures: Vec::new(),
    })
}

fn table(all: &[Bounds]) -> Table {
    let row = |b: &Bounds| {
        let cells = [
            b.radius.printed,
            b.radius.corrected,
            b.peak(),
            b.measured[2],
            b.error(),
            b.measured[0],
            b.velocity(),
            b.measured[1],
        ];
        [b.name.to_owned()].into_iter().chain(cells.map(|v| three((PHI_MAX * v).into()))).collect()
    };
    Table {
        id: "theorem-5-bounds".to_owned(),
        title: format!("Bounds and the worst case met, φ_max = {PHI_MAX}"),
        columns: words(&[
            "law",
            "|x| by (40)",
            "|x|, corrected",
            "|x| by L1 gains",
            "|x| met",
            "|e| by L1 gain [rad]",
            "|e| met [rad]",
            "|ė| by L1 gain [rad/s]",
            "|ė| met [rad/s]",
        ]),
        rows: all.iter().map(row).collect(),
    }
}

/// (40) at the printed gains.
fn vacuous(b: &Bounds) -> Statement {
    let [printed, corrected, met] =
        [b.radius.printed, b.radius.corrected, b.measured[2]].map(|v| PHI_MAX * v);
    Said {
        id: "theorem5-radius",
        place: "Theorem 5, (40); Table 2 (C), m = 1",
        claim: "|x| in steady state is at most (40)",
        paper: "|x| ≤ 2|SB|φ_max/λ_min",
    }
    .found(
        format!(
            "(40): {}; proven, with √cond(S): {}; worst case met: {}",
            three(printed.into()),
            three(corrected.into()),
            three(met.into())
        ),
        // As printed it would need a ball that is a level set of V.
        Verdict::of(corrected <= printed, met <= corrected),
        format!(
            "V̇ < 0 outside the ball of (40); what is then kept is the smallest level set of V around it, √cond(S) = {} \
             times as large. No run of ours left the ball of (40), which is {} times what the worst φ can \
             do: as a performance criterion both are vacuous at these gains.",
            three(b.iss.overshoot.into()),
            three((printed / met).into())
        ),
        vec![
            number("(40)", "", printed, 1e-4),
            number("corrected", "", corrected, 1e-4),
            number("largest |x| met", "", met, 1e-3),
        ],
    )
    .assuming(&["gains", "phi-max"])
}

/// "V̇ < 0 iff |x| ≤ (40)".
fn outside(b: &Bounds, draws: usize) -> Statement {
    let (a, mut draw) = (b.law.closed_loop(), Draw(6));
    let n = a.len();
    let (mut inside_up, mut outside_up, mut outside_seen) = (0_usize, 0_usize, 0_usize);
    for k in 0..draws {
        let x = draw.spread(n, 5.0);
        let reach = 10.0_f64.powf(draw.between(-6.0, 2.0)) * b.radius.printed / length(&x);
        let x: Vec<f64> = x.iter().map(|v| v * reach).collect();
        let mut rate = apply(&a, &x);
        rate[n - 1] -= if k % 2 == 0 { 1.0 } else { -1.0 };
        let grows = dot(&apply(&b.certified.s, &x), &rate) >= 0.0;
        let beyond = length(&x) > b.radius.printed;
        outside_seen += usize::from(beyond);
        outside_up += usize::from(beyond && grows);
        inside_up += usize::from(!beyond && grows);
    }
    Said {
        id: "erratum-40-sign",
        place: "End of the proof of Theorem 5",
        claim: "V̇ < 0 if and only if |x| is at most (40)",
        paper: "V̇ < 0 iff |x| ≤ …",
    }
    .found(
        format!("V̇ ≥ 0 at {inside_up} states inside the ball, at {outside_up} of {outside_seen} outside"),
        Verdict::of(inside_up == 0 && outside_up > 0, inside_up > 0 && outside_up == 0),
        "The other way around: V̇ < 0 if |x| is larger than (40). Inside, V may grow. And it is not \"only if\".",
        vec![number("states outside at which V̇ ≥ 0", "", outside_up as f64, 0.0)],
    )
    .assuming(&["gains"])
}

/// A state in the ball leaves it.
fn not_invariant(b: &Bounds) -> Statement {
    let (a, n) = (b.law.closed_loop(), b.law.order() + 2);
    let mut most: f64 = 0.0;
    for index in 0..n {
        let start: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == index))).collect();
        for k in 0..400 {
            most = most.max(length(&apply(&flow(&a, f64::from(k) * 1e-3), &start)));
        }
    }
    Said {
        id: "erratum-40-cond",
        place: "(40)",
        claim: "What starts inside the ball of (40) stays there",
        paper: "maximum error in steady state",
    }
    .found(
        format!(
            "at φ = 0, |x| grows to {} times its start; √cond(S) = {}",
            three(most.into()),
            three(b.iss.overshoot.into())
        ),
        Verdict::of(most <= 1.0 + 1e-9, most <= b.iss.overshoot),
        "The ball is no level set of V. The factor √cond(S) covers what can happen.",
        vec![
            number("largest |x(t)|/|x(0)|", "", most, 1e-3),
            number("√cond(S)", "", b.iss.overshoot, 1e-4),
        ],
    )
    .assuming(&["gains"])
}

/// L1 gains against the worst φ, and against the errors that the paper allows.
fn sharp(all: &[Bounds]) -> Statement {
    let shares = all.iter().flat_map(|b| [b.measured[0] / b.error(), b.measured[1] / b.velocity()]);
    let shares: Vec<f64> = shares.collect();
    let (low, high) =
        shares.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
    let [e, de] = [all[0].error(), all[0].velocity()].map(|gain| gain * PHI_MAX);
    let [e2, de2] = [all[1].error(), all[1].velocity()].map(|gain| gain * PHI_MAX);
    let within = e <= 1e-2 && de <= 1e-1 && e2 <= 1e-2 && de2 <= 1e-1;
    let met = high <= 1.0 + 1e-6;
    Said {
        id: "theorem5-sharp",
        place: "Theorem 5, (48), (49)",
        claim: "With the gains of Table 2 (C) the errors stay below 0.01 rad and 0.1 rad/s for |φ| ≤ φ_max",
        paper: "|e| ≤ 0.01 rad, |ė| ≤ 0.1 rad/s",
    }
    .found(
        format!(
            "worst φ, m = 1: {} rad, {} rad/s; m = 2 (H3): {} rad, {} rad/s",
            three(e.into()),
            three(de.into()),
            three(e2.into()),
            three(de2.into())
        ),
        Verdict::of(within && met, false),
        format!(
            "Peak-to-peak (L1) gains bound e and ė, and the worst φ attains {:.1} to {:.1} % of them: they are \
             sharp. A φ that jumps between ±{PHI_MAX} breaks the limits; φ of an arm is smoother, and then the \
             gain from φ̇ applies: |e| ≤ {} |φ̇|_∞ at m = 1.",
            100.0 * low,
            100.0 * high,
            three(all[0].peaks.error(1).map(|gain| gain.upper))
        ),
        vec![
            number("worst |e|, m = 1", "rad", e, 1e-4),
            number("worst |ė|, m = 1", "rad/s", de, 1e-4),
            number("worst |e|, m = 2", "rad", e2, 1e-4),
            number("worst |ė|, m = 2", "rad/s", de2, 1e-4),
        ],
    )
    .assuming(&["gains", "phi-max"])
}
