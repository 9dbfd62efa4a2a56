//! What Sec. VII-D says without a figure: (40) on seven joints, and a higher order.

use phihat_design::claims::{Iss, Optimality, PaperRadius};
use phihat_design::prelude::*;

use super::arm::ArmScores;
use crate::compose::{number, three};
use crate::gains::first;
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// `K̃` of Table 2 (C).
const K_TILDE: f64 = 68.9;

/// "The performance criterion (40) is satisfied for seven joints".
pub(super) fn radius(arms: &[ArmScores]) -> Result<Statement, PartError> {
    let law = first();
    let claim = Optimality::at(&law, K_TILDE)?;
    let certified = claim.certified().ok_or(PartError::NoCertificate("m = 1"))?;
    let per_phi = PaperRadius::of(&Iss::of(&law, certified)?).printed;
    let (mut numbers, mut listed, mut slack) = (Vec::new(), Vec::new(), f64::INFINITY);
    for arm in arms {
        let score = &arm.stated[2];
        let radius = per_phi * score.phi;
        slack = slack.min(radius / score.state);
        listed.push(format!(
            "{}: |x| ≤ {}, (40) = {}",
            arm.bench.arm,
            three(score.state.into()),
            three(radius.into())
        ));
        let name = |what: &str| format!("{what}, {}", arm.bench.arm);
        numbers.push(number(&name("largest |x| of the steady part"), "", score.state, 0.05));
        numbers.push(number(&name("largest |φ/M̄|"), "rad/s²", score.phi, 0.05));
        numbers.push(number(&name("(40)"), "", radius, 0.05));
    }
    Ok(Published {
        id: "eq40-seven-joints",
        place: "Sec. VII-D",
        claim: "The performance criterion (40) is satisfied for a robot of seven joints",
        paper: "in words",
    }
    .found(
        format!("m = 1, all joints together: {}", listed.join("; ")),
        Verdict::assumed(slack >= 1.0, false),
        format!(
            "For φ_max the largest |φ/M̄| of the run, and K̃ = {K_TILDE}. (40) is at least {} times what is met: a criterion as loose as \
             that says next to nothing of the errors, and it is not a bound (Theorem 5). The limits that the paper set for its \
             seven joints, if any, are not printed.",
            three(slack.into())
        ),
        numbers,
    ))
}

/// "A higher order reduces the error; the transient will be worse".
pub(super) fn higher_order(arms: &[ArmScores]) -> Statement {
    let (mut numbers, mut listed) = (Vec::new(), Vec::new());
    let (mut better, mut worse, mut joints) = (0, true, 0);
    for arm in arms {
        let (one, two) = (&arm.stated[2], &arm.second);
        let less = one.square.iter().zip(&two.square).filter(|(one, two)| two < one).count();
        better += less;
        joints += one.square.len();
        worse &= two.transient > one.transient;
        let mean =
            |square: &[f64]| (square.iter().sum::<f64>() / square.len().max(1) as f64).sqrt();
        let rms = [mean(&one.square), mean(&two.square)];
        listed.push(format!(
            "{}: (51) smaller on {less} of {} joints, rms {} and {} µrad; largest |e| before 4 s {} and {} mrad",
            arm.bench.arm,
            one.square.len(),
            three((rms[0] * 1e6).into()),
            three((rms[1] * 1e6).into()),
            three((one.transient * 1e3).into()),
            three((two.transient * 1e3).into())
        ));
        let name = |what: &str| format!("{what}, {}", arm.bench.arm);
        numbers.push(number(&name("joints on which m = 2 leaves less"), "", less as f64, 0.0));
        for (m, rms, score) in [(1, rms[0], one), (2, rms[1], two)] {
            numbers.push(number(&name(&format!("rms of all joints, m = {m}")), "rad", rms, 0.05));
            let what = name(&format!("largest |e| before 4 s, m = {m}"));
            numbers.push(number(&what, "rad", score.transient, 0.05));
        }
    }
    let all = better == joints;
    let transient = if worse {
        "The largest error of the transient is larger with m = 2."
    } else {
        "The transient is not worse by its largest error; what grows with the order is how far it swings back \
         after a jump of φ (Remark 4, above)."
    };
    Published {
        id: "order-seven-joints",
        place: "Sec. VII-D",
        claim: "A higher order reduces the error further, and makes the transient worse",
        paper: "in words",
    }
    .found(
        format!("m = 1 and 2: {}", listed.join("; ")),
        Verdict::assumed(all && worse, all || worse),
        format!(
            "{} {transient} Observer form, started on the reference with φ̂ = 0 under gravity; both orders with every estimator pole \
             at 69.6 rad/s.",
            if all {
                "The second order leaves less on every joint."
            } else {
                "The second order does not leave less on every joint: what encoders and friction put into φ is not slow."
            }
        ),
        numbers,
    )
}
