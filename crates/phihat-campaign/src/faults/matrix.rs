//! The matrix: arms × orders × faults × severities × seeds.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use phihat_design::{Gains, GainsError};
use phihat_sim::{Motion, SimError, Simulation};
use phihat_study::{Study, StudyError};
use thiserror::Error;
use toml::Table;

use super::case::{CaseName, FaultCase};
use super::catalogue::{Effect, FAULTS, SEVERITIES};
use super::change::{FaultDraw, JointUnits, change};
use crate::journal::JournalError;
use phihat_session::{SessionError, set, share, short_hash};

/// Raised when the same run would come out otherwise: journals of before are then done again.
const EDITION: &str = "faults 1";

/// An arm of the matrix: a study without faults.
#[derive(Debug, Clone)]
pub struct FaultedArm {
    /// The study's name.
    pub name: String,
    /// The study's file.
    pub path: PathBuf,
    pub(crate) sha256: String,
    table: Table,
    /// Joint positions at the start of its reference \[rad\].
    start: Vec<f64>,
    /// The study and its gains, one pair for each order of the matrix.
    pub(crate) orders: Vec<(usize, Study, Gains)>,
}

/// Selected part of the matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixExtent {
    /// Estimator orders.
    pub orders: Vec<usize>,
    /// Seeds 1 to this.
    pub seeds: u64,
    /// Only runs whose name contains this.
    pub only: Option<String>,
}

/// A fault matrix, ready to run.
#[derive(Debug, Clone)]
pub struct FaultMatrix {
    /// The arms.
    pub arms: Vec<FaultedArm>,
    /// The runs, in the order of the answer.
    pub cases: Vec<FaultCase>,
}

/// Why a matrix cannot be made, run or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FaultsError {
    /// A study cannot be read, or not with the fault in it.
    #[error("{}", .0.render())]
    Study(Box<StudyError>),
    /// A study does not fit a fault matrix.
    #[error("{}: {why}", path.display())]
    Unfit {
        /// The study.
        path: PathBuf,
        /// Why.
        why: Box<dyn Error + Send + Sync>,
    },
    /// There are no gains of an order.
    #[error("{}: order {order}: {why}", path.display())]
    NoGains {
        /// The study.
        path: PathBuf,
        /// The order.
        order: usize,
        /// Why.
        why: Box<SessionError>,
    },
    /// No run has such a name.
    #[error(
        "no run's name contains `{0}`; names are ARM/mORDER/FAULT/SEVERITY/SEED, as in panda/m2/freeze/3/1"
    )]
    Nothing(String),
    /// No estimator has such an order.
    #[error("--orders {0}: orders are 1 to {max}", max = phihat::ORDER_MAX)]
    Order(usize),
    /// More traces than are kept: runs, and how many there may be.
    #[error("--trace: {0} runs; choose {1} at most with --only")]
    TooManyTraces(usize, usize),
    /// A run that is kept whole cannot begin, or a result not be written.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// Gains cannot be written.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// The answer cannot be written.
    #[error("{0}")]
    Answer(serde_json::Error),
}

impl From<StudyError> for FaultsError {
    fn from(why: StudyError) -> Self {
        Self::Study(Box::new(why))
    }
}

/// Why a run cannot begin.
#[derive(Debug, Error)]
pub(crate) enum FaultRunError {
    #[error(transparent)]
    Study(#[from] FaultsError),
    #[error("{0}")]
    Gains(#[from] GainsError),
    #[error("{0}")]
    Sim(#[from] SimError),
}

/// Function that finds, for a study, gains that may run on its arm.
pub type Choose<'a> = &'a dyn Fn(&Study, &Path) -> Result<Gains, SessionError>;

impl FaultMatrix {
    /// Reads the studies and finds the gains of every arm and order: those kept in `cache` if they were made
    /// from this very study, else those that `choose` finds for the study with the order stated in it.
    ///
    /// # Errors
    ///
    /// [`FaultsError`]
    pub fn new(
        studies: &[PathBuf],
        extent: &MatrixExtent,
        cache: &Path,
        choose: Choose<'_>,
    ) -> Result<Self, FaultsError> {
        let mut arms = Vec::new();
        for path in studies {
            let arm = FaultedArm::read(path, &extent.orders, cache, choose)?;
            if arms.iter().any(|other: &FaultedArm| other.name == arm.name) {
                let why = "another study of the matrix has the same name".into();
                return Err(FaultsError::Unfit { path: path.clone(), why });
            }
            arms.push(arm);
        }
        let mut matrix = Self { arms, cases: Vec::new() };
        let only = extent.only.as_deref().unwrap_or_default();
        for arm in 0..matrix.arms.len() {
            for fault in FAULTS {
                for &order in &extent.orders {
                    for severity in 0..SEVERITIES {
                        for seed in 1..=extent.seeds {
                            let case = FaultCase { arm, order, fault, severity, seed };
                            if matrix.name(&case).to_string().contains(only) {
                                matrix.cases.push(case);
                            }
                        }
                    }
                }
            }
        }
        if matrix.cases.is_empty() {
            return Err(FaultsError::Nothing(only.to_owned()));
        }
        Ok(matrix)
    }

    /// The name of a run.
    pub fn name<'a>(&'a self, case: &'a FaultCase) -> CaseName<'a> {
        CaseName { case, arm: &self.arms[case.arm].name }
    }

    /// The gains that a run uses.
    pub fn gains(&self, case: &FaultCase) -> &Gains {
        &self.base(case).2
    }

    /// The study that a run is: the arm's with one thing changed.
    fn table(&self, case: &FaultCase) -> Table {
        let (_, study, _) = self.base(case);
        let draw = self.draw(case);
        let arm = &self.arms[case.arm];
        let torque = study.control.torque_max.as_ref().map_or(0.0, |max| max[draw.joint]);
        let units =
            JointUnits { period: period(study), torque, payload: study.design.payload.mass.1 };
        let joint = &study.robot.joints[draw.joint].name;
        let mut table = with_order(&arm.table, case.order);
        let seed = i64::try_from(case.seed).unwrap_or(i64::MAX);
        set(&mut table, &["seed"], seed.into());
        let title = format!(
            "{}: {} {} {}",
            self.name(case),
            case.fault.what,
            case.fault.levels[case.severity],
            case.fault.unit
        );
        set(&mut table, &["title"], title.trim_end().into());
        change(&mut table, (case.fault, case.severity), &draw, units, joint);
        table
    }

    /// The id of a run: equal ids, equal outcomes.
    pub fn id(&self, case: &FaultCase) -> String {
        let gains = self.gains(case).to_json().unwrap_or_default();
        let version = env!("CARGO_PKG_VERSION");
        short_hash(&[
            EDITION,
            version,
            &self.name(case).to_string(),
            &self.table(case).to_string(),
            &gains,
        ])
    }

    /// The study that a run is.
    ///
    /// If a fault makes the world too stiff for the arm's integration steps, the steps are made shorter.
    ///
    /// # Errors
    ///
    /// [`FaultsError::Study`]: the arm's study does not bear the fault.
    pub fn study(&self, case: &FaultCase) -> Result<Box<Study>, FaultsError> {
        let mut table = self.table(case);
        let path = &self.arms[case.arm].path;
        let mut study = Box::new(read(&table.to_string(), path)?);
        self.complete(case, &mut study);
        if let Err(FaultRunError::Sim(SimError::TooStiff { needed, .. })) = self.build(case, &study)
        {
            set(&mut table, &["world", "substeps"], i64::from(needed).into());
            *study = read(&table.to_string(), path)?;
        }
        self.complete(case, &mut study);
        Ok(study)
    }

    /// Completes the study with the values that the gains carry; gains without a filter run without one.
    fn complete(&self, case: &FaultCase, study: &mut Study) {
        let _ = self.gains(case).complete(study);
    }

    /// The closed loop of a run.
    pub(crate) fn build(
        &self,
        case: &FaultCase,
        study: &Study,
    ) -> Result<Simulation, FaultRunError> {
        let form = study.control.form;
        let names = study.robot.joint_names();
        let gains = self.gains(case).joint_gains(&names, study.control.period_ns, form)?;
        Ok(Simulation::new(study, &gains)?)
    }

    /// When a run's fault begins \[s\], and the joint drawn for it.
    pub(crate) fn draw(&self, case: &FaultCase) -> FaultDraw {
        let (_, study, _) = self.base(case);
        let name = self.name(case).to_string();
        let n = study.robot.joints.len();
        let at = 0.1 + 0.3 * share(&name, "onset");
        let period = period(study);
        let sample =
            ((study.spec.settle + at * (study.duration - study.spec.settle)) / period).round();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a small number"
        )]
        let joint = (share(&name, "joint") * n as f64) as usize;
        let constant = matches!(case.fault.effect, Effect::Keys(_) | Effect::StartBeside);
        FaultDraw {
            // Between two samples: rounding cannot make it one sample longer.
            onset: if constant { 0.0 } else { (sample - 0.5) * period },
            start: self.arms[case.arm].start.clone(),
            joint: joint.min(n - 1),
            sign: if share(&name, "sign") < 0.5 { 1.0 } else { -1.0 },
        }
    }

    fn base(&self, case: &FaultCase) -> &(usize, Study, Gains) {
        let orders = &self.arms[case.arm].orders;
        // Cases are made from these orders.
        orders.iter().find(|(order, ..)| *order == case.order).unwrap_or(&orders[0])
    }
}

impl FaultedArm {
    #[allow(clippy::large_stack_frames, reason = "one arm after the other")]
    fn read(
        path: &Path,
        orders: &[usize],
        cache: &Path,
        choose: Choose<'_>,
    ) -> Result<Self, FaultsError> {
        let plain = Study::read(path)?;
        let unfit =
            |why: Box<dyn Error + Send + Sync>| FaultsError::Unfit { path: path.to_owned(), why };
        if plain.control.torque_max.is_none() {
            let why = "a fault matrix needs torque limits: state loop.torque_max_nm";
            return Err(unfit(why.into()));
        }
        if !plain.faults.is_empty() {
            let why = "the study has faults of its own: the matrix adds its own, one at a time";
            return Err(unfit(why.into()));
        }
        let table: Table = plain.table().map_err(|e: toml::de::Error| unfit(e.into()))?;
        let motion = Motion::new(&plain.reference, &plain.robot, plain.duration);
        let motion = motion.map_err(|e| unfit(e.into()))?;
        let mut arm = Self {
            start: (0..plain.robot.joints.len()).map(|i| motion.at(i, 0.0)[0]).collect(),
            name: plain.name,
            path: path.to_owned(),
            sha256: plain.sha256,
            table,
            orders: Vec::new(),
        };
        for &order in orders {
            let study = read(&with_order(&arm.table, order).to_string(), path)?;
            let kept = cache.join(format!("{}-m{order}.json", arm.name));
            let gains = match cached(&kept, &study) {
                Some(gains) => gains,
                None => choose(&study, path).map_err(|why| {
                    let (path, why) = (path.to_owned(), Box::new(why));
                    FaultsError::NoGains { path, order, why }
                })?,
            };
            arm.orders.push((order, study, gains));
        }
        Ok(arm)
    }

    /// The gains of each order, with the file name they are kept under.
    pub fn gains(&self) -> impl Iterator<Item = (String, &Gains)> {
        self.orders.iter().map(|(order, _, gains)| (format!("{}-m{order}.json", self.name), gains))
    }
}

/// The sample period \[s\].
fn period(study: &Study) -> f64 {
    study.control.period_ns as f64 * 1e-9
}

fn read(text: &str, path: &Path) -> Result<Study, FaultsError> {
    let origin = path.display().to_string();
    Ok(Study::from_text(text, &origin, path.parent().unwrap_or(Path::new("")))?)
}

/// Gains made from this very study.
fn cached(path: &Path, study: &Study) -> Option<Gains> {
    let gains = Gains::from_json(&fs::read_to_string(path).ok()?).ok()?;
    (gains.study_sha256 == study.sha256).then_some(gains)
}

/// The study with its estimator's order stated, under the supervisor.
fn with_order(table: &Table, order: usize) -> Table {
    let mut table = table.clone();
    table.entry("supervisor").or_insert_with(|| toml::Value::Table(Table::new()));
    let order = i64::try_from(order).unwrap_or(i64::MAX);
    if table.contains_key("gains") {
        set(&mut table, &["gains", "order"], order.into());
    } else {
        set(&mut table, &["design", "orders"], vec![order].into());
    }
    table
}
