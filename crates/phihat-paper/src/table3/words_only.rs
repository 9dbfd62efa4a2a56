//! Statements of Sec. VII-D without a figure: (40) on seven joints, and a higher order.

use phihat_campaign::statistics::mean;
use phihat_design::claims::{Iss, Optimality, PaperRadius};
use phihat_design::prelude::*;

use super::arm::ArmScores;
use super::bench::Score;
use crate::compose::{number, three};
use crate::gains::first;
use crate::item::{Item, Kind};
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
            "For φ_max the largest |φ/M̄| of the run, and K̃ = {K_TILDE}. (40) is at least {} times what is met: a \
             criterion as loose as that says next to nothing of the errors, and it is not a bound (Theorem 5). The \
             limits that the paper set for its seven joints, if any, are not printed.",
            three(slack.into())
        ),
        numbers,
    )
    .read_as("|x| of (40) with all joints together in the steady part, against the radius for the φ that was met.")
    .varying("Panda and iiwa.")
    .turning(format!("At |x| {} times as large, on the arm with the least slack.", three(slack.into())))
    .covering(&[Item { kind: Kind::Equation, number: 40 }]))
}

/// "The error reduction can be improved by a higher order".
pub(super) fn higher_order(arms: &[ArmScores]) -> Statement {
    let (mut numbers, mut listed, mut robots) = (Vec::new(), Vec::new(), Vec::new());
    let (mut better, mut all, mut everywhere) = (0, 0, true);
    let less = |[one, two]: [&Score; 2]| {
        one.square.iter().zip(&two.square).filter(|(one, two)| two < one).count()
    };
    let root = |score: &Score| mean(&score.square).sqrt();
    for arm in arms {
        let pair = [&arm.stated[2], &arm.second];
        let (on, joints, rms) = (less(pair), pair[0].square.len(), pair.map(root));
        better += on;
        all += joints;
        listed.push(format!(
            "{}: smaller on {on} of {joints} joints, rms {} and {} µrad",
            arm.name(),
            three((rms[0] * 1e6).into()),
            three((rms[1] * 1e6).into())
        ));
        let name = |what: &str| format!("{what}, {}", arm.name());
        numbers.push(number(&name("joints on which m = 2 leaves less"), "", on as f64, 0.0));
        for (m, rms) in (1..).zip(rms) {
            numbers.push(number(&name(&format!("rms of all joints, m = {m}")), "rad", rms, 0.05));
        }
        let each = arm.robots.iter().map(|robot| {
            let [one, two] = &robot.proposed;
            format!("{} of {joints} ({})", less([one, two]), robot.left.words())
        });
        everywhere &= arm.robots.iter().all(|r| less([&r.proposed[0], &r.proposed[1]]) == joints);
        robots.push(format!("{}: {}", arm.name(), each.collect::<Vec<_>>().join(", ")));
    }
    Published {
        id: "order-seven-joints",
        place: "Sec. VII-D",
        claim: "A higher order reduces the error further on seven joints",
        paper: "in words",
    }
    .found(
        format!("m = 1 and 2: {}", listed.join("; ")),
        Verdict::assumed(better == all && everywhere, better == all),
        "Correction: where the robot leaves gravity to the law. Of what changes slowly, gravity and friction along the \
            motion, the second order leaves less; of what encoders and drives put into φ it does not.",
        numbers,
    )
    .read_as(
        "Root of (51) on every joint of both arms, observer form on its reference; both orders with every estimator \
            pole at 69.6 rad/s.",
    )
    .varying(format!("What the robot leaves to the law; smaller on so many joints: {}.", robots.join("; ")))
    .turning("Where the robot compensates gravity: of what is left, dry friction and noise, the second order leaves no \
        less on every joint.")
}
