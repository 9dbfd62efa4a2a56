//! Statements in words only that a computation can meet or miss: the recipe's steps, the results of the proofs.

use core::f64::consts::{FRAC_PI_2, TAU};

use phihat_design::claims::{Attenuation, UnitLaw, polynomial};
use phihat_design::prelude::*;

use crate::compose::{number, section, three};
use crate::draw::Draw;
use crate::gains::{OUTER, PHI_MAX, all, law, second_h3};
use crate::joint::{Instant, PaperForm, PhiCourse, largest, run};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Verdict};

/// One turn of Fig. 4 \[rad/s\].
const TURN: f64 = TAU / 6.17;

/// (48), (49): limits of e and ė \[rad, rad/s\].
const LIMITS: [f64; 2] = [1e-2, 1e-1];

/// The section.
pub(super) fn in_words() -> Result<Section, PartError> {
    let text = "Sentences without a figure, read so that a computation can meet or miss them.";
    let mut section = section("in-words", "Stated in words", &[text]);
    section.statements = vec![
        computed_torque(),
        drives(),
        super::only_state::only_state()?,
        super::step_one::step_one()?,
        step_two(),
        proves_theorem_1()?,
        pd_after(),
        orders_suffice(),
    ];
    Ok(section)
}

/// (2) and (3) in (1) give (4).
fn computed_torque() -> Statement {
    let (mut draw, mut worst) = (Draw::new(2), 0.0_f64);
    for _ in 0..200 {
        // One joint of a known arm: inertia, load and viscous friction.
        let (m, load, f) =
            (draw.between(0.1, 5.0), draw.between(-50.0, 50.0), draw.between(0.0, 5.0));
        let (e, de, dq, ddq_d) = (
            draw.between(-1.0, 1.0),
            draw.between(-1.0, 1.0),
            draw.between(-2.0, 2.0),
            draw.between(-9.0, 9.0),
        );
        let wanted = ddq_d - OUTER.1 * de - OUTER.0 * e;
        let ddq = (m * wanted + load + f * dq - load - f * dq) / m;
        worst = worst.max((ddq - ddq_d + OUTER.1 * de + OUTER.0 * e).abs() / (1.0 + wanted.abs()));
    }
    Published {
        id: "eq4-identity",
        place: "(2), (3), (4)",
        claim: "(2) and (3) in (1) give ë + K_dė + K_pe = 0",
        paper: "(4)",
    }
    .found(
        format!("the left side of (4) is {worst:.0e} of the largest term at 200 random motions"),
        Verdict::of(worst < 1e-9, false),
        "With τ_d = 0 and the arm's own M, N and F.",
        vec![number("largest relative difference", "", worst, 1e6)],
    )
}

/// Root mean square of white noise of a position, differenced at 1 kHz, that is left behind a drive of one pole.
fn noise_behind(hertz: f64) -> f64 {
    let pole = (-TAU * hertz * 1e-3).exp();
    // The filter (1 − p)/(1 − p/z) on 1 − 1/z: Σh² = 2(1 − p)²/(1 + p), against 2.
    (1.0 - pole) / (1.0 + pole).sqrt()
}

/// Remark 2.
fn drives() -> Statement {
    let hertz = [50.0, 200.0, 500.0];
    let left = hertz.map(noise_behind);
    let (mut low, mut high) = (1.0, 5000.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if noise_behind(middle) < 0.5 { low = middle } else { high = middle }
    }
    Published {
        id: "remark2-drives",
        place: "Remark 2",
        claim: "Drives and supplies act as low-pass filters and suppress the noise",
        paper: "suppress",
    }
    .found(
        format!(
            "drives of one pole at {} Hz leave {} of the rms of a differenced position's noise at 1 kHz",
            hertz.map(|v| three(Some(v))).join(", "),
            left.map(|v| three(Some(v))).join(", ")
        ),
        Verdict::assumed(left.iter().all(|left| *left < 0.5), false),
        "How much depends on the drive, which is not printed; \"suppress\" is taken as less than half.",
        hertz.iter().zip(left).map(|(h, v)| number(&format!("noise left behind {h} Hz"), "", v, 1e-9)).collect(),
    )
    .turning(format!("a drive of {} Hz, which leaves half", three(Some(low))))
}

/// Time after which |e| stays below 2 % of its start \[s\].
fn settles(rows: &[Instant], start: f64) -> f64 {
    rows.iter().rev().find(|row| row.e.abs() > 0.02 * start).map_or(0.0, |row| row.t)
}

/// "Find K_p and K_d using a performance criterion like rise-time, settling-time."
fn step_two() -> Statement {
    let span = (1e-4, 30_000);
    let none = PhiCourse::polynomial(&[0.0]);
    let by = |law: &UnitLaw, form: PaperForm| {
        let mut start = vec![0.0; law.order() + 2];
        let at = if form == PaperForm::Ladder { law.order() } else { 0 };
        start[at] = 0.1;
        settles(&run(law, form, &start, &none, span), 0.1)
    };
    // (4) alone, critically damped: |e| = (1 + 20t)e^{−20t}.
    let outer = |t: f64| (1.0 + 20.0 * t) * (-20.0 * t).exp();
    let alone =
        (0..30_000).map(|k| f64::from(k) * 1e-4).rev().find(|t| outer(*t) > 0.02).unwrap_or(0.0);
    let laws = all();
    let free: Vec<f64> = laws.iter().map(|(_, law)| by(law, PaperForm::Estimator)).collect();
    let printed: Vec<f64> = laws.iter().map(|(_, law)| by(law, PaperForm::Ladder)).collect();
    let near = |times: &[f64], share: f64| times.iter().all(|t| (t / alone - 1.0).abs() < share);
    let list = |times: &[f64]| times.iter().map(|t| three(Some(*t))).collect::<Vec<_>>().join(", ");
    let names: Vec<_> = laws.iter().map(|(name, _)| *name).collect();
    Published {
        id: "step2-transient",
        place: "Sec. VII, step 2",
        claim: "K_p and K_d set the rise and settling time",
        paper: "a criterion like rise-time, settling-time",
    }
    .found(
        format!(
            "2 % settling time from e = 0.1 rad: (4) {} s; printed form {} s; with φ̂(0) = 0: {} s ({})",
            three(Some(alone)),
            list(&printed),
            list(&free),
            names.join(", ")
        ),
        Verdict::of(near(&printed, 0.1), near(&free, 0.1)),
        "An estimate that starts at zero leaves (4) alone, and K_p, K_d are its criterion. (9) and (10) start at \
         −a_{m−1}(ė + K_de), which adds a transient of the estimator's own.",
        names
            .iter()
            .zip(&printed)
            .map(|(name, t)| number(&format!("settling time, printed form, {name}"), "s", *t, 1e-2))
            .chain([number("settling time of (4)", "s", alone, 1e-2)])
            .collect(),
    )
    .assuming(&["gains"])
}

/// "This also proofs Theorem 1."
fn proves_theorem_1() -> Result<Statement, PartError> {
    let (mut draw, mut stable, mut proven) = (Draw::new(1), 0_usize, 0_usize);
    for k in 0..200 {
        let law = draw.law(1 + k % 2);
        stable += usize::from(polynomial::is_hurwitz(&law.denominator(1.0)));
        proven += usize::from(Attenuation::of(&law)?.gamma_diagonal.is_some());
    }
    Ok(Published {
        id: "proves-theorem1",
        place: "End of the proof of Theorem 5",
        claim: "The proof of Theorem 5 proves Theorem 1 as well",
        paper: "this also proofs Theorem 1",
    }
    .found(
        format!("of 200 random laws of order 1 and 2, {stable} are stable, and to {proven} the proof applies (some K̃ \
            meets A1 to A3, B1, B2)"),
        Verdict::of(proven == stable, 0 < proven && proven < stable),
        "It proves that e and φ̃ stay bounded, and go to zero at φ = 0, for laws with A1 to A3. Theorem 1 states it \
         without these conditions; the poles of (4) and (8) prove that.",
        vec![
            number("stable laws", "", stable as f64, 0.0),
            number("laws to which the proof applies", "", proven as f64, 0.0),
        ],
    ))
}

/// "Once the mismatch is removed, a PD controller can perform well."
fn pd_after() -> Statement {
    let moving = PhiCourse::sines(&[(PHI_MAX, TURN, FRAC_PI_2)]);
    let span = (1e-3, 12_340);
    let start = |law: &UnitLaw| {
        let mut start = vec![0.0; law.order() + 2];
        start[2] = PHI_MAX;
        start
    };
    let worst = |law: &UnitLaw| {
        let rows = run(law, PaperForm::Estimator, &start(law), &moving, span);
        largest(rows.iter().skip(6170).map(|row| row.e))
    };
    // φ̂ held at what it was: an estimator that does not move.
    let (with, held) = (worst(&second_h3()), worst(&law(&[1e-12])));
    Published {
        id: "pd-after-convergence",
        place: "Sec. VIII",
        claim: "Once the mismatch is removed, a PD controller performs well",
        paper: "can perform well",
    }
    .found(
        format!(
            "φ = 22.2 N·m cos(one turn), converged at the start: |e| ≤ {} rad with φ̂ going on, {} rad with φ̂ held",
            three(Some(with)),
            three(Some(held))
        ),
        Verdict::of(with <= LIMITS[0], held <= LIMITS[0]),
        "The PD part of the law is all that is left of (7) once φ̃ is small, and keeps e small, as long as the \
         estimate goes on. PD and a φ̂ that is held do so only while φ stays what it was.",
        vec![
            number("largest |e|, estimate going on", "rad", with, 1e-3),
            number("largest |e|, estimate held", "rad", held, 1e-3),
        ],
    )
    .turning("|e| of 0.01 rad, the limit of (48)")
    .assuming(&["gains", "phi-max"])
}

/// `|p(jω)|`, the constant first.
fn size_at(p: &[f64], omega: f64) -> f64 {
    let (mut real, mut imaginary, mut power) = (0.0, 0.0, 1.0);
    for (k, c) in p.iter().enumerate() {
        match k % 4 {
            0 => real += c * power,
            1 => imaginary += c * power,
            2 => real -= c * power,
            _ => imaginary -= c * power,
        }
        power *= omega;
    }
    f64::hypot(real, imaginary)
}

/// Largest |e| that a sine of φ_max leaves, over its limit; or |ė|, whichever is more.
fn share_at(law: &UnitLaw, omega: f64) -> f64 {
    let m = i32::try_from(law.order()).unwrap_or(0);
    let e = PHI_MAX * omega.powi(m) / size_at(&law.denominator(1.0), omega);
    (e / LIMITS[0]).max(omega * e / LIMITS[1])
}

/// Remark 4, Sec. VII-C.
fn orders_suffice() -> Statement {
    let second: Vec<_> = all().into_iter().filter(|(_, law)| law.order() == 2).collect();
    let edge = |law: &UnitLaw| {
        let rates = (1..2000).map(|k| 0.05 * f64::from(k));
        rates.take_while(|rate| share_at(law, *rate) <= 1.0).last().unwrap_or(0.0) / TURN
    };
    let edges: Vec<_> = second.iter().map(|(name, law)| (*name, edge(law))).collect();
    let share = largest(second.iter().map(|(_, law)| share_at(law, TURN)));
    let listed: Vec<_> =
        edges.iter().map(|(name, e)| format!("{name}: {}", three(Some(*e)))).collect();
    let listed = listed.join("; ");
    Published {
        id: "orders-suffice",
        place: "Remark 4, Sec. VII-C",
        claim: "m = 2 with proper gains is sufficient for the desired performance",
        paper: "sufficient",
    }
    .found(
        format!(
            "a sine of 22.2 N·m at one turn in 6.17 s takes e and ė to {:.2} % of their limits at most; the limits are \
             kept up to this many times the path's speed: {listed}",
            100.0 * share
        ),
        Verdict::of(share <= 1.0, false),
        "In steady state, for a φ that moves with the path. Fig. 7 is the same on the arm (fig7-m2).",
        edges
            .iter()
            .map(|(name, edge)| number(&format!("times the path's speed, {name}"), "", *edge, 1e-2))
            .collect(),
    )
    .read_as("the limits of e and ė in (49) as the desired performance, φ a sine of φ_max at the path's speed")
    .varying("the hypotheses on the gains, the speed of φ")
    .turning(format!("a φ that moves faster than the path by {listed}"))
    .assuming(&["gains", "phi-max"])
}
