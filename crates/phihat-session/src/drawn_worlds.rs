//! A few runs of a study in worlds drawn from its scope, held against the tube of its gains.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::Dice;
use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_certificate::{JointRun, Left, Refutation, Tube};
use phihat_design::Gains;
use phihat_report::kit::unit_of;
use phihat_sim::{SimError, Simulation, Trace};
use phihat_study::{Payload, PayloadSet, Study};
use serde::Serialize;

use crate::error::SessionError;

/// Number of drawn worlds.
pub const WORLDS: usize = 8;

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

/// Runs a study in drawn worlds; `progress` receives the number of finished runs.
///
/// # Errors
///
/// [`SessionError`]: it cannot be run. Inside: the refutation of a run that left the tube.
pub(crate) fn runs(
    study: &Study,
    gains: &Gains,
    tube: &Tube,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Result<DrawnRuns, Refutation>, SessionError> {
    let mut study = study.clone();
    gains.complete(&mut study).map_err(SessionError::other)?;
    let law = gains
        .joint_gains(&study.robot.joint_names(), study.control.period_ns, study.control.form)
        .map_err(SessionError::other)?;
    let mut draw = Draw(Dice::at(0x9e37_79b9_7f4a_7c15 ^ study.seed));
    let worlds: Vec<Study> = (0..WORLDS).map(|_| draw.world(&study)).collect();
    let one = |world: &Study| -> Result<(Option<Left>, Vec<f64>), SimError> {
        let trace = run(world.clone(), &law)?;
        Ok(held(tube, &trace))
    };
    let done = AtomicUsize::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let work = |part: &[Study]| -> Vec<_> {
        let counted = |world| {
            let run = one(world);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            run
        };
        part.iter().map(counted).collect()
    };
    let all: Vec<_> = std::thread::scope(|scope| {
        let parts = worlds.chunks(WORLDS.div_ceil(threads));
        let threads: Vec<_> = parts.map(|part| scope.spawn(|| work(part))).collect();
        let joined = threads
            .into_iter()
            .flat_map(|thread| thread.join().unwrap_or_else(|why| std::panic::resume_unwind(why)));
        joined.collect()
    });
    let mut used = vec![0.0; tube.joints.len()];
    for (at, run) in all.into_iter().enumerate() {
        let (left, shares) = run.map_err(SessionError::other)?;
        if let Some(left) = left {
            return Ok(Err(refuted(at, &worlds[at], &left)));
        }
        used.iter_mut().zip(shares).for_each(|(most, share)| *most = larger(*most, share));
    }
    Ok(Ok(DrawnRuns { runs: WORLDS, used }))
}

fn refuted(at: usize, world: &Study, left: &Left) -> Refutation {
    let (symbol, unit, scale) = left.quantity.words();
    let unit = unit_of(unit, world.robot.sliding().contains(&left.joint));
    let mass = world.world.payload.as_ref().map_or(0.0, |payload| payload.mass);
    let (own, bound) = (left.value / scale, left.bound / scale);
    Refutation {
        claim: format!("{}: tube", left.joint),
        inequality: format!(
            "{symbol} = {own:.4} {unit} at t = {:.3} s stays inside {bound:.4} {unit} in drawn world {} of {WORLDS} ({mass:.3} kg)",
            left.t_s,
            at + 1
        ),
        left: left.value,
        right: left.bound,
    }
}

/// Runs a world, finer where its friction needs it.
fn run(mut world: Study, law: &[phihat::JointGains<f64>]) -> Result<Trace, SimError> {
    let simulation = match Simulation::new(&world, law) {
        Err(SimError::TooStiff { needed, .. }) => {
            world.world.substeps = needed;
            Simulation::new(&world, law)?
        }
        other => other?,
    };
    Ok(simulation.run(|_| ()).trace)
}

/// Point at which a run left the tube, if any, and the largest share of a side that it used, per joint.
fn held(tube: &Tube, trace: &Trace) -> (Option<Left>, Vec<f64>) {
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
struct Draw(Dice);

impl Draw {
    /// Half of the draws are ends.
    fn end_or_between(&mut self, ends: (f64, f64)) -> f64 {
        match self.0.share() {
            x if x < 0.25 => ends.0,
            x if x < 0.5 => ends.1,
            _ => self.0.between(ends.0, ends.1),
        }
    }

    /// A world of the study's scope; it starts as the study says.
    fn world(&mut self, study: &Study) -> Study {
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
