//! The proposed law against PD and against the robust controller.

use super::arm::{ArmScores, RUNS};
use super::bench::Score;
use super::printed::PRINTED;
use super::ratios::{ends, on_arms, over_proposed, printed_ratios, ratios, span, written};
use super::robots::Table3Robot;
use crate::compose::{number, three};
use crate::item::{Item, Kind};
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// The least share of friction that a robot leaves, among those tried, at which the claim on PD has to hold.
const SOME_FRICTION: f64 = 0.05;

const COVERS: [Item; 3] = [
    Item { kind: Kind::Table, number: 3 },
    Item { kind: Kind::Figure, number: 14 },
    Item { kind: Kind::Equation, number: 51 },
];

pub(super) fn beats_pd(arms: &[ArmScores]) -> Statement {
    let (bare, least) = on_arms(arms, |arm| ratios(&arm.stated, 0, 2));
    let plain: fn(&Table3Robot) -> &Score = |robot| &robot.plain;
    let outer: fn(&Table3Robot) -> &Score = |robot| &robot.outer;
    let mut holds = least > 1.0;
    let (mut some, mut listed, mut numbers) = (holds, Vec::new(), Vec::new());
    for arm in arms {
        numbers.extend(ends(arm, "PD : proposed", &ratios(&arm.stated, 0, 2), 0.05));
        for robot in &arm.robots {
            let times = robot.times(outer);
            let both = times.iter().chain(&robot.times(plain)).all(|times| *times > 1.0);
            holds &= both || robot.left.friction < SOME_FRICTION;
            some |= both;
            let [least, largest] = span(&times);
            if robot.left.friction <= SOME_FRICTION {
                let (arm, left) = (arm.name(), robot.left.words());
                listed.push(format!("{arm}, {left}: {}", written([least, largest])));
            }
            let name = format!(
                "least rms of PD as (3) over the proposed law's, {}, {}",
                arm.name(),
                robot.left.words()
            );
            numbers.push(number(&name, "", least, 0.05));
        }
    }
    let turns = arms.iter().map(|arm| match arm.as_good {
        Some((share, joint)) => format!(
            "{}: (3) is as good on joint {joint} where it is left {} % of the friction or less",
            arm.name(),
            three((100.0 * share).into())
        ),
        None => format!("{}: worse on every joint with no friction left, too", arm.name()),
    });
    let turns: Vec<String> = turns.collect();
    for arm in arms {
        let name =
            format!("share of friction left at which (3) is as good on a joint, {}", arm.name());
        numbers.push(number(&name, "", arm.as_good.map(|(share, _)| share), 0.2));
    }
    Published {
        id: "table3-pd",
        place: "Table 3, Fig. 14",
        claim: "The proposed law's error is smaller than that of PD with the same K_p, K_d, on every joint",
        paper: &format!("PD : proposed = {}, if (51)", written(span(&printed_ratios(0, 2)))),
    }
    .found(
        format!("(51), PD : proposed, nothing compensated: {bare}; rms, (3) : proposed: {}", listed.join("; ")),
        Verdict::assumed(holds, some),
        "PD has no integral action: what is left of gravity and friction gives e ≈ φ/(M̄K_p). A robot that leaves none \
            of it has no use for an estimate, which then only adds what encoders and drives put into φ.",
        numbers,
    )
    .read_as("PD as −K_p e − K_d ė and as the outer loop (3), and a robot that leaves some of its friction, 5 % or \
        more.")
    .varying("Panda and iiwa; all of gravity and friction left to the law, or no gravity and 100, 20, 5, 0 % of the \
        friction.")
    .turning(format!("Gravity compensated; {}.", turns.join("; ")))
    .covering(&COVERS)
}

pub(super) fn beats_comparator(arms: &[ArmScores]) -> Statement {
    let (ours, least) = on_arms(arms, |arm| ratios(&arm.stated, 1, 2));
    let (weak, _) = on_arms(arms, |arm| over_proposed(arm, &arm.weak));
    let paper = written(span(&printed_ratios(1, 2)));
    let joint_2 = PRINTED[1][1] / PRINTED[1][0];
    let better = |of: &dyn Fn(&ArmScores) -> Vec<f64>| -> usize {
        arms.iter().flat_map(of).filter(|ratio| *ratio > 1.0).count()
    };
    let at_defaults = better(&|arm| ratios(&arm.stated, 1, 2));
    let at_weak = better(&|arm| over_proposed(arm, &arm.weak));
    let turns = arms.iter().map(|arm| format!("{} {}", arm.name(), three(arm.weak_enough)));
    let turns: Vec<String> = turns.collect();
    let total = arms.iter().map(|arm| arm.weak.square.len()).sum::<usize>();
    let numbers = arms.iter().flat_map(|arm| {
        let weak = ends(arm, "weak comparator : proposed", &over_proposed(arm, &arm.weak), 0.05);
        ends(arm, "comparator : proposed", &ratios(&arm.stated, 1, 2), 0.05).into_iter().chain(weak)
    });
    Published {
        id: "table3-comparator",
        place: "Table 3, Fig. 14",
        claim: "The proposed law's (51) is much smaller than that of the robust controller, tuned by trial and error",
        paper: &format!("comparator : proposed = {paper}"),
    }
    .found(
        format!("comparator at its default gains: {ours}; at a quarter of its gain: {weak}"),
        Verdict::assumed(least > 1.0, false),
        format!(
            "The comparator's gains are not printed, and they decide: the proposed law is better on {at_defaults} of \
             {total} joints with the comparator at our defaults, on {at_weak} with it at a quarter of that gain. So it \
             is open. It says what two sets of gains do, not what the laws can: at m = 1 they are one structure up to \
             q̈_d (Remark 9). On joint 2 of the paper the comparator is {} times worse than plain PD, which gains of \
             that structure need not be.",
            three(joint_2.into())
        ),
        numbers
            .chain([
                number("joints on which the proposed law is better", "", at_defaults as f64, 0.0),
                number("the same, comparator at a quarter of its gain", "", at_weak as f64, 0.0),
            ])
            .chain(arms.iter().map(|arm| {
                let name = format!("share of its gain at which the comparator is worse on every joint, {}", arm.name());
                number(&name, "", arm.weak_enough, 0.1)
            }))
            .collect(),
    )
    .read_as("(51) on every joint of both arms.")
    .varying("Panda and iiwa; the comparator at our default gains and at a quarter of them.")
    .turning(format!("The comparator is worse on every joint up to this share of its default gain: \
        {}.", turns.join(", ")))
    .covering(&COVERS)
}

/// A comparison of ours: every law tuned alike.
pub(super) fn fair(arms: &[ArmScores]) -> Statement {
    let (ours, least) = on_arms(arms, |arm| ratios(&arm.fair, 1, 2));
    let wins =
        |arm: &ArmScores| ratios(&arm.fair, 1, 2).into_iter().filter(|ratio| *ratio > 1.0).count();
    let counts: Vec<(&ArmScores, usize)> = arms.iter().map(|arm| (arm, wins(arm))).collect();
    let (pd, _) = on_arms(arms, |arm| ratios(&arm.fair, 0, 2));
    let won = counts.iter().map(|(arm, wins)| format!("{} on {wins} of 7 joints", arm.name()));
    let won: Vec<String> = won.collect();
    let lost = |(arm, _): &(&ArmScores, usize)| {
        let all = ratios(&arm.fair, 1, 2);
        let lost = all.iter().zip(1..).filter(|(ratio, _)| **ratio <= 1.0);
        let lost: Vec<String> = lost.map(|(_, joint): (_, usize)| joint.to_string()).collect();
        let lost = if lost.is_empty() { "none".to_owned() } else { lost.join(", ") };
        format!("{}: {lost}", arm.name())
    };
    let lost: Vec<String> = counts.iter().map(lost).collect();
    let most = counts.iter().all(|(_, wins)| 2 * wins > 7);
    let numbers = counts.iter().flat_map(|(arm, wins)| {
        let name = format!("joints on which the proposed law is better, {}", arm.name());
        let [least, largest] =
            ends(arm, "H∞ PID : proposed, tuned alike", &ratios(&arm.fair, 1, 2), 0.05);
        [number(&name, "", *wins as f64, 0.0), least, largest]
    });
    Published {
        id: "table3-fair",
        place: "Table 3's laws, tuned alike",
        claim: "With every law tuned alike the proposed law is better than the robust controller on every joint",
        paper: "not stated; by trial and error: on every joint",
    }
    .found(
        format!("H∞ PID : proposed = {ours}; the proposed law is better: {}", won.join(", ")),
        Verdict::of(least > 1.0, most),
        format!(
            "The H∞ PID is better on these joints: {}. {RUNS} runs each, noise capped alike. PD : proposed = {pd}. \
             What is left between the two integral laws is the feed-forward q̈_d, the anti-windup, and how well {RUNS} \
             runs found their gains; another budget ends elsewhere.",
            lost.join("; ")
        ),
        numbers.collect(),
    )
    .read_as("(51) on every joint of both arms, every law with the gains that the same optimiser found.")
    .turning("At other gains: see the ratios.")
    .covering(&COVERS)
    .ours()
}
