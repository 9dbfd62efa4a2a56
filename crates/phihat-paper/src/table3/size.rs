//! How large the errors of Table 3 are, and in what unit.

use super::arm::ArmScores;
use super::bench::mean_square;
use super::printed::PRINTED;
use super::ratios::{ends, on_arms, printed_ratios, ratios, span, written};
use crate::compose::{number, three};
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// How much better than PD, and what either leaves beside the paper's.
pub(super) fn size(arms: &[ArmScores]) -> Statement {
    let printed = span(&printed_ratios(0, 2));
    let all: Vec<f64> = arms.iter().flat_map(|arm| ratios(&arm.stated, 0, 2)).collect();
    let ours = span(&all);
    // The paper's over ours, joint by joint, as root mean squares or as they are.
    let against = |law: usize, arm: &ArmScores| -> Vec<f64> {
        let pairs = PRINTED.iter().zip(&arm.stated[law].square);
        pairs.map(|(row, square)| row[law] * 1e-4 / square).collect()
    };
    let rms =
        |arm: &ArmScores| -> Vec<f64> { against(2, arm).into_iter().map(f64::sqrt).collect() };
    let (proposed, _) = on_arms(arms, rms);
    let (pd, _) = on_arms(arms, |arm| against(0, arm));
    let mut numbers = vec![
        number("least PD : proposed", "", ours[0], 0.05),
        number("largest PD : proposed", "", ours[1], 0.05),
    ];
    for arm in arms {
        numbers.extend(ends(arm, "rms of proposed, the paper's over ours", &rms(arm), 0.05));
        numbers.extend(ends(arm, "(51) of PD, the paper's over ours", &against(0, arm), 0.05));
    }
    Published {
        id: "table3-size",
        place: "Table 3",
        claim: "By how much the proposed law is better than PD",
        paper: &format!("{} times, (51)", written(printed)),
    }
    .found(
        format!("{} times, (51)", written(ours)),
        Verdict::assumed(ours[0] <= printed[1] && printed[0] <= ours[1], false),
        format!(
            "Read as rad², the paper's proposed law leaves so many times the rms that it leaves here, joint by joint: {proposed}. Its \
             PD leaves so many times the (51) of ours: {pd}, now more, now less, as the arm's load has it. Which of what is not \
             printed makes the difference cannot be told: a transient inside T_1 … T_2, other gains, a torque limit, play in the \
             gears, or numbers that are not (51). That the law beats PD is reproduced; by how much is not."
        ),
        numbers,
    )
}

/// (51) is a mean square.
pub(super) fn unit(arms: &[ArmScores]) -> Statement {
    let errors = arms.first().and_then(|arm| arm.stated[2].errors.first()).map_or(&[][..], |e| e);
    let doubled: Vec<f64> = errors.iter().map(|e| 2.0 * e).collect();
    let factor = mean_square(&doubled) / mean_square(errors);
    let mean_squares = PRINTED.map(|row| (row[2] * 1e-4).sqrt() * 1e3);
    let as_rms = PRINTED.map(|row| row[2] * 1e-4 * 1e3);
    let (ours, _) = on_arms(arms, |arm| {
        arm.stated[2].square.iter().map(|square| square.sqrt() * 1e3).collect()
    });
    Published {
        id: "erratum-table3-unit",
        place: "Table 3, (51)",
        claim: "Table 3 lists (51), in rad",
        paper: "rad",
    }
    .found(
        format!("twice the error gives {} times (51): rad²", three(factor.into())),
        Verdict::of((factor - 2.0).abs() < 1e-9, (factor - 4.0).abs() < 1e-9),
        format!(
            "This shows the dimension of (51), a mean square and no integral; what the table holds it does not show. If it holds (51), its \
             unit is rad² and the proposed law leaves {} mrad rms; if it holds root mean squares in rad, it leaves {} mrad. Ours on \
             the two arms: {ours} mrad.",
            written(span(&mean_squares)),
            written(span(&as_rms))
        ),
        vec![number("factor", "", factor, 1e-9)],
    )
}
