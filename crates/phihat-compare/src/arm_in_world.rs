//! The studies that an arm becomes in every world and with every motion.

use std::path::Path;

use phihat_session::set;
use phihat_sim::{Demand, Driver, Moment, SimError, Simulation};
use phihat_study::Study;
use toml::{Table, Value};

use crate::arm_case::ArmCase;
use crate::error::CompareError;
use crate::world::ComparisonWorld;

/// A driver that does nothing: to see whether a study can be simulated.
#[derive(Debug)]
pub(crate) struct Idle;

impl Driver for Idle {
    fn drive(&mut self, _: &Moment<'_>, _: &mut [f64]) {}
}

/// Motion of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ComparisonTask {
    /// The study's own where the seed is 1, else one drawn from the seed.
    Score(u64),
    /// One to train on, from 1.
    Train(u64),
}

/// Length of a run, and start of its scored part \[s\].
pub(crate) type TimeSpan = (f64, f64);

/// Sizes that a drawn motion is tried with, until one keeps the joints' limits.
const SCALES: [f64; 4] = [1.0, 0.7, 0.5, 0.3];

impl ArmCase {
    /// The arm in a world with a task, as a study of its own that `phihat run` would read.
    ///
    /// # Errors
    ///
    /// [`CompareError::Study`]: the arm's study does not bear the world.
    pub(crate) fn in_world(
        &self,
        world: &ComparisonWorld,
        task: ComparisonTask,
        (duration, settle): TimeSpan,
    ) -> Result<Study, CompareError> {
        let mut table = self.table.clone();
        // Pushes of the study's own may lie outside a shorter run.
        if let Some(world) = table.get_mut("world").and_then(Value::as_table_mut) {
            world.remove("push");
        }
        let seed = match task {
            ComparisonTask::Score(seed) | ComparisonTask::Train(seed) => {
                i64::try_from(seed).unwrap_or(i64::MAX)
            }
        };
        set(&mut table, &["duration_s"], duration.into());
        set(&mut table, &["spec", "settle_s"], settle.into());
        set(&mut table, &["seed"], seed.into());
        let plain = self.with_motion(&mut table, task)?;
        let demand = Demand::along(&plain).map_err(|e| CompareError::Begin(e.into()))?;
        let title = format!("{}: {}", self.name, world.what);
        set(&mut table, &["title"], title.into());
        world.change(&mut table, &plain, &demand);
        let study = self.parse(&table)?;
        let Some(needed) = self.too_stiff(&study) else { return Ok(study) };
        set(&mut table, &["world", "substeps"], i64::from(needed).into());
        self.parse(&table)
    }

    /// Required number of integration steps per sample, where the study has too few.
    pub(crate) fn too_stiff(&self, study: &Study) -> Option<u32> {
        match Simulation::driven(study, Box::new(Idle), &self.units) {
            Err(SimError::TooStiff { needed, .. }) => Some(needed),
            _ => None,
        }
    }

    /// Puts the task's motion into a table, as large as the joints' limits bear it.
    fn with_motion(&self, table: &mut Table, task: ComparisonTask) -> Result<Study, CompareError> {
        let name = match task {
            ComparisonTask::Score(1) => return self.parse(table),
            ComparisonTask::Score(seed) => format!("score {seed}"),
            ComparisonTask::Train(seed) => format!("train {seed}"),
        };
        self.moved(table, &name)
    }

    /// Puts a motion drawn from its name into a table, as large as the joints' limits bear it.
    pub(crate) fn moved(&self, table: &mut Table, name: &str) -> Result<Study, CompareError> {
        let (first, smaller) = (SCALES[0], &SCALES[1..]);
        let mut scaled = |scale: f64| {
            table.insert("reference".to_owned(), self.range.draw(name, scale).into());
            self.parse(table)
        };
        smaller.iter().fold(scaled(first), |last, scale| last.or_else(|_| scaled(*scale)))
    }

    pub(crate) fn parse(&self, table: &Table) -> Result<Study, CompareError> {
        let origin = self.path.display().to_string();
        let folder = self.path.parent().unwrap_or(Path::new(""));
        Ok(Study::from_text(&table.to_string(), &origin, folder)?)
    }
}
