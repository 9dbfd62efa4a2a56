//! Runs of a study in worlds drawn from its scope, compared with the tube of its gains.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::Dice;
use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_certificate::parallel::shared;
use phihat_certificate::{JointRun, Left, Refutation, Tube};
use phihat_design::Gains;
use phihat_report::kit::unit_of;
use phihat_sim::{Batch, SimError, Simulation, Trace};
use phihat_study::{Payload, PayloadSet, Study};
use serde::Serialize;

use crate::error::SessionError;

/// Number of drawn worlds; they run eight at a time in lanes.
pub const WORLDS: usize = 64;
const LANES: usize = 8;

/// Share of the second moments of a needle that is equal in all directions \[1\].
const NEEDLE: f64 = 0.02;

/// Runs that stayed inside.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnRuns {
    /// Number of runs.
    pub runs: usize,
    /// Largest share of a side of a bin that any of them used, of `e`, per joint.
    pub used: Vec<f64>,
}

/// Runs a study in worlds drawn from a seed; `progress` receives the number of finished runs.
///
/// # Errors
///
/// [`SessionError`]: it cannot be run. Inside: the refutation of a run that left the tube.
pub(crate) fn runs(
    study: &Study,
    (gains, tube): (&Gains, &Tube),
    seed: u64,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Result<DrawnRuns, Refutation>, SessionError> {
    let mut study = study.clone();
    gains.complete(&mut study).map_err(SessionError::other)?;
    let law = gains
        .joint_gains(&study.robot.joint_names(), study.control.period_ns, study.control.form)
        .map_err(SessionError::other)?;
    let mut draw = WorldDraw { dice: Dice::at(seed), corner: false };
    let worlds: Vec<Study> = (0..WORLDS).map(|at| draw.world(&study, at)).collect();
    let done = AtomicUsize::new(0);
    let parts: Vec<&[Study]> = worlds.chunks(LANES).collect();
    let chunks = shared(parts.len(), |chunk| {
        let runs = in_lanes(parts[chunk], &law, tube);
        let own = parts[chunk].len();
        progress(done.fetch_add(own, Ordering::Relaxed) + own);
        runs
    });
    let mut used = vec![0.0; tube.joints.len()];
    for (chunk, runs) in chunks.into_iter().enumerate() {
        for (k, (left, shares)) in runs.map_err(SessionError::other)?.into_iter().enumerate() {
            let at = chunk * LANES + k;
            if let Some(left) = left {
                return Ok(Err(refuted(at, &worlds[at], &left)));
            }
            used.iter_mut().zip(shares).for_each(|(most, share)| *most = larger(*most, share));
        }
    }
    Ok(Ok(DrawnRuns { runs: WORLDS, used }))
}

/// Point at which a run left the tube, if it did, and the largest share of a side that it used, per joint.
type RunInTube = (Option<Left>, Vec<f64>);

/// Runs some worlds in lanes, finer where their friction needs it.
fn in_lanes(
    worlds: &[Study],
    law: &[phihat::JointGains<f64>],
    tube: &Tube,
) -> Result<Vec<RunInTube>, SimError> {
    let simulations = worlds.iter().map(|world| prepared(world, law));
    let batch = Batch::new(simulations.collect::<Result<_, _>>()?);
    let mut results = vec![(None, Vec::new()); worlds.len()];
    let whole = |arm: usize, trace: &mut Trace| {
        if let Some(result) = results.get_mut(arm) {
            *result = kept(tube, trace);
        }
        Ok::<(), core::convert::Infallible>(())
    };
    let Ok(_) = batch.stream(usize::MAX, whole);
    Ok(results)
}

fn refuted(at: usize, world: &Study, left: &Left) -> Refutation {
    let (symbol, unit, scale) = left.quantity.words();
    let unit = unit_of(unit, world.robot.sliding().contains(&left.joint));
    let mass = world.world.payload.as_ref().map_or(0.0, |payload| payload.mass);
    let (own, bound) = (left.value / scale, left.bound / scale);
    Refutation {
        claim: format!("{}: tube", left.joint),
        inequality: format!(
            "{symbol} = {own:.4} {unit} at t = {:.3} s stays inside {bound:.4} {unit} in drawn world {} of {WORLDS} \
                ({mass:.3} kg)",
            left.t_s,
            at + 1
        ),
        left: left.value,
        right: left.bound,
    }
}

/// Simulation of a world, with smaller steps where its friction needs them.
fn prepared(world: &Study, law: &[phihat::JointGains<f64>]) -> Result<Simulation, SimError> {
    match Simulation::new(world, law) {
        Err(SimError::TooStiff { needed, .. }) => {
            let mut finer = world.clone();
            finer.world.substeps = needed;
            Simulation::new(&finer, law)
        }
        other => other,
    }
}

/// Compares a run with a tube.
fn kept(tube: &Tube, trace: &Trace) -> RunInTube {
    let limited = |joint: &phihat_sim::JointTrace| {
        let acted = joint.saturated.iter().zip(&joint.rate_limited);
        acted.filter(|(torque, rate)| **torque || **rate).count() as u64
    };
    let runs: Vec<JointRun<'_>> = trace
        .joints
        .iter()
        .map(|joint| JointRun {
            e: &joint.e,
            de: &joint.de,
            tau_command: &joint.tau_command,
            limited_samples: limited(joint),
        })
        .collect();
    let left = tube.kept_by(&trace.t_ns, &runs).and_then(|kept| kept.left);
    let used = tube.joints.iter().zip(&runs).map(|(joint, run)| {
        let share = |(t, e): (&u64, &f64)| {
            let bin = tube.bin_of(*t);
            let ends = (joint.error_low_rad.get(bin), joint.error_high_rad.get(bin));
            let (Some(low), Some(high)) = ends else { return 0.0 };
            (e - 0.5 * (low + high)).abs() / (0.5 * (high - low)).max(1e-300)
        };
        trace.t_ns.iter().zip(run.e).map(share).largest()
    });
    (left, used.collect())
}

/// Worlds of a study's scope, drawn from a seed.
struct WorldDraw {
    dice: Dice,
    /// True for a world in which everything is at one of its ends.
    corner: bool,
}

/// Number of worlds at corners of payload, its centre, and dry friction.
const CORNERS: usize = 16;

impl WorldDraw {
    /// Half of the draws are ends; at a corner all are.
    fn end_or_between(&mut self, ends: (f64, f64)) -> f64 {
        let share = self.dice.share();
        match if self.corner { 0.5 * share } else { share } {
            x if x < 0.25 => ends.0,
            x if x < 0.5 => ends.1,
            _ => self.dice.between(ends.0, ends.1),
        }
    }

    /// A world of the study's scope; it starts as the study says. The first are corners of payload and friction.
    fn world(&mut self, study: &Study, at: usize) -> Study {
        self.corner = at < CORNERS;
        let mut world = study.clone();
        let (low, high) = &study.design.coulomb;
        for (i, joint) in study.robot.joints.iter().enumerate() {
            let own = if study.world.robot_friction { joint.friction.coulomb } else { 0.0 };
            world.world.extra_coulomb[i] = self.end_or_between((low[i], high[i])) - own;
        }
        if study.design.payload.mass.1 > 0.0 {
            world.world.payload = self.payload(&study.design.payload);
        }
        world
    }

    fn payload(&mut self, set: &PayloadSet) -> Option<Payload> {
        let mass = self.end_or_between(set.mass);
        let com = set.com.map(|ends| self.end_or_between(ends));
        // A needle along a corner of the cube, whose second moments are as large as any; no body is that thin.
        let v = [(); 3].map(|()| self.end_or_between((-1.0, 1.0)));
        let round = |i: usize, j: usize| if i == j { NEEDLE } else { 0.0 };
        let second = |i: usize, j: usize| {
            mass * set.gyration.powi(2) * ((1.0 - NEEDLE) * v[i] * v[j] + round(i, j))
        };
        let trace: f64 = (0..3).map(|i| second(i, i)).sum();
        let inertia = [
            trace - second(0, 0),
            -second(0, 1),
            -second(0, 2),
            trace - second(1, 1),
            -second(1, 2),
            trace - second(2, 2),
        ];
        let frame = set.frame.clone();
        let (start, end) = (0.0, f64::INFINITY);
        (mass > 0.0).then_some(Payload { frame, mass, com, inertia, start, end })
    }
}
