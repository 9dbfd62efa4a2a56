//! Fig. 8 and (50): what the estimate leaves, and whether the order shows in the torque.

use super::claims::{estimates_better, same_torque, torque_difference, verdict};
use super::run::Run;
use super::runs::{Runs, form_name};
use super::studies::GainSetting;
use crate::compose::{
    axis_over, curve, figure, lines, log_axis, number, section, statement, table, three,
};
use crate::item::{Item, Kind};
use crate::part::PartError;
use crate::record::{Section, Statement, Table, Verdict};
use phihat::Form;
use phihat_report::kit::figure::Figure;

/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-2;

/// Mismatch that counts as none, as a share of the largest φ.
const NONE: f64 = 1e-3;

/// Fig. 8 and (50).
pub(crate) fn mismatch(runs: &Runs) -> Result<Section, PartError> {
    let text = "φ̂ − φ is known exactly here: the simulator records φ = τ − M̄q̈ at every sample.";
    let mut section = section("figure-8", "Fig. 8 and (50): mismatch and torque", &[text]);
    section.statements.extend([order_helps(runs)?, vanishes(runs)?, torque(runs)?]);
    section.tables.push(mismatch_table(runs)?);
    section.figures.push(mismatch_figure(runs)?);
    Ok(section)
}

fn order_helps(runs: &Runs) -> Result<Statement, PartError> {
    let first = runs.get(GainSetting::First, Form::Literal)?;
    let rms =
        |setting: GainSetting| Ok::<_, PartError>(runs.get(setting, Form::Literal)?.mismatch()[1]);
    let better = |setting: GainSetting| {
        Ok::<_, PartError>(estimates_better(runs.get(setting, Form::Literal)?, first))
    };
    let same_rate = better(GainSetting::H2)? && better(GainSetting::H3)?;
    let half_rate = better(GainSetting::H1)? && better(GainSetting::H4)?;
    let values = GainSetting::ALL.into_iter().map(rms).collect::<Result<Vec<_>, PartError>>()?;
    let why = match (same_rate, half_rate) {
        (true, true) => {
            "H2 and H3 converge at the rate of m = 1, H1 and H4 at half of it: the order helps in all four. A \
             slow φ is close to a ramp over the estimator's memory."
        }
        (true, false) => {
            "At the same rate (H2, H3) the order helps; at half of it (H1, H4) the lower rate costs more than \
             the order gains."
        }
        (false, _) => {
            "At the same rate of convergence the order does not help for every hypothesis."
        }
    };
    let name = |(setting, value): (GainSetting, &f64)| {
        number(&format!("mismatch, rms, {}", setting.label()), "N·m", *value, AGAIN)
    };
    Ok(statement(
        [
            "fig8-order",
            "Fig. 8",
            "At the same rate of convergence the mismatch is smaller with m = 2.",
            "a drawing",
        ],
        verdict(same_rate, false),
        (
            format!(
                "m = 1: {} N·m rms; H1, H2, H3, H4: {}",
                three(Some(values[0])),
                values[1..].iter().map(|v| three(Some(*v))).collect::<Vec<_>>().join(", ")
            ),
            why.to_owned(),
        ),
        GainSetting::ALL.into_iter().zip(&values).map(name).collect(),
    )
    .read_as("Printed form: root mean square of φ̂ − φ over the steady part, of the worst joint; H2 and H3, which \
        converge at the rate of m = 1.")
    .covering(&[Item { kind: Kind::Figure, number: 8 }]))
}

fn vanishes(runs: &Runs) -> Result<Statement, PartError> {
    let share = |setting: GainSetting| -> Result<f64, PartError> {
        let run = runs.get(setting, Form::Literal)?;
        Ok(run.mismatch()[0] / run.phi_max())
    };
    let shares = GainSetting::ALL.into_iter().map(share).collect::<Result<Vec<_>, _>>()?;
    let (most, least) = (
        shares.iter().copied().fold(0.0, f64::max),
        shares.iter().copied().fold(f64::INFINITY, f64::min),
    );
    let gone = most < NONE;
    let why = "φ varies along the path, so a mismatch of the order of φ^{(m)} divided by the estimator's \
               coefficients stays, and what a sample of the loop is late by. (8) makes φ̂ converge only \
               where φ^{(m)} does; elsewhere the mismatch is bounded.";
    Ok(statement(
        ["fig8-zero", "Theorem 1, Sec. VII-A", "The mismatch approaches zero.", "in words"],
        if gone { Verdict::AsPrinted } else { Verdict::WithCorrection },
        (
            format!("{:.1} % to {:.1} % of the largest φ stays", least * 1e2, most * 1e2),
            why.to_owned(),
        ),
        vec![
            number("largest mismatch over largest φ, worst setting", "", most, AGAIN),
            number("the same, best setting", "", least, AGAIN),
        ],
    )
    .read_as(format!(
        "Printed form: none is less than {:.1} % of the largest φ, for every gain set.",
        100.0 * NONE
    ))
    .varying("The gains: m = 1 and all hypotheses of m = 2.")
    .turning("With a φ whose m-th derivative goes to zero (Theorem 1).")
    .again())
}

fn torque(runs: &Runs) -> Result<Statement, PartError> {
    let first = runs.get(GainSetting::First, Form::Literal)?;
    let mut shares = Vec::new();
    let mut same = true;
    for setting in GainSetting::SECOND {
        let run = runs.get(setting, Form::Literal)?;
        same &= same_torque(run, first);
        shares.push(torque_difference(run, first));
    }
    let worst = shares
        .iter()
        .copied()
        .collect::<Option<Vec<f64>>>()
        .map(|all| all.into_iter().fold(0.0, f64::max));
    let why = if same {
        "The torque is what the motion needs, and the motion is nearly the same; what differs is of the \
         size of the mismatch."
    } else {
        "The runs do not follow the path closely enough for their torques to be one curve."
    };
    Ok(statement(
        [
            "eq50-torque",
            "(50), Sec. VII-C",
            "Once φ̂ has found φ, the torque is the same for every order.",
            "equal",
        ],
        verdict(same, false),
        (
            format!(
                "they differ by {} of the largest torque of the steady part at most",
                three(worst)
            ),
            why.to_owned(),
        ),
        vec![number(
            "largest torque difference of m = 1 and 2, over the largest torque",
            "",
            worst,
            AGAIN,
        )],
    )
    .read_as("Printed form: one curve is a difference below 1 % of the largest torque of the steady part.")
    .covering(&[Item { kind: Kind::Equation, number: 50 }]))
}

fn mismatch_table(runs: &Runs) -> Result<Table, PartError> {
    let row = |(setting, form, run): (GainSetting, Form, &Run)| -> Result<Vec<String>, PartError> {
        let [most, rms] = run.mismatch();
        let apart = torque_difference(run, runs.get(GainSetting::First, form)?);
        Ok(vec![
            setting.label().to_owned(),
            form_name(form).to_owned(),
            three(Some(most)),
            three(Some(rms)),
            three(Some(run.phi_max())),
            if setting == GainSetting::First {
                String::new()
            } else {
                three(apart.map(|share| share * 1e2))
            },
        ])
    };
    let columns = [
        "gains",
        "form",
        "max |φ̂ − φ| [N·m]",
        "rms [N·m]",
        "max |φ| [N·m]",
        "torque against m = 1 [%]",
    ];
    Ok(table(
        "mismatch",
        "Mismatch and torque in the steady part",
        &columns,
        runs.iter().map(row).collect::<Result<_, _>>()?,
    ))
}

fn mismatch_figure(runs: &Runs) -> Result<Figure, PartError> {
    let gap = |setting: GainSetting| -> Result<_, PartError> {
        let run = runs.get(setting, Form::Literal)?;
        let size = |k: usize| {
            run.joints().iter().map(|j| (j.phi_hat[k] - j.phi[k]).powi(2)).sum::<f64>().sqrt()
        };
        // On a logarithmic axis nothing is zero.
        let points = run.times().enumerate().map(|(k, t)| [t, size(k).max(1e-6)]);
        Ok(curve(setting.label(), points))
    };
    let series = GainSetting::ALL.into_iter().map(gap).collect::<Result<_, _>>()?;
    let torque = |setting: GainSetting| -> Result<_, PartError> {
        let run = runs.get(setting, Form::Literal)?;
        let from = run.steady_from();
        Ok(curve(
            setting.label(),
            run.times().zip(&run.joints()[1].tau_applied).skip(from).map(|(t, tau)| [t, *tau]),
        ))
    };
    let torques = [GainSetting::First, GainSetting::H1, GainSetting::H3]
        .into_iter()
        .map(torque)
        .collect::<Result<_, _>>()?;
    let (end, begin) = (6.17, super::transient::SHOWN_S);
    let panels = vec![
        lines(
            "|φ̂ − φ| over all joints",
            (axis_over("t [s]", 0.0, end), log_axis("|φ̂ − φ| [N·m]")),
            series,
            Vec::new(),
        ),
        lines(
            "torque of joint 2 after the transient",
            (axis_over("t [s]", begin, end), crate::compose::axis("τ [N·m]")),
            torques,
            Vec::new(),
        ),
    ];
    let caption = "Left: the paper's Fig. 8 on a logarithmic axis, printed form. Right: (50), the torques \
                   lie on each other.";
    Ok(figure("fig-08", "Fig. 8: mismatch, and (50)", caption, panels))
}
