//! The same arm, motion, world and noise under a PID, beside phihat's law.

use std::path::Path;

use phihat_compare::{Adapter, NOMINAL_MASSES, supply};
use phihat_rivals::{INDUSTRIAL_PID, Scalar, Tuning};
use phihat_session::{Session, SessionError};
use phihat_sim::{JointMetrics, JointTrace, Measured, Simulation, SimulationOutcome};
use phihat_study::Study;
use serde_json::{Value, json};

use crate::drawn::{largest, stride};
use crate::error::AnswerError;
use crate::task::StudyTexts;

/// Errors of a PID with its published scalars, in units of the gains' nominal inertia, which knows the arm's links as
/// 20 % too light: as in `phihat compare`, but for the search of its scalars.
pub(crate) fn run(texts: &StudyTexts, event: &dyn Fn(Value)) -> Result<Value, AnswerError> {
    let (study, outcome) = simulated(texts, event)?;
    let mut measured = Measured::new(&study);
    measured.block(&outcome.trace);
    let metrics = measured.metrics();
    let each = stride(outcome.trace.len());
    let joint = |(own, figures): (&JointTrace, &JointMetrics)| {
        let (measured, e) = (figures.error_steady_max_rad, largest(&own.e, each));
        json!({ "name": own.name, "measured_rad": measured, "e": e })
    };
    let joints: Vec<Value> = outcome.trace.joints.iter().zip(&metrics.joints).map(joint).collect();
    let scalar = |own: &Scalar| json!({ "name": own.name, "unit": own.unit, "value": own.default });
    let scalars: Vec<Value> = INDUSTRIAL_PID.scalars.iter().map(scalar).collect();
    let diverged = outcome.divergence.is_some() || outcome.abort.is_some();
    let card = INDUSTRIAL_PID.card;
    Ok(json!({
        "title": card.title, "law": card.law, "scalars": scalars, "diverged": diverged, "joints": joints,
    }))
}

#[inline(never)]
fn simulated(
    texts: &StudyTexts,
    event: &dyn Fn(Value),
) -> Result<(Box<Study>, Box<SimulationOutcome>), AnswerError> {
    let (study, units) = completed(texts)?;
    let period_s = study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::published(INDUSTRIAL_PID.scalars, &units, period_s);
    let tuning = tuning.map_err(SessionError::other)?;
    let knows = supply(&study, &units, NOMINAL_MASSES).map_err(SessionError::other)?;
    let law = INDUSTRIAL_PID.build(&tuning, &knows).map_err(SessionError::other)?;
    let driver = Adapter::new(law, units.len());
    let simulation = Simulation::driven(&study, driver, &units).map_err(SessionError::other)?;
    let simulation = Box::new(simulation);
    let of = simulation.samples();
    let outcome = simulation.run(|samples| event(json!({ "samples": samples, "of": of })));
    Ok((study, Box::new(outcome)))
}

/// The study as phihat's law runs it, and the nominal inertia of its gains \[kg·m²\].
#[inline(never)]
fn completed(texts: &StudyTexts) -> Result<(Box<Study>, Vec<f64>), AnswerError> {
    let gains = texts.gains()?.ok_or(AnswerError::NoGains)?;
    let given = Some((gains, Path::new("gains.json")));
    let (study, gains) = Session::new(texts.read()?, &texts.path(), given, false)?.into_parts();
    Ok((study, gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect()))
}
