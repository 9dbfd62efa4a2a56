//! One study and its gains, taken through a run.

use phihat::Form;
use std::convert::Infallible;
use std::path::{Path, PathBuf};

use phihat_design::budget::Budget;
use phihat_design::{Arm, Gains, Infeasible, Outcome, arm_inside_window, requested_gains};
use phihat_report::{RecordedBound, RunInfo};
use phihat_sim::{BLOCK, Divergence, Ended, Simulation, Trace};
use phihat_study::{JOINT_BY_JOINT, Study};
use phihat_synthesis::BudgetSearch;

use crate::budget::{BudgetFiles, write_budget};
use crate::contact::watched;
use crate::design::{self, budget};
use crate::disk::{DiskError, Lock};
use crate::error::SessionError;
use crate::files::read_gains;
use crate::layout::TraceKind;
use crate::log::LogFile;
use crate::observer::{RunFigures, RunObserver, error_shares, settle, watch_bound};
use crate::record::{Done, TraceFiles};
use crate::run_record::designed_before;
use crate::verify::recorded_bound;
use crate::watch::Watch;
use crate::words;

/// Options of a run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// The study file (TOML).
    pub study: PathBuf,
    /// A gains document in place of those that the study states or leaves to the design.
    pub gains: Option<PathBuf>,
    /// Folder for the results; `None`: `out/STUDY`.
    pub out: Option<PathBuf>,
    /// Runs gains even where they may not run on this arm; marked in the record.
    pub uncertified: bool,
    /// Build of the program, if it is known: gains that it designed for the same study are taken from the
    /// folder instead of being designed once more. `None`: they are designed.
    pub program: Option<String>,
    /// Designs once more, whatever the folder holds.
    pub fresh: bool,
    /// Kind of file of the trace.
    pub trace: TraceKind,
    /// A log of the run for ROS tools and viewers (MCAP), beside the record; see [`LOGS`](crate::LOGS).
    pub log: Option<PathBuf>,
}

impl RunOptions {
    /// Reads and checks everything; nothing is written before all of it fits. With the folder for the results.
    ///
    /// # Errors
    ///
    /// [`SessionError`], as of [`Session::new`].
    pub fn open(&self) -> Result<(Session, PathBuf), SessionError> {
        self.open_study(design::read(&self.study)?)
    }

    /// The same of a study that somebody else made; the options' file stands for it in messages.
    ///
    /// # Errors
    ///
    /// As of [`Self::open`].
    pub fn open_study(&self, study: Box<Study>) -> Result<(Session, PathBuf), SessionError> {
        if let Some(log) = &self.log {
            LogFile::offered(log)?;
        }
        let default = || Path::new("out").join(&study.name);
        let folder = self.out.clone().unwrap_or_else(default);
        let gains = match (&self.gains, &self.program) {
            (Some(file), _) => GainsSource::Given(Box::new(read_gains(file)?), file),
            (None, Some(program)) if !self.fresh && requested_gains(&study).is_none() => {
                designed_before(&study, &folder, program)
                    .map_or(GainsSource::Own, |gains| GainsSource::Before(Box::new(gains)))
            }
            _ => GainsSource::Own,
        };
        let mut session = Session::of(study, &self.study, gains, self.uncertified)?;
        if session.designs {
            session.designed_by.clone_from(&self.program);
        }
        session.trace = self.trace;
        session.log.clone_from(&self.log);
        Ok((session, folder))
    }

    /// Writes the error budget of a study that no gains serve, with the changes that help, to the folder of
    /// its run.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the study cannot be read, or the files not be written.
    pub fn explain(
        &self,
        no: &Infeasible,
        watch: &mut dyn Watch,
    ) -> Result<(Budget, BudgetFiles), SessionError> {
        let study = design::read(&self.study)?;
        let arm = design::arm(&study, &self.study)?;
        let outcome = Outcome::Infeasible(no.clone());
        let budget = budget(&study, &arm, &self.study, (&outcome, BudgetSearch::Changes), watch)?;
        let default = || Path::new("out").join(&study.name);
        let files = write_budget(&budget, &self.out.clone().unwrap_or_else(default))?;
        Ok((budget, files))
    }
}

/// Beginning of a line that predicts a violation of the robot's torque interface.
const FORECAST: &str = "forecast:";

/// A study and its gains, ready to run.
#[derive(Debug)]
pub struct Session {
    pub(crate) study: Box<Study>,
    pub(crate) gains: Gains,
    pub(crate) simulation: Box<Simulation>,
    pub(crate) command: String,
    pub(crate) warnings: Vec<String>,
    /// Kind of file of the trace.
    pub(crate) trace: TraceKind,
    /// Path of the requested log.
    pub(crate) log: Option<PathBuf>,
    /// True if the gains are those that the design makes for this study.
    designs: bool,
    /// True if they are of an earlier run.
    before: bool,
    /// The build that designed them, where it can tell.
    designed_by: Option<String>,
    /// Bound on the error as a second derivation left it; `None`: it was not made.
    bound: Option<RecordedBound>,
}

/// Source of a run's gains.
enum GainsSource<'a> {
    /// Somebody gave them, in a file of this name.
    Given(Box<Gains>, &'a Path),
    /// An earlier run of the same study designed them.
    Before(Box<Gains>),
    /// The study states them, or leaves them to the design.
    Own,
}

impl Session {
    /// Takes the gains given, with their file's name, else those the study states, else designs them; and
    /// checks that they may run. `path` stands for the study in messages.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the gains do not fit the robot or the loop, none can be designed, the motion needs
    /// more than the drives have or the arm's inertia is not inside of the gains' window (unless
    /// `uncertified`), or the study cannot be simulated.
    pub fn new(
        study: Box<Study>,
        path: &Path,
        gains: Option<(Gains, &Path)>,
        uncertified: bool,
    ) -> Result<Self, SessionError> {
        let gains = gains
            .map_or(GainsSource::Own, |(gains, file)| GainsSource::Given(Box::new(gains), file));
        Self::of(study, path, gains, uncertified)
    }

    /// Of gains from wherever.
    fn of(
        mut study: Box<Study>,
        path: &Path,
        gains: GainsSource<'_>,
        uncertified: bool,
    ) -> Result<Self, SessionError> {
        let overload = beyond_drives(&study, path, uncertified)?;
        let arm = design::arm(&study, path)?;
        let mut command = format!("phihat run {}", path.display());
        let mut source = path;
        let before = matches!(gains, GainsSource::Before(_));
        let mut designs = requested_gains(&study).is_none();
        let chosen = match gains {
            GainsSource::Given(given, file) => {
                command = format!("{command} --gains {}", file.display());
                (source, designs) = (file, false);
                given
            }
            GainsSource::Before(designed) => designed,
            GainsSource::Own => own_gains(&study, &arm, path)?,
        };
        chosen.complete(&mut study).map_err(|e| SessionError::at(source, e))?;
        let law = chosen
            .joint_gains(&study.robot.joint_names(), study.control.period_ns, study.control.form)
            .map_err(|e| SessionError::at(source, e))?;
        let mut warnings = study.warnings();
        // Whoever runs what may not run is shown what comes of it.
        warnings.extend(overload);
        if let Some(why) = not_armed((&study, &arm, &chosen), source, uncertified)? {
            command += " --uncertified";
            warnings.push(why);
        }
        settle(&mut study, &chosen);
        watch_bound(&mut study, &chosen);
        let forecast = phihat_sim::forecast(&study).map_err(|e| SessionError::at(path, e))?;
        warnings.extend(forecast.into_iter().map(|line| format!("{FORECAST} {line}")));
        let simulation = Simulation::new(&study, &law).map_err(|e| SessionError::at(path, e))?;
        let simulation = Box::new(watched(simulation, (&study, &chosen), source, &mut warnings)?);
        let (gains, trace, log, designed_by) = (*chosen, TraceKind::default(), None, None);
        Ok(Self {
            study,
            gains,
            simulation,
            command,
            warnings,
            trace,
            log,
            designs,
            before,
            designed_by,
            bound: None,
        })
    }

    /// The same with its trace in a file of this kind.
    #[must_use]
    pub fn recorded_as(self, trace: TraceKind) -> Self {
        Self { trace, ..self }
    }

    /// Returns true if the gains are those that an earlier run of the same study left, designed by the same
    /// build of the program.
    pub fn designed_before(&self) -> bool {
        self.before
    }

    /// Warnings before the run.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The study as it is run, completed by its gains, and the gains.
    pub fn into_parts(self) -> (Box<Study>, Gains) {
        (self.study, self.gains)
    }

    /// The gains chosen.
    pub fn into_gains(self) -> Gains {
        self.gains
    }

    /// Runs the loop and leaves its record, with or without its page; the trace is written as it comes.
    /// Predicted violations of the robot's torque interface are reported before; no other process writes to
    /// the folder meanwhile.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: another process is at work in the folder, or a file cannot be written.
    pub fn simulate(
        self,
        folder: &Path,
        page: Option<&Path>,
        watch: &mut dyn Watch,
    ) -> Result<Done, SessionError> {
        let _held = Lock::take(folder)?;
        self.warn(watch);
        let mut trace = self.files(folder)?;
        watch.begun(&trace.prepared);
        let all = self.simulation.samples();
        let done = self.stream(
            BLOCK,
            |done| watch.progress(done, all),
            |block| -> Result<(), DiskError> { trace.block(block) },
        );
        watch.ended();
        let done = done?;
        watch.came_to(&done);
        done.leave(trace, folder, page, None)?;
        Ok(done)
    }

    /// Says before a run what the robot's torque interface will not bear, and what else is worth knowing before.
    pub(crate) fn warn(&self, watch: &mut dyn Watch) {
        self.study.renamed.iter().for_each(|key| watch.warn(&format!("warning: {key}")));
        self.study.unread_columns().for_each(|line| watch.warn(&format!("warning: {line}")));
        let told = |line: &&String| line.starts_with(FORECAST) || line.starts_with(JOINT_BY_JOINT);
        self.warnings.iter().filter(told).for_each(|line| watch.warn(line));
    }

    /// The files of the record on their way, in a folder that is locked.
    pub(crate) fn files(&self, folder: &Path) -> Result<TraceFiles, SessionError> {
        let files = TraceFiles::begin(folder, self.trace)?;
        match &self.log {
            Some(log) => files.logged(log, &self.study, &self.gains),
            None => Ok(files),
        }
    }

    /// Derives the bound on the error a second time, as [`verify`](crate::verify) does with the study, so that record
    /// and page have its standing. Takes seconds; `share` is called with the part that is done.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the gains are of another form than the study.
    pub fn derive_twice(&mut self, share: &(dyn Fn(f64) + Sync)) -> Result<(), SessionError> {
        self.bound = recorded_bound(&self.gains, &self.study, share)?;
        Ok(())
    }

    /// Runs the loop; `progress` is told how many samples are done. With every signal of every joint.
    pub fn run(self, progress: impl FnMut(u64)) -> (Done, Trace) {
        let mut whole = Trace::default();
        let take = |block: &mut Trace| -> Result<(), Infallible> {
            whole = std::mem::take(block);
            Ok(())
        };
        let Ok(done) = self.stream(usize::MAX, progress, take);
        (done, whole)
    }

    /// Runs the loop with every signal of every joint, and hands each part of so many samples over as it comes: what
    /// looks on need not wait for the end.
    pub fn run_in_parts(self, samples: usize, mut part: impl FnMut(&Trace)) -> (Done, Trace) {
        let mut whole = Trace::default();
        let take = |block: &mut Trace| -> Result<(), Infallible> {
            part(block);
            whole.extend(block);
            Ok(())
        };
        let Ok(done) = self.stream(samples, |_| (), take);
        (done, whole)
    }

    /// Runs the loop and keeps its figures alone.
    pub fn rehearse(self) -> Done {
        let Ok(done) = self.stream(BLOCK, |_| (), |_| Ok::<(), Infallible>(()));
        done
    }

    /// Runs the loop, every signal handed over in blocks of at most so many samples.
    fn stream<E>(
        self,
        block: usize,
        progress: impl FnMut(u64),
        mut each: impl FnMut(&mut Trace) -> Result<(), E>,
    ) -> Result<Done, E> {
        let Self { study, gains, simulation, command, warnings, designed_by, bound, .. } = self;
        let mut seen = RunObserver::new(&study, Some(&gains));
        let mut shares = error_shares(&study, &gains);
        let ended = simulation.stream(block, progress, |block| {
            if let Some(shares) = &mut shares {
                shares.fill(block);
            }
            seen.block(block);
            each(block)
        })?;
        let figures = seen.finish(&study.sha256);
        let mut done = finished((study, gains), figures, ended, (command, warnings));
        done.run.bound = bound;
        Ok(Done { designed_by, ..done })
    }
}

/// A run of phihat's law that ended so.
pub(crate) fn finished(
    (study, gains): (Box<Study>, Gains),
    figures: RunFigures,
    ended: Ended,
    (command, mut warnings): (String, Vec<String>),
) -> Done {
    let RunFigures { metrics, drawing, tube } = figures;
    warnings.extend(ended.abort.as_ref().map(words::stopped));
    let run = run_info(&study, form(&study), (command, warnings), ended.divergence.as_ref());
    let run = crate::contact::recorded(run, ended.contact);
    let (divergence, abort) = (ended.divergence, ended.abort);
    let (gains, designed_by) = (Some(gains), None);
    Done { study, gains, run, designed_by, drawing, metrics, tube, divergence, abort }
}

/// The form of phihat's law in a study, in one word.
pub(crate) fn form(study: &Study) -> &'static str {
    match study.control.form {
        Form::Observer => "observer",
        Form::Literal => "literal",
        Form::Positions => "positions",
    }
}

/// Why gains may not run on an arm, as a warning of a run that is uncertified.
#[inline(never)]
fn not_armed(
    (study, arm, gains): (&Study, &Arm, &Gains),
    source: &Path,
    uncertified: bool,
) -> Result<Option<String>, SessionError> {
    match arm_inside_window(study, arm, gains) {
        Err(why) if !uncertified => {
            let words = words::unstable(study, arm, gains, &why);
            let (path, why) = (source.to_owned(), Box::new(why));
            Err(SessionError::NotArmed { path, why, words })
        }
        held => Ok(held.err().map(|why| format!("run uncertified: {why}"))),
    }
}

/// Overload of the drives by a motion, as a warning of a run that is uncertified, else as an error.
#[inline(never)]
fn beyond_drives(
    study: &Study,
    path: &Path,
    uncertified: bool,
) -> Result<Option<String>, SessionError> {
    match phihat_sim::overload(study).map_err(|e| SessionError::at(path, e))? {
        Some(more) if !uncertified => Err(SessionError::at(path, more)),
        more => Ok(more.map(|more| format!("run uncertified: {more}"))),
    }
}

/// The gains that a study states, else designed ones.
#[inline(never)]
fn own_gains(study: &Study, arm: &Arm, path: &Path) -> Result<Box<Gains>, SessionError> {
    requested_gains(study).map_or_else(|| designed_gains(study, arm, path), Ok).map(Box::new)
}

/// Gains for a study that leaves them to the design.
#[inline(never)]
fn designed_gains(study: &Study, arm: &Arm, path: &Path) -> Result<Gains, SessionError> {
    let outcome = design::designed_beyond(study, arm, path)?;
    let (no, budget) = match outcome {
        Outcome::Designed(gains) => return Ok(*gains),
        Outcome::Infeasible(ref no) => {
            let budget = budget(study, arm, path, (&outcome, BudgetSearch::Nothing), &mut ())?;
            (Box::new(no.clone()), Some(Box::new(budget)))
        }
    };
    Err(SessionError::Infeasible { path: path.to_owned(), no, budget })
}

/// Origin of a run, under a law of this form.
pub(crate) fn run_info(
    study: &Study,
    form: &str,
    (command, mut warnings): (String, Vec<String>),
    divergence: Option<&Divergence>,
) -> RunInfo {
    if let Some(d) = divergence {
        let place =
            format!("the run diverged at t = {} s on joint {} and was stopped", d.t, d.joint);
        warnings.push(place);
    }
    RunInfo {
        study: study.name.clone(),
        title: study.title.clone(),
        study_sha256: study.sha256.clone(),
        seed: study.seed,
        robot: study.robot.name.clone(),
        robot_description: study.robot.description.clone(),
        robot_provenance: study.robot.provenance.clone(),
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        toolchain: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
        form: form.to_owned(),
        rate_hz: 1e9 / study.control.period_ns as f64,
        delay_samples: study.control.delay_samples,
        world: words::world(study),
        command,
        warnings,
        bound: None,
        contact: None,
    }
}
