//! The part that experiments: Figs. 9 to 11.

use phihat::Form;

use super::run::Run;
use super::runs::{Runs, form_name};
use super::start_map::StartMap;
use super::studies::{GainSetting, Studies, StudyKind, path_of};
use super::transient::SHOWN_S;
use super::variations::unlimited;
use super::{assumptions, errors, phi_hat, saturation, steady, surrogates, transient};
use crate::compose::{axis, curve, figure, lines, rests_on, section};
use crate::part::{Extent, PaperPart, PartError};
use phihat_report::kit::figure::{Figure, Panel};

/// Samples from one point of a drawn path to the next.
const STRIDE: usize = 8;

/// Figs. 9 to 11, on the surrogate arm and on others.
///
/// # Errors
///
/// A study that cannot be read or simulated.
pub fn experiment(
    studies: &Studies,
    extent: Extent,
    progress: &dyn Fn(f64),
) -> Result<PaperPart, PartError> {
    let limited_runs = Runs::of(studies, StudyKind::Experiment, |study| study, || ())?;
    progress(0.03);
    let free = Runs::of(studies, StudyKind::Experiment, unlimited, || ())?;
    let left = phi_hat::RemainingMismatch::of(studies)?;
    progress(0.06);
    let map = StartMap::of(studies, extent, &|share| progress(0.06 + 0.54 * share))?;
    let varied = surrogates::experimented(studies, extent, &|share| progress(0.6 + 0.4 * share))?;
    let text = "The paper names torque saturation as the difference to its simulations and prints no \
                limit. Ours is 50 N·m on every joint, with friction, encoders, drives and a delay; the \
                second turn counts as the steady part. How far from its path the arm starts is not printed either, and \
                the two together decide whether the printed form gets there: the map varies them together. What fails \
                here is left open, not refuted, where another start or limit makes it hold.";
    let mut section = section(
        "figures-9-to-11",
        "Figs. 9 to 11: the experiments on the three-joint arm",
        &[text],
    );
    let open = Some((&varied, &map));
    section.statements.extend([
        saturation::long_transient(&map, &[GainSetting::First]),
        saturation::long_transient(&map, &GainSetting::SECOND),
        saturation::in_phi(&free, &map)?,
        steady::kept(&limited_runs, steady::EXPERIMENTED, &[GainSetting::First], open)?,
        steady::kept(&limited_runs, steady::EXPERIMENTED, &GainSetting::SECOND, open)?,
        phi_hat::to_zero(&limited_runs, &left)?,
    ]);
    section.tables.push(steady::steady_table(&limited_runs, steady::EXPERIMENTED));
    section.tables.push(left.table());
    section.figures.extend([
        transient::joint_figure(
            "fig-09",
            "Fig. 9: joint 2 under a torque limit",
            &limited_runs,
            3.0,
        )?,
        tip_figure(&limited_runs)?,
        errors::errors_figure("fig-11", "Fig. 11: errors under a torque limit", &limited_runs)?,
        saturation::map_figure(&map),
    ]);
    section.figures.extend(saturation::near_figure(studies, &map)?);
    let paths: Vec<String> =
        GainSetting::ALL.iter().map(|s| path_of(StudyKind::Experiment, *s)).collect();
    rests_on(&mut section, assumptions::EXPERIMENT, &paths);
    let mut part = PaperPart { assumptions: assumptions::all(), sections: vec![section] };
    part.sections.push(varied.section(StudyKind::Experiment, &paths));
    varied.tell(&mut part.assumptions);
    for assumption in part.assumptions.iter_mut().filter(|a| ["path", "world"].contains(&&*a.id)) {
        let start = saturation::turning(&map, &GainSetting::ALL);
        assumption.influence = format!("{} {start}", assumption.influence);
    }
    Ok(part)
}

fn tip_figure(runs: &Runs) -> Result<Figure, PartError> {
    // What does not settle is drawn for as long as the paper shows its joint.
    let shown = |run: &Run| {
        let samples = run.outcome.trace.len();
        if run.settled_at().is_some() { samples } else { run.outcome.trace.index_at(SHOWN_S) }
    };
    let panel = |form: Form| -> Result<_, PartError> {
        let tips = |setting: GainSetting| -> Result<_, PartError> {
            let run = runs.get(setting, form)?;
            let tips = run.tips(STRIDE)?;
            Ok((tips, shown(run).div_ceil(STRIDE)))
        };
        let ((first, first_shown), (second, second_shown)) =
            (tips(GainSetting::First)?, tips(GainSetting::H3)?);
        let series = vec![
            curve("desired", first.iter().map(|[_, wanted]| *wanted)),
            curve("m = 1", first.iter().take(first_shown).map(|[tip, _]| *tip)),
            curve("m = 2, H3", second.iter().take(second_shown).map(|[tip, _]| *tip)),
        ];
        let title = format!("{} form", form_name(form));
        let panel = lines(&title, (axis("x [m]"), axis("y [m]")), series, Vec::new());
        Ok(Panel { equal: true, ..panel })
    };
    let caption = "The tip under the torque limit of 50 N·m that we assume, two turns; of a run that does \
                   not settle, the first 1.5 s.";
    Ok(figure(
        "fig-10",
        "Fig. 10: the path under a torque limit",
        caption,
        vec![panel(Form::Literal)?, panel(Form::Observer)?],
    ))
}
