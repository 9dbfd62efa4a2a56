//! The part that simulates: Figs. 4 to 8 and (50).

use super::assumptions;
use super::claims::SIMULATED_AS;
use super::runs::Runs;
use super::studies::{GainSetting, Studies, StudyKind, path_of};
use super::{fourth, mismatch, path, steady, surrogates, transient};
use crate::compose::rests_on;
use crate::part::{Extent, PaperPart, PartError};

/// Runs of one kind.
const RUNS: f64 = 10.0;

/// Figs. 4 to 8 and (50), on the surrogate arm and on others.
///
/// # Errors
///
/// A study that cannot be read or simulated.
pub fn simulation(
    studies: &Studies,
    extent: Extent,
    progress: &dyn Fn(f64),
) -> Result<PaperPart, PartError> {
    let mut done = 0.0;
    let runs = Runs::of(
        studies,
        StudyKind::Simulation,
        |study| study,
        || {
            done += 0.1 / RUNS;
            progress(done);
        },
    )?;
    let mut sections = vec![
        path::path(&runs)?,
        transient::transient(&runs, studies)?,
        steady::simulated(&runs)?,
        mismatch::mismatch(&runs)?,
    ];
    if let Some(last) = sections.last_mut() {
        last.statements.push(fourth::hypothesis(&runs, studies)?);
    }
    let paths: Vec<String> =
        GainSetting::ALL.iter().map(|s| path_of(StudyKind::Simulation, *s)).collect();
    for section in &mut sections {
        rests_on(section, assumptions::SIMULATION, &paths);
    }
    let varied = surrogates::simulated(studies, extent, &|share| progress(0.1 + 0.9 * share))?;
    for statement in sections.iter_mut().flat_map(|section| &mut section.statements) {
        if let Some((_, claim)) = SIMULATED_AS.iter().find(|(id, _)| *id == statement.id) {
            *statement = varied.around(statement.clone(), *claim);
        }
    }
    let mut part = PaperPart { assumptions: assumptions::all(), sections };
    part.sections.push(varied.section(StudyKind::Simulation, &paths));
    varied.tell(&mut part.assumptions);
    Ok(part)
}
