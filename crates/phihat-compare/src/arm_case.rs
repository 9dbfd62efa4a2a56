//! An arm of the comparison: its study, and what follows from it before any run.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use phihat_model::ModelError;
use phihat_rivals::{DesignedPosition, Entry, RivalRefusal, Scalar, SensedChoice, Supply};
use phihat_sim::Motion;
use phihat_study::Study;
use toml::Table;

use crate::adapter::{NOMINAL_MASSES, supply};
use crate::error::CompareError;
use crate::motion::MotionRange;
use crate::proposed_law::{ComparedLaw, NotDesigned};
use crate::proposed_positions::designed_positions;
use crate::record::ArmRecord;

/// An arm: its study, and what follows from it before any run.
#[derive(Debug, Clone)]
pub struct ArmCase {
    /// The study's name.
    pub name: String,
    /// The study's file.
    pub path: PathBuf,
    /// The study itself.
    pub(crate) study: Study,
    pub(crate) table: Table,
    pub(crate) range: MotionRange,
    /// `U` \[kg·m²\] per joint.
    pub(crate) units: Vec<f64>,
    /// Eigenvalues of `U^{-1/2} M U^{-1/2}` over postures and payloads.
    pub(crate) ratio: [f64; 2],
    /// Eigenvalues of `M` \[kg·m²\].
    pub(crate) eigenvalues: [f64; 2],
    /// `[spec] error_bound_rad` per joint.
    pub(crate) error_bound: Vec<f64>,
    /// Torque limits \[N·m\] per joint.
    pub(crate) limits: Vec<f64>,
    /// Study that this project's designs use in place of `study`, where its worlds are harder.
    pub(crate) harder: Option<Study>,
    designed: OnceLock<Result<ComparedLaw, Arc<NotDesigned>>>,
    designed_positions: OnceLock<Result<Vec<DesignedPosition>, Arc<NotDesigned>>>,
    designed_filters: OnceLock<Result<Vec<DesignedPosition>, Arc<NotDesigned>>>,
}

impl ArmCase {
    /// Reads a study.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: it cannot be read, or lacks what a comparison needs.
    pub(crate) fn read(path: &Path) -> Result<Self, CompareError> {
        Self::of(Study::read(path)?, path)
    }

    /// Takes a study from its text; `path` names it, and paths in it hold from the current folder.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: it cannot be read, or lacks what a comparison needs.
    pub fn from_text(text: &str, path: &str) -> Result<Self, CompareError> {
        Self::of(Study::from_text(text, path, Path::new(""))?, Path::new(path))
    }

    fn of(study: Study, path: &Path) -> Result<Self, CompareError> {
        let unfit =
            |why: Box<dyn Error + Send + Sync>| CompareError::Unfit { path: path.to_owned(), why };
        let lacks =
            |key: &str, what: &str| unfit(format!("a comparison needs {what}: state {key}").into());
        let limits = study.control.torque_max.clone();
        let limits = limits.ok_or_else(|| lacks("loop.torque_max_nm", "torque limits"))?;
        let error_bound = study.spec.error_bound.clone();
        let error_bound = error_bound
            .ok_or_else(|| lacks("spec.error_bound_rad", "the error that is lived with"))?;
        if study.design.payload.mass.1 <= 0.0 {
            return Err(lacks("design.payload_max_kg", "the heaviest payload"));
        }
        let table: Table = study.table().map_err(|e: toml::de::Error| unfit(e.into()))?;
        if table.contains_key("profile") || !study.faults.is_empty() {
            let why = "a comparison runs bare laws: remove [profile] and [[fault]]";
            return Err(unfit(why.into()));
        }
        let n = study.robot.joints.len();
        let motion = Motion::new(&study.reference, &study.robot, study.duration);
        let motion = motion.map_err(|e| unfit(e.into()))?;
        let inertias = phihat_synthesis::arm_along(&study).map_err(|e| unfit(e.into()))?;
        let given = study.gains.as_ref().map(|gains| gains.inertia.clone());
        let units = given.unwrap_or_else(|| inertias.nominal());
        let over = |units: Vec<f64>| inertias.against(units).map_err(|e| unfit(e.into()));
        let (relative, plain) = (over(units.clone())?, over(vec![1.0; n])?);
        Ok(Self {
            name: study.name.clone(),
            path: path.to_owned(),
            table,
            range: MotionRange::of(&motion, n, study.duration),
            units,
            ratio: [relative.low, relative.high],
            eigenvalues: [plain.low, plain.high],
            error_bound,
            limits,
            harder: None,
            designed: OnceLock::new(),
            designed_positions: OnceLock::new(),
            designed_filters: OnceLock::new(),
            study,
        })
    }

    pub(crate) fn joints(&self) -> usize {
        self.units.len()
    }

    /// The gains that this project's design gives for the study's specification, or why there are none;
    /// designed at the first call. Where no gains satisfy it in the harder loop, they are those for the
    /// study's own.
    pub(crate) fn designed(&self) -> &Result<ComparedLaw, Arc<NotDesigned>> {
        self.designed.get_or_init(|| {
            let harder = self.harder.as_ref().and_then(|told| ComparedLaw::designed(told).ok());
            harder.map_or_else(|| ComparedLaw::designed(&self.study), Ok).map_err(Arc::new)
        })
    }

    /// The paper's law with the values of a row, where the row's law is the paper's under any name; that from
    /// positions is another.
    pub(crate) fn proposed(&self, entry: &Entry, values: &[f64]) -> Option<ComparedLaw> {
        if entry.needs.designed && !entry.needs.preview {
            return self.designed().as_ref().ok().cloned();
        }
        ComparedLaw::with(entry.card.id, values, &self.units, self.ratio)
    }

    /// Data of the arm for a rival in one of its worlds.
    ///
    /// # Errors
    ///
    /// [`ModelError`]: the nominal model cannot be made.
    pub(crate) fn supply(&self, entry: &Entry, study: &Study) -> Result<Supply, ModelError> {
        Ok(self.completed(entry, supply(study, &self.units, NOMINAL_MASSES)?))
    }

    /// The same with the gains that this project's design gives, for a law that asks for them.
    pub(crate) fn completed(&self, entry: &Entry, mut supply: Supply) -> Supply {
        if entry.needs.designed && entry.needs.preview {
            let told = self.harder.as_ref().unwrap_or(&self.study);
            let filter = entry.needs.filter;
            let found = || designed_positions(told, &self.limits, filter).map_err(Arc::new);
            let (kept, handed) = if filter {
                (&self.designed_filters, &mut supply.designed_filters)
            } else {
                (&self.designed_positions, &mut supply.designed_positions)
            };
            let designed = kept.get_or_init(found).clone();
            *handed = designed.map_err(|why| RivalRefusal::NotApplicable(why.to_string()));
        } else if entry.needs.designed {
            let designed = self.designed().as_ref().map(ComparedLaw::joints);
            supply.designed = designed.map_err(|why| RivalRefusal::NotApplicable(why.to_string()));
        }
        supply
    }

    /// A law's own scalars, then the free choices in its inputs; and the number of them, from the first,
    /// whose ranges may be widened.
    pub(crate) fn free(&self, entry: &Entry) -> (Vec<Scalar>, usize) {
        let sensed = SensedChoice {
            rate_hz: 1e9 / self.study.control.period_ns as f64,
            velocity_filter_hz: self.study.sensor.velocity_filter_hz,
        };
        let (choices, wide) = entry.choices(sensed);
        (entry.scalars.iter().copied().chain(choices).collect(), entry.scalars.len() + wide)
    }

    pub(crate) fn record(&self) -> ArmRecord {
        ArmRecord {
            name: self.name.clone(),
            robot: self.study.robot.name.clone(),
            study: self.path.display().to_string(),
            study_sha256: self.study.sha256.clone(),
            joints: self.study.robot.joint_names(),
            inertia: self.units.clone(),
            error_bound_rad: self.error_bound.clone(),
        }
    }
}
