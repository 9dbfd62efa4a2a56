//! Arms that move in lockstep, until each has come to its end.

use crate::simulation::{Divergence, Ended, Simulation};
use crate::trace::{Integral, Trace};
use crate::world::{PlantLanes, SimulatedWorld};

/// Simulations that share lanes.
#[derive(Debug)]
pub(super) struct LaneGroup {
    runs: Vec<GroupRun>,
    block: usize,
}

/// One of them, with the block of its record that is being filled.
#[derive(Debug)]
struct GroupRun {
    arm: usize,
    simulation: Simulation,
    trace: Trace,
    integrals: Vec<Integral>,
    divergence: Option<Divergence>,
}

impl LaneGroup {
    pub(super) fn new(simulations: Vec<(usize, Simulation)>, block: usize) -> Self {
        let run = |(arm, simulation): (usize, Simulation)| {
            let room = simulation.samples().min(u64::try_from(block).unwrap_or(u64::MAX));
            let (trace, integrals) = simulation.record_for(room);
            GroupRun { arm, simulation, trace, integrals, divergence: None }
        };
        Self { runs: simulations.into_iter().map(run).collect(), block }
    }

    /// Runs them all to their ends; the one that lasts longest may be left alone with the end of its way.
    pub(super) fn run<E>(
        mut self,
        each: &mut impl FnMut(usize, &mut Trace) -> Result<(), E>,
        ends: &mut Vec<(usize, Ended)>,
    ) -> Result<(), E> {
        let mut lanes = self.lanes();
        let mut k = 0;
        while !self.runs.is_empty() {
            self.sample(k, lanes.as_mut());
            k += 1;
            let mut over = false;
            for run in &mut self.runs {
                over |= run.is_over(k);
                if run.trace.len() >= self.block && !run.is_over(k) {
                    each(run.arm, &mut run.trace)?;
                    run.trace.clear();
                }
            }
            if over {
                for mut run in self.runs.extract_if(.., |run| run.is_over(k)) {
                    each(run.arm, &mut run.trace)?;
                    ends.push((run.arm, run.simulation.ended(run.divergence)));
                }
                lanes = self.lanes();
            }
        }
        Ok(())
    }

    /// One sample of every arm.
    fn sample(&mut self, k: u64, lanes: Option<&mut PlantLanes>) {
        let mut t = 0.0;
        for GroupRun { simulation, trace, .. } in &mut self.runs {
            simulation.world.sense(k, k * simulation.period_ns);
            t = simulation.begin(k, trace);
        }
        match lanes {
            Some(lanes) => lanes.integrate(t, &mut self.runs, |run| &mut run.simulation.world),
            None => self.runs.iter_mut().for_each(|run| run.simulation.world.integrate(t)),
        }
        for GroupRun { simulation, trace, integrals, divergence, .. } in &mut self.runs {
            *divergence = simulation.finish(t, trace, integrals);
        }
    }

    /// Lanes for those that still run; `None`: it does not pay for one.
    fn lanes(&self) -> Option<PlantLanes> {
        let worlds: Vec<&SimulatedWorld> =
            self.runs.iter().map(|run| &*run.simulation.world).collect();
        if worlds.len() < 2 { None } else { PlantLanes::new(&worlds).ok() }
    }
}

impl GroupRun {
    /// Returns true if no sample follows after `k` samples.
    fn is_over(&self, k: u64) -> bool {
        self.divergence.is_some()
            || self.simulation.world.path.abort.is_some()
            || k >= self.simulation.samples()
    }
}
