//! An arm of the comparison: a study, and the studies that it becomes in every world and with every motion.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use phihat_campaign::JournalError;
use phihat_model::ModelError;
use phihat_rivals::{Entry, Refusal, Supply};
use phihat_session::disk::DiskError;
use phihat_session::{SessionError, set};
use phihat_sim::{Demand, Driver, Moment, Motion, SimError, Simulation};
use phihat_study::{Study, StudyError};
use thiserror::Error;
use toml::{Table, Value};

use super::adapter::supply;
use super::motion::Reach;
use super::own::Own;
use super::record::ArmRecord;
use super::trial::NOMINAL_MASSES;
use super::world::World;

/// Why a comparison cannot be made, run or written.
#[derive(Debug, Error)]
pub enum CompareError {
    /// A study cannot be read, or not in one of the worlds.
    #[error("{}", .0.render())]
    Study(Box<StudyError>),
    /// A study does not fit a comparison.
    #[error("{}: {why}", path.display())]
    Unfit {
        /// The study.
        path: PathBuf,
        /// Why.
        why: Box<dyn Error + Send + Sync>,
    },
    /// A run cannot begin.
    #[error("{0}")]
    Begin(Box<dyn Error + Send + Sync>),
    /// No rival has such an id.
    #[error("there is no rival `{0}`")]
    Rival(String),
    /// No world has such a name.
    #[error("there is no world `{0}`")]
    World(String),
    /// No run has such a name.
    #[error("there is no run `{0}`; names are ARM/RIVAL/WORLD/default|tuned/SEED")]
    Run(String),
    /// One run is to be repeated, and rivals or worlds are chosen beside it.
    #[error("--trace names one run, with its rival and its world: leave out --only and --worlds")]
    OneRun,
    /// A result cannot be written.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A run's files cannot be written.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The answer cannot be written.
    #[error("{0}")]
    Answer(serde_json::Error),
}

impl From<StudyError> for CompareError {
    fn from(why: StudyError) -> Self {
        Self::Study(Box::new(why))
    }
}

/// An arm: its study, and what follows from it before any run.
#[derive(Debug, Clone)]
pub struct Ground {
    /// The study's name.
    pub name: String,
    /// The study's file.
    pub path: PathBuf,
    /// The study itself.
    pub(crate) study: Study,
    table: Table,
    reach: Reach,
    /// `U` \[kg·m²\] per joint.
    pub(crate) units: Vec<f64>,
    /// Eigenvalues of `U^{-1/2} M U^{-1/2}` over postures and payloads.
    pub(crate) ratio: [f64; 2],
    /// Eigenvalues of `M` \[kg·m²\].
    pub(crate) eigenvalues: [f64; 2],
    /// `[spec] error_max_rad` per joint.
    pub(crate) error_max: Vec<f64>,
    /// Torque limits \[N·m\] per joint.
    pub(crate) limits: Vec<f64>,
    designed: OnceLock<Result<Own, String>>,
}

/// A driver that does nothing: to see whether a study can be simulated.
#[derive(Debug)]
struct Idle;

impl Driver for Idle {
    fn drive(&mut self, _: &Moment<'_>, _: &mut [f64]) {}
}

/// Which motion a run has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Task {
    /// The study's own where the seed is 1, else one drawn from the seed.
    Score(u64),
    /// One to train on, from 1.
    Train(u64),
}

/// How long a run is and where its scored part begins \[s\].
pub(crate) type Span = (f64, f64);

/// Sizes that a drawn motion is tried with, until one keeps the joints' limits.
const SCALES: [f64; 4] = [1.0, 0.7, 0.5, 0.3];

impl Ground {
    /// Reads a study.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: it cannot be read, or lacks what a comparison needs.
    pub(crate) fn read(path: &Path) -> Result<Self, CompareError> {
        let study = Study::read(path)?;
        let unfit =
            |why: Box<dyn Error + Send + Sync>| CompareError::Unfit { path: path.to_owned(), why };
        let lacks =
            |key: &str, what: &str| unfit(format!("a comparison needs {what}: state {key}").into());
        let limits = study.control.torque_max.clone();
        let limits = limits.ok_or_else(|| lacks("loop.torque_max_nm", "torque limits"))?;
        let error_max = study.spec.error_max.clone();
        let error_max =
            error_max.ok_or_else(|| lacks("spec.error_max_rad", "the error that is lived with"))?;
        if study.design.payload.mass.1 <= 0.0 {
            return Err(lacks("design.payload_max_kg", "the heaviest payload"));
        }
        let table: Table = study.text.parse().map_err(|e: toml::de::Error| unfit(e.into()))?;
        if table.contains_key("profile") || !study.faults.is_empty() {
            let why = "a comparison runs bare laws: remove [profile] and [[fault]]";
            return Err(unfit(why.into()));
        }
        let n = study.robot.joints.len();
        let motion = Motion::new(&study.reference, &study.robot, study.duration);
        let motion = motion.map_err(|e| unfit(e.into()))?;
        let inertias = phihat_session::arm_along(&study).map_err(|e| unfit(e.into()))?;
        let given = study.gains.as_ref().map(|gains| gains.inertia.clone());
        let units = given.unwrap_or_else(|| inertias.nominal());
        let over = |units: Vec<f64>| inertias.against(units).map_err(|e| unfit(e.into()));
        let (relative, plain) = (over(units.clone())?, over(vec![1.0; n])?);
        Ok(Self {
            name: study.name.clone(),
            path: path.to_owned(),
            table,
            reach: Reach::of(&motion, n, study.duration),
            units,
            ratio: [relative.low, relative.high],
            eigenvalues: [plain.low, plain.high],
            error_max,
            limits,
            designed: OnceLock::new(),
            study,
        })
    }

    pub(crate) fn joints(&self) -> usize {
        self.units.len()
    }

    /// The gains that this project's design gives for the study's specification, or why there are none; designed
    /// when first asked for.
    pub(crate) fn designed(&self) -> &Result<Own, String> {
        self.designed.get_or_init(|| Own::designed(&self.study))
    }

    /// What a rival may know of the arm in one of its worlds.
    ///
    /// # Errors
    ///
    /// [`ModelError`]: the nominal model cannot be made.
    pub(crate) fn supply(&self, entry: &Entry, study: &Study) -> Result<Supply, ModelError> {
        let mut supply = supply(study, &self.units, NOMINAL_MASSES)?;
        if entry.needs.designed {
            let designed = self.designed().as_ref().map(Own::joints);
            supply.designed = designed.map_err(|why| Refusal::NotApplicable(why.clone()));
        }
        Ok(supply)
    }

    /// The arm in a world with a task, as a study of its own that `phihat run` would read.
    ///
    /// # Errors
    ///
    /// [`CompareError::Study`]: the arm's study does not bear the world.
    pub(crate) fn in_world(
        &self,
        world: &World,
        task: Task,
        (duration, settle): Span,
    ) -> Result<Study, CompareError> {
        let mut table = self.table.clone();
        // Pushes of the study's own may lie outside a shorter run.
        if let Some(world) = table.get_mut("world").and_then(Value::as_table_mut) {
            world.remove("push");
        }
        let seed = match task {
            Task::Score(seed) | Task::Train(seed) => i64::try_from(seed).unwrap_or(i64::MAX),
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

    /// How many integration steps a sample must have, where the study has too few.
    fn too_stiff(&self, study: &Study) -> Option<u32> {
        match Simulation::driven(study, Box::new(Idle), &self.units) {
            Err(SimError::TooStiff { needed, .. }) => Some(needed),
            _ => None,
        }
    }

    /// Puts the task's motion into a table, as large as the joints' limits bear it.
    fn with_motion(&self, table: &mut Table, task: Task) -> Result<Study, CompareError> {
        let name = match task {
            Task::Score(1) => return self.parse(table),
            Task::Score(seed) => format!("score {seed}"),
            Task::Train(seed) => format!("train {seed}"),
        };
        let (first, smaller) = (SCALES[0], &SCALES[1..]);
        let mut scaled = |scale: f64| {
            table.insert("reference".to_owned(), self.reach.draw(&name, scale).into());
            self.parse(table)
        };
        smaller.iter().fold(scaled(first), |last, scale| last.or_else(|_| scaled(*scale)))
    }

    fn parse(&self, table: &Table) -> Result<Study, CompareError> {
        let origin = self.path.display().to_string();
        let folder = self.path.parent().unwrap_or(Path::new(""));
        Ok(Study::from_text(&table.to_string(), &origin, folder)?)
    }

    pub(crate) fn record(&self) -> ArmRecord {
        ArmRecord {
            name: self.name.clone(),
            robot: self.study.robot.name.clone(),
            study: self.path.display().to_string(),
            study_sha256: self.study.sha256.clone(),
            joints: self.study.robot.joints.iter().map(|joint| joint.name.clone()).collect(),
            inertia: self.units.clone(),
            error_max_rad: self.error_max.clone(),
        }
    }
}
