//! Table 3 with ours beside it, the gains found, and Fig. 14.

use super::arm::ArmScores;
use super::bench::{LAWS, Score};
use super::printed::PRINTED;
use crate::compose::{axis, curve, figure, lines, table, three, words};
use crate::record::Table;
use phihat_report::kit::figure::{Figure, Panel};

pub(super) fn errors_table(arm: &ArmScores) -> Table {
    let cell = |v: f64| three(Some(v * 1e4));
    let rows = (0..7).map(|joint| {
        let printed = PRINTED[joint].map(|v| three(v.into()));
        let of = |scores: &[Score]| -> Vec<String> {
            scores.iter().map(|s| cell(s.square.get(joint).copied().unwrap_or(f64::NAN))).collect()
        };
        let cells = printed.into_iter().chain(of(&arm.stated)).chain(of(&arm.fair));
        [format!("{}", joint + 1)].into_iter().chain(cells).collect()
    });
    let columns = [
        "joint",
        "paper: PD",
        "Chung",
        "proposed",
        "same K_p, K_d: PD",
        "H∞ PID, default gains",
        "proposed",
        "tuned alike: PD",
        "H∞ PID",
        "proposed",
    ];
    let title = format!("(51) in 1e-4 rad²: the paper's arm as printed, and {}", arm.bench.arm);
    table(&format!("table-3-{}", arm.bench.arm), &title, &columns, rows.collect())
}

/// Root mean squares on every robot, beside the paper's figures as they are printed.
pub(super) fn robots_table(arm: &ArmScores) -> Table {
    let cells = |values: Vec<f64>| values.into_iter().map(|v| three(Some(v * 1e3)));
    let row = |robot: &str, law: &str, values: Vec<f64>| -> Vec<String> {
        [robot.to_owned(), law.to_owned()].into_iter().chain(cells(values)).collect()
    };
    let printed = |law: usize| PRINTED.iter().map(|row| row[law] * 1e-4).collect();
    let mut rows =
        vec![row("the paper's", "PD", printed(0)), row("the paper's", "proposed", printed(2))];
    for robot in &arm.robots {
        let left = robot.left.words();
        rows.push(row(&left, "−K_p e − K_d ė", robot.plain.rms()));
        rows.push(row(&left, "(3), with q̈_d", robot.outer.rms()));
        rows.push(row(&left, "proposed, m = 1", robot.proposed[0].rms()));
        rows.push(row(&left, "proposed, m = 2", robot.proposed[1].rms()));
        rows.push(row(&left, "H∞ PID, default gains", robot.comparator.rms()));
    }
    let joints: Vec<String> = (1..=7).map(|joint| format!("joint {joint} [mrad]")).collect();
    let columns: Vec<&str> =
        ["left to the law", "law"].into_iter().chain(joints.iter().map(String::as_str)).collect();
    let title = format!(
        "Errors of Table 3 read as root mean squares, and those on {} as it compensates more of itself",
        arm.bench.arm
    );
    table(&format!("table-3-robots-{}", arm.bench.arm), &title, &columns, rows)
}

pub(super) fn gains_table(arm: &ArmScores) -> Table {
    let rows = LAWS.iter().zip(&arm.values).enumerate().map(|(law, ((id, name), values))| {
        let scalars = phihat_rivals::rival(id).map_or(&[][..], |entry| entry.scalars);
        let pairs =
            scalars.iter().zip(values).map(|(s, v)| format!("{} {}", s.name, three((*v).into())));
        let noise = |score: &Score| format!("{:.2} %", 100.0 * score.noise);
        words(&[
            (*name).to_owned(),
            pairs.collect::<Vec<_>>().join(", "),
            noise(&arm.stated[law]),
            noise(&arm.fair[law]),
        ])
    });
    let title = format!(
        "Tuned gains on {}, and torque noise: mean step per sample over the torque limit",
        arm.bench.arm
    );
    let columns = ["law", "tuned gains", "noise, stated gains", "noise, tuned"];
    table(&format!("table-3-gains-{}", arm.bench.arm), &title, &columns, rows.collect())
}

/// Errors over time, joint by joint: of all laws, and of those with integral action by themselves, which the first
/// leaves one line.
pub(super) fn fig_14(arm: &ArmScores) -> [Figure; 2] {
    let name = arm.bench.arm;
    let all = figure(
        &format!("fig-14-{name}"),
        &format!("Fig. 14 on {name}: errors of the three laws"),
        "PD and the proposed law (observer form) with the same K_p and K_d, the H∞ PID at this project's default \
         gains. PD keeps an error under load; the two laws with integral action do not. The paper's arm, references \
         and gains are not published.",
        errors(arm, 0),
    );
    let close = figure(
        &format!("fig-14-{name}-close"),
        &format!("Fig. 14 on {name}: the two laws with integral action"),
        "The same runs without PD, beside which they are one line.",
        errors(arm, 1),
    );
    [all, close]
}

/// A panel per joint with the laws from `first` on.
fn errors(arm: &ArmScores, first: usize) -> Vec<Panel> {
    let panels = (0..7).map(|joint| {
        let series = LAWS.iter().zip(&arm.stated).skip(first).map(|((_, name), score)| {
            let errors = score.errors.get(joint).map_or(&[][..], |e| e);
            let points = errors.iter().enumerate().map(|(k, e)| [k as f64 * score.period, 1e3 * e]);
            curve(name, points)
        });
        lines(
            &format!("joint {}", joint + 1),
            (axis("t [s]"), axis("e [mrad]")),
            series.collect(),
            Vec::new(),
        )
    });
    panels.collect()
}
