//! Fig. 4: the path and the start.

use phihat::Form;
use phihat_model::Workspace;

use super::claims::verdict;
use super::run::Run;
use super::runs::{Runs, form_name};
use super::studies::GainSetting;
use crate::compose::{axis, figure, lines, marks, number, section, statement, way};
use crate::item::{Item, Kind};
use crate::part::PartError;
use crate::record::{Section, Verdict};
use phihat_report::kit::figure::{Figure, Panel};

/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-3;

/// Fig. 4.
pub(crate) fn path(runs: &Runs) -> Result<Section, PartError> {
    let run = runs.get(GainSetting::First, Form::Observer)?;
    let tips = run.tips(1)?;
    let (Some([start, begin]), Some([_, end])) = (tips.first(), tips.last()) else {
        return Err(PartError::Missing("the run has no sample"));
    };
    let apart = (start[0] - begin[0]).hypot(start[1] - begin[1]);
    let along = radial_rate(run)?;
    let reach = tips.iter().map(|[_, wanted]| wanted[0].hypot(wanted[1])).fold(0.0, f64::max);
    let closes = (end[0] - begin[0]).hypot(end[1] - begin[1]);
    let text = "The arm starts stretched out along x, the path elsewhere: the transient of Figs. 5 and 6 \
                is the way there.";
    let mut section = section("figure-4", "Fig. 4: path and start", &[text]);
    let printed = (start[0] - 0.88).abs() < 5e-3 && start[1].abs() < 5e-3;
    section.statements.push(statement(
        ["fig4-start", "Fig. 4, Sec. VII-A", "The tip starts on the x-axis, 0.88 m from the base.", "(0.88, 0) m"],
        verdict(printed, false),
        (
            format!("({:.3}, {:.3}) m", start[0], start[1]),
            format!(
                "The links are 0.305 + 0.208 + 0.370 = 0.883 m long: this is the stretched arm, a singular \
                 pose. No joint moves the tip along the arm there (at most {along:.3} m/rad). A law in \
                 joint space does not mind; one in task space has no answer."
            ),
        ),
        vec![
            number("start x", "m", start[0], AGAIN),
            number("largest ∂x/∂q at the start", "m/rad", along, 1.0),
        ],
    )
    .read_as("The stretched arm of the printed link lengths, to 5 mm.")
    .turning("None: it follows from the printed lengths.")
    .covering(&[Item { kind: Kind::Figure, number: 4 }]));
    section.statements.push(statement(
        [
            "fig4-path",
            "Fig. 4",
            "The desired path, chosen by hand, lies inside the workspace and is closed after one rotation.",
            "a drawing; 6.17 s",
        ],
        Verdict::Open,
        (
            format!("{reach:.2} m from the base at most, closed after 6.17 s to {:.1} mm", closes * 1e3),
            "The path is drawn, and no point of it printed. Ours is another one; nothing below compares a \
             figure with the paper's where the path decides it."
                .to_owned(),
        ),
        vec![number("initial distance", "m", apart, AGAIN), number("farthest point", "m", reach, AGAIN)],
    )
    .read_as("The drawing gives no coordinates that could be held against the workspace.")
    .varying("The path: 1.2 times as large, and begun at other distances from the start (Figs. 9 to 11).")
    .turning("With the path's points printed it could be told.")
    .covering(&[Item { kind: Kind::Figure, number: 4 }]));
    section.figures.push(path_figure(runs)?);
    Ok(section)
}

/// Largest `|∂x/∂q|` of the tip at the start \[m/rad\].
fn radial_rate(run: &Run) -> Result<f64, PartError> {
    let model = &run.study.robot.model;
    let frame =
        model.frame(&run.study.robot.tip).ok_or(PartError::Missing("the robot has no tip"))?;
    let start: Vec<f64> =
        run.joints().iter().filter_map(|joint| joint.q.first().copied()).collect();
    let mut jacobian = vec![0.0; 6 * start.len()];
    model.jacobian(&mut Workspace::new(model), &start, frame, &mut jacobian);
    Ok(jacobian.iter().take(start.len()).fold(0.0, |most: f64, entry| most.max(entry.abs())))
}

fn path_figure(runs: &Runs) -> Result<Figure, PartError> {
    let panel = |setting: GainSetting, form: Form| -> Result<_, PartError> {
        let tips = runs.get(setting, form)?.tips(1)?;
        let series = vec![
            way("desired", tips.iter().map(|[_, wanted]| *wanted)),
            way("tip", tips.iter().map(|[tip, _]| *tip)),
            marks("start", tips.iter().take(1).map(|[tip, _]| *tip).collect()),
        ];
        let title = format!("{}, {} form", setting.label(), form_name(form));
        let panel = lines(&title, (axis("x [m]"), axis("y [m]")), series, Vec::new());
        Ok(Panel { equal: true, ..panel })
    };
    let panels = [
        panel(GainSetting::First, Form::Literal)?,
        panel(GainSetting::H1, Form::Literal)?,
        panel(GainSetting::First, Form::Observer)?,
        panel(GainSetting::H1, Form::Observer)?,
    ];
    let caption = "The paper's law as printed (top) and in observer form (bottom), without torque limits. \
                   The printed form goes past the path because its integrals must come back to zero; the \
                   observer form does not.";
    Ok(figure("fig-05", "Figs. 4 and 5: the path in the plane of the arm", caption, panels.into()))
}
