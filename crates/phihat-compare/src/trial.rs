//! One rival, one choice of gains, one study: a run.

use std::convert::Infallible;
use std::sync::Arc;

use phihat_model::Lanes;
use phihat_rivals::{Entry, Knows, Orbit, RivalRefusal, Running, Supply, Tuning};
use phihat_sim::{Batch, SimError, Simulation, SimulationOutcome, Trace};
use phihat_study::Study;
use thiserror::Error;

use crate::adapter::{Adapter, Broken};
use crate::arm_case::ArmCase;

/// Why a run cannot begin.
#[derive(Debug, Error)]
pub(crate) enum TrialError {
    #[error("{0}")]
    Refused(#[from] RivalRefusal),
    #[error("{0}")]
    Sim(#[from] SimError),
    #[error("the nominal model cannot be made: {0}")]
    Model(#[from] phihat_model::ModelError),
}

/// Outcome of a run, with the time \[s\] and the joint at which the rival's torque was first not finite, if
/// it was.
#[derive(Debug)]
pub(crate) struct ComparisonTrial {
    pub(crate) outcome: SimulationOutcome,
    pub(crate) broken: Option<(f64, usize)>,
}

/// Runs a rival.
///
/// # Errors
///
/// [`TrialError`]: the rival does not apply to this arm or task, or the study cannot be simulated.
pub(crate) fn run(
    arm: &ArmCase,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Result<ComparisonTrial, TrialError> {
    let (rival, supply) = built(arm, entry, values, study)?;
    run_with(entry, rival, &supply, (study, &arm.units))
}

/// A rival for a study, with what it is handed.
///
/// # Errors
///
/// [`TrialError`]: the rival does not apply to this arm or task.
pub(crate) fn built(
    arm: &ArmCase,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Result<(Box<dyn Running>, Supply), TrialError> {
    let period = study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &arm.units, period)?;
    let supply = arm.supply(entry, study)?;
    Ok((entry.build(&tuning, &supply)?, supply))
}

/// Runs a law that is built; what it was handed, the study, and the units of its arm.
///
/// # Errors
///
/// [`TrialError`]: the study cannot be simulated.
fn run_with(
    entry: &Entry,
    rival: Box<dyn Running>,
    supply: &Supply,
    (study, units): (&Study, &[f64]),
) -> Result<ComparisonTrial, TrialError> {
    let PreparedTrial { simulation, broken } = PreparedTrial::new(entry, rival, (study, units))?;
    ComparisonTrial { outcome: simulation.run(|_| ()), broken: broken.get().copied() }
        .judged(entry, supply)
}

/// A law in its closed loop, ready to run.
#[derive(Debug)]
struct PreparedTrial {
    simulation: Simulation,
    broken: Broken,
}

impl PreparedTrial {
    fn new(
        entry: &Entry,
        rival: Box<dyn Running>,
        (study, units): (&Study, &[f64]),
    ) -> Result<Self, TrialError> {
        let broken = Broken::default();
        let mut driver = Adapter::watched(rival, units.len(), Arc::clone(&broken));
        if entry.needs.preview {
            driver = driver.with_preview(study)?;
        }
        Ok(Self { simulation: Simulation::driven(study, driver, units)?, broken })
    }
}

impl ComparisonTrial {
    /// The same with the error that the rival is judged by.
    fn judged(mut self, entry: &Entry, supply: &Supply) -> Result<Self, TrialError> {
        if untimed(entry) {
            transversal(&mut self.outcome.trace, supply)?;
        }
        Ok(self)
    }
}

/// Runs that share lanes: as many as keep them full most of the time, and few enough for their records to be
/// in memory together.
const TOGETHER: usize = 2 * Lanes::COUNT;

/// Runs one rival in many studies, several at a time in lanes, each with the bits that it has alone; passes
/// the result of each run to `show`, with the place of its study. `made` builds the law for a study, by its
/// place, with its inputs.
pub(crate) fn run_many<'a>(
    entry: &Entry,
    units: &[f64],
    studies: impl Iterator<Item = &'a Study>,
    mut made: impl FnMut(usize, &Study) -> Result<(Box<dyn Running>, Supply), TrialError>,
    mut show: impl FnMut(usize, &Study, Result<ComparisonTrial, TrialError>),
) {
    let mut begin = |place: usize, study: &Study| {
        let (rival, supply) = made(place, study)?;
        Ok((PreparedTrial::new(entry, rival, (study, units))?, supply))
    };
    // Those that can share lanes, side by side.
    let mut studies: Vec<(usize, &Study)> = studies.enumerate().collect();
    studies.sort_by_key(|(_, study)| study.world.substeps);
    for studies in studies.chunks(TOGETHER) {
        let prepared = studies.iter().map(|(place, study)| begin(*place, study));
        let (mut simulations, mut kept) = (Vec::new(), Vec::new());
        for prepared in prepared {
            kept.push(prepared.map(|(PreparedTrial { simulation, broken }, supply)| {
                simulations.push(simulation);
                (broken, supply)
            }));
        }
        let mut traces = vec![Trace::default(); simulations.len()];
        let mut take = |arm: usize, trace: &mut Trace| -> Result<(), Infallible> {
            traces[arm] = core::mem::take(trace);
            Ok(())
        };
        let Ok(ended) = Batch::new(simulations).stream(usize::MAX, &mut take);
        let mut left = traces.into_iter().zip(ended);
        for (kept, (place, study)) in kept.into_iter().zip(studies) {
            let trial = kept.and_then(|(broken, supply)| {
                let (trace, ended) = left.next().unwrap_or_default();
                let outcome = SimulationOutcome::of(trace, ended);
                ComparisonTrial { outcome, broken: broken.get().copied() }.judged(entry, &supply)
            });
            show(*place, study, trial);
        }
    }
}

/// Returns true if a rival follows a path without a time table: it is then judged by its distance to the
/// path.
pub(crate) fn untimed(entry: &Entry) -> bool {
    entry.needs.orbit && entry.needs.derivatives == 0
}

/// Puts the deviation from the nearest place on the path in the place of the error.
fn transversal(trace: &mut Trace, supply: &Supply) -> Result<(), RivalRefusal> {
    let mut orbit = Orbit::of(supply)?;
    let mut theta: Option<f64> = None;
    let mut q = vec![0.0; trace.joints.len()];
    for k in 0..trace.len() {
        for (q, joint) in q.iter_mut().zip(&trace.joints) {
            *q = joint.q[k];
        }
        let from = theta.unwrap_or_else(|| orbit.search(&q));
        theta = Some(orbit.project(&q, from));
        for (joint, place) in trace.joints.iter_mut().zip(orbit.place()[0]) {
            joint.e[k] = joint.q[k] - place;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

    use super::super::adapter::supply;
    use super::{Study, Trace, Tuning, run_many, run_with, transversal};
    use crate::adapter::NOMINAL_MASSES;
    use crate::arm_case::ArmCase;
    use crate::protocol::{Harder, Split, draw};
    use phihat_rivals::rival;

    /// Worlds of several structures, some with raised drive gains, more than are run together: the result of
    /// each run is that of the run alone.
    #[test]
    fn in_lanes_every_run_is_the_one_alone() {
        let text = include_str!("../../../studies/table1.toml");
        let arm = ArmCase::from_text(text, "table1.toml").unwrap();
        let mut studies = Vec::new();
        for drawn in draw(5, Split::Train, 6) {
            for harder in [Harder::NOT, Harder::TRIALS[0], Harder::TRIALS[1]] {
                studies.push(arm.in_drawn(&drawn, harder, (0.2, 0.1)).unwrap());
            }
        }
        for (id, values) in [("pd-gravity", &[15.0, 1.0][..]), ("computed-torque", &[15.0, 1.0])] {
            let entry = rival(id).unwrap();
            let made = |study: &Study| {
                let tuning = Tuning::new(values, &arm.units, 1e-3).unwrap();
                let supply = supply(study, &arm.units, NOMINAL_MASSES).unwrap();
                (entry.build(&tuning, &supply).unwrap(), supply)
            };
            let mut left = vec![None; studies.len()];
            let show = |place: usize, _: &Study, trial: Result<super::ComparisonTrial, _>| {
                left[place] = Some(trial.unwrap().outcome);
            };
            run_many(entry, &arm.units, studies.iter(), |_, study| Ok(made(study)), show);
            for (study, left) in studies.iter().zip(left) {
                let (law, supply) = made(study);
                let alone = run_with(entry, law, &supply, (study, &arm.units)).unwrap();
                assert!(left == Some(alone.outcome), "{id}: {}", study.title);
            }
        }
    }

    /// Late by a fifth of a second, and beside the path by a little: the first does not count, the second does.
    #[test]
    fn distance_to_the_path_does_not_count_being_late() {
        let text = "duration_s = 12.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
            estimator_bandwidth_rad_s = 60.0\ninertia_kg_m2 = 0.4\n[reference]\nkind = \"sines\"\n\
            center = \"ready\"\nfade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.3\n\
            frequency_hz = [0.2, 0.4, 0.2]\nphase_rad = [0.0, 1.0, 2.0]\n";
        let study = Study::from_text(text, "late.toml", std::path::Path::new(".")).unwrap();
        let supply = supply(&study, &[0.4; 3], NOMINAL_MASSES).unwrap();
        let motion = phihat_sim::Motion::new(&study.reference, &study.robot, 12.0).unwrap();
        let names = study.robot.joint_names();
        let mut trace = Trace::new(&names, 1_000_000, 12_000);
        for k in 0..5000_u32 {
            let t = 3.0 + 1e-3 * f64::from(k);
            let q: Vec<_> = (0..3).map(|i| motion.at(i, t - 0.2)[0]).collect();
            trace.t_ns.push(u64::from(k) * 1_000_000);
            for (i, joint) in trace.joints.iter_mut().enumerate() {
                joint.q.push(q[i] + if i == 1 { 1e-3 } else { 0.0 });
                joint.e.push(q[i] - motion.at(i, t)[0]);
            }
        }
        let size = |trace: &Trace| {
            trace.joints.iter().flat_map(|joint| &joint.e).fold(0.0_f64, |m, e| m.max(e.abs()))
        };
        assert!(size(&trace) > 0.05);
        transversal(&mut trace, &supply).unwrap();
        let off = size(&trace);
        assert!(off > 0.3e-3 && off <= 1e-3 + 1e-9, "{off}");
    }
}
