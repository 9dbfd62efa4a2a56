//! One study being run, and what the run leaves in its folder.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{fs, io};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use phihat_campaign::disk::{DiskError, Lock, Piece, Whole};
use phihat_design::{Arm, Gains, Outcome, arm_inside_window, requested_gains};
use phihat_report::{Drawing, Record, RunInfo, TubeRun, TubeSeen, limits_acted};
use phihat_sim::{Abort, BLOCK, Divergence, Measured, Metrics, Simulation, Trace, TraceWriter};
use phihat_study::{LawForm, Study};
use serde_json::json;

use crate::failure::Failure;
use crate::kept::{INPUTS, Origin, PARQUET, RUN, TRACE};
use crate::knowledge::Advice;
use crate::report::{add_page, remove_page};
use crate::{files, interrupt, knowledge, table};

/// What `run` and `simulate` are told.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// The study file (TOML).
    study: PathBuf,
    /// Use these gains (a gains.json) in place of those the study states.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Folder for the results [default: out/STUDY].
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Run gains even where the arm's inertia is not inside their window; marked in the record.
    #[arg(long)]
    uncertified: bool,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// A study and its gains, ready to run.
#[derive(Debug)]
pub struct Session {
    study: Box<Study>,
    gains: Gains,
    simulation: Box<Simulation>,
    command: String,
    warnings: Vec<String>,
}

/// A finished run.
#[derive(Debug)]
pub struct Done {
    /// What was run.
    pub study: Box<Study>,
    /// The gains that ran.
    pub gains: Gains,
    /// Where the run came from.
    pub run: RunInfo,
    /// What is drawn of it.
    pub drawing: Drawing,
    /// The figures of the run.
    pub metrics: Metrics,
    /// The run beside the tube that its gains carry.
    pub tube: Option<TubeRun>,
    /// Set when the run diverged and was stopped.
    pub divergence: Option<Divergence>,
    /// Set when the robot's torque interface stopped the run.
    pub abort: Option<Abort>,
}

impl RunArguments {
    /// Reads and checks everything; nothing is written before all of it fits.
    pub(crate) fn open(&self) -> Result<(Session, PathBuf), Failure> {
        let study = knowledge::read(&self.study)?;
        let gains = match &self.gains {
            Some(file) => {
                let gains = Gains::from_json(&files::read(file)?);
                Some((gains.map_err(|e| Failure::at(file, e))?, file.as_path()))
            }
            None => None,
        };
        let default = || Path::new("out").join(&study.name);
        let folder = self.out.clone().unwrap_or_else(default);
        Ok((Session::new(study, &self.study, gains, self.uncertified)?, folder))
    }
}

impl Session {
    /// Takes the gains given, with their file's name, else those the study states, else designs them; and
    /// checks that they may run. `path` stands for the study in messages.
    ///
    /// # Errors
    ///
    /// [`Failure`]: the gains do not fit the robot or the loop, none can be designed, the arm's inertia is
    /// not inside of their window (unless `uncertified`), or the study cannot be simulated.
    pub fn new(
        mut study: Box<Study>,
        path: &Path,
        gains: Option<(Gains, &Path)>,
        uncertified: bool,
    ) -> Result<Self, Failure> {
        let arm = knowledge::arm(&study, path)?;
        let mut command = format!("phihat run {}", path.display());
        let mut source = path;
        let chosen = match (gains, requested_gains(&study)) {
            (Some((given, file)), _) => {
                command = format!("{command} --gains {}", file.display());
                source = file;
                given
            }
            (None, Some(stated)) => stated,
            (None, None) => designed_gains(&study, &arm, path)?,
        };
        chosen.give_filter(&mut study).map_err(|e| Failure::at(source, e))?;
        let law = chosen
            .joint_gains(
                &knowledge::names(&study),
                study.control.period_ns,
                knowledge::form(&study),
            )
            .map_err(|e| Failure::at(source, e))?;
        let mut warnings = study.robot.warnings.clone();
        if let Err(why) = arm_inside_window(&study, &arm, &chosen) {
            if !uncertified {
                let help = "a run with --uncertified shows what happens, and is marked";
                return Err(Failure::at(source, format!("not armed: {why}\n  = help: {help}")));
            }
            command += " --uncertified";
            warnings.push(format!("run uncertified: {why}"));
        }
        settle(&mut study, &chosen);
        let forecast = phihat_sim::forecast(&study).map_err(|e| Failure::at(path, e))?;
        warnings.extend(forecast.into_iter().map(|line| format!("forecast: {line}")));
        let simulation = Simulation::new(&study, &law).map_err(|e| Failure::at(path, e))?;
        let simulation = Box::new(simulation);
        Ok(Self { study, gains: chosen, simulation, command, warnings })
    }

    /// The gains chosen.
    pub(crate) fn into_gains(self) -> Gains {
        self.gains
    }

    /// Runs the loop behind a progress bar and leaves its record, with or without its page; the trace is written as it
    /// comes. What the robot's torque interface will not bear is said before; no other process writes to the folder
    /// meanwhile.
    pub(crate) fn simulate(self, folder: &Path, page: Option<&Path>) -> Result<Done, Failure> {
        let _held = Lock::take(folder).map_err(Failure::plain)?;
        self.warnings.iter().filter(|w| w.starts_with("forecast:")).for_each(|w| eprintln!("{w}"));
        let bar = ProgressBar::new(self.simulation.samples());
        if let Ok(style) = ProgressStyle::with_template(
            "simulating {wide_bar} {percent:>3} % · {elapsed} of about {duration}",
        ) {
            bar.set_style(style);
        }
        let mut trace = TraceFiles::begin(folder).map_err(Failure::plain)?;
        let words = "nothing was written, and what was there is as it was".to_owned();
        interrupt::removes(&bar, words, trace.prepared.clone());
        let done = self.stream(BLOCK, |done| bar.set_position(done), |block| trace.block(block));
        interrupt::done();
        bar.finish_and_clear();
        let done = done.map_err(Failure::plain)?;
        done.leave(trace, folder, page)?;
        Ok(done)
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

    /// The same, every signal handed over in blocks of at most so many samples.
    fn stream<E>(
        self,
        block: usize,
        progress: impl FnMut(u64),
        mut each: impl FnMut(&mut Trace) -> Result<(), E>,
    ) -> Result<Done, E> {
        let Self { study, gains, simulation, command, mut warnings } = self;
        let mut seen = Seen::new(&study, &gains);
        let ended = simulation.stream(block, progress, |block| {
            seen.block(block);
            each(block)
        })?;
        let Looked { metrics, drawing, tube } = seen.finish(&study.sha256);
        warnings.extend(ended.abort.as_ref().map(table::abort));
        let run = run_info(&study, (command, warnings), ended.divergence.as_ref());
        let (divergence, abort) = (ended.divergence, ended.abort);
        Ok(Done { study, gains, run, drawing, metrics, tube, divergence, abort })
    }
}

/// What is looked at while a record goes by.
pub(crate) struct Seen<'a> {
    measured: Measured,
    drawing: Drawing,
    tube: Option<TubeSeen<'a>>,
}

/// What came of it.
pub(crate) struct Looked {
    pub(crate) metrics: Metrics,
    pub(crate) drawing: Drawing,
    pub(crate) tube: Option<TubeRun>,
}

impl<'a> Seen<'a> {
    pub(crate) fn new(study: &Study, gains: &'a Gains) -> Self {
        let names = knowledge::names(study);
        let period_ns = study.control.period_ns;
        let samples = phihat_sim::samples(study.duration, period_ns);
        Self {
            measured: Measured::new(study),
            tube: TubeSeen::new(gains, names.len()),
            drawing: Drawing::new(names, period_ns, samples, study.spec.settle),
        }
    }

    pub(crate) fn block(&mut self, trace: &Trace) {
        self.measured.block(trace);
        self.drawing.block(trace);
        if let Some(tube) = &mut self.tube {
            tube.block(trace);
        }
    }

    /// In a run of a study with this SHA-256.
    pub(crate) fn finish(self, study_sha256: &str) -> Looked {
        let Self { measured, drawing, tube } = self;
        let tube = tube.map(|tube| tube.run(study_sha256));
        Looked { metrics: measured.metrics(), drawing, tube }
    }
}

/// The trace of a run on its way to the disk.
struct TraceFiles {
    whole: Whole,
    /// Where they are prepared.
    prepared: Vec<PathBuf>,
    csv: TraceWriter<Piece>,
    csv_path: PathBuf,
    #[cfg(feature = "parquet")]
    parquet: phihat_sim::ParquetTrace<Piece>,
    #[cfg(feature = "parquet")]
    parquet_path: PathBuf,
}

impl TraceFiles {
    fn begin(folder: &Path) -> Result<Self, DiskError> {
        let (mut whole, mut prepared) = (Whole::in_locked_folder(), Vec::new());
        let mut begin = |path: &Path| {
            let piece = whole.begin(path)?;
            prepared.push(piece.prepared_at().to_owned());
            Ok(piece)
        };
        let csv_path = folder.join(TRACE);
        let csv = TraceWriter::new(begin(&csv_path)?);
        #[cfg(feature = "parquet")]
        let parquet_path = folder.join(PARQUET);
        #[cfg(feature = "parquet")]
        let parquet = phihat_sim::ParquetTrace::new(begin(&parquet_path)?)
            .map_err(|why| DiskError::untouched(&parquet_path, why))?;
        Ok(Self {
            whole,
            prepared,
            csv,
            csv_path,
            #[cfg(feature = "parquet")]
            parquet,
            #[cfg(feature = "parquet")]
            parquet_path,
        })
    }

    fn block(&mut self, trace: &Trace) -> Result<(), DiskError> {
        self.csv.block(trace).map_err(|why| DiskError::untouched(&self.csv_path, why))?;
        #[cfg(feature = "parquet")]
        self.parquet.block(trace).map_err(|why| DiskError::untouched(&self.parquet_path, why))?;
        Ok(())
    }

    /// The files, ready to be moved in, and the SHA-256 of each by its name.
    fn end(self) -> Result<(Whole, BTreeMap<String, String>), DiskError> {
        let mut whole = self.whole;
        let mut files = BTreeMap::new();
        let csv = self.csv.finish().map_err(|why| DiskError::untouched(&self.csv_path, why))?;
        files.insert(TRACE.to_owned(), whole.end(csv)?);
        #[cfg(feature = "parquet")]
        {
            let done = self.parquet.finish();
            let done = done.map_err(|why| DiskError::untouched(&self.parquet_path, why))?;
            files.insert(PARQUET.to_owned(), whole.end(done)?);
        }
        // One that an older run left would stand beside a trace that is not its own.
        #[cfg(not(feature = "parquet"))]
        whole.remove(self.csv_path.with_file_name(PARQUET));
        Ok((whole, files))
    }
}

impl Done {
    /// The record that a report is made from.
    pub fn record(&self) -> Record<'_> {
        Record {
            run: &self.run,
            study_text: &self.study.text,
            gains: &self.gains,
            drawing: &self.drawing,
            metrics: &self.metrics,
            tube: self.tube.as_ref(),
        }
    }

    /// Writes trace, metrics, gains, origin and study into a folder: a whole record in place of an older one, whose page
    /// goes.
    ///
    /// # Errors
    ///
    /// [`Failure`], naming the file that cannot be written, or that another process is at work there.
    pub fn write(&self, trace: &Trace, folder: &Path) -> Result<(), Failure> {
        let _held = Lock::take(folder).map_err(Failure::plain)?;
        let mut files = TraceFiles::begin(folder).map_err(Failure::plain)?;
        files.block(trace).map_err(Failure::plain)?;
        self.leave(files, folder, None)
    }

    /// The same in a folder that is locked, with a page, the trace being on its way.
    fn leave(&self, trace: TraceFiles, folder: &Path, page: Option<&Path>) -> Result<(), Failure> {
        let at = |name: &str| folder.join(name);
        let pretty = |value: &serde_json::Value| format!("{value:#}\n").into_bytes();
        let (mut whole, mut files) = trace.end().map_err(Failure::plain)?;
        let gains = self.gains.to_json().map_err(Failure::plain)?;
        for (name, bytes) in [
            ("study.toml", self.study.text.clone().into_bytes()),
            ("gains.json", gains.into_bytes()),
            ("metrics.json", pretty(&self.figures())),
        ] {
            let sum = whole.add(&at(name), &bytes).map_err(Failure::plain)?;
            files.insert(name.to_owned(), sum);
        }
        let inputs = at(INPUTS);
        for older in files_below(&inputs) {
            whole.remove(older);
        }
        for (name, path) in &self.study.inputs {
            let mut input = files::open(path)?;
            let sum =
                whole.add_with(&inputs.join(name), |file| io::copy(&mut input, file).map(drop));
            let name = Path::new(INPUTS).join(name).display().to_string();
            files.insert(name, sum.map_err(Failure::plain)?);
        }
        match page {
            Some(page) => add_page(&mut whole, &self.record(), page)?,
            None => remove_page(&mut whole, &at("report.html")),
        }
        let origin = Origin { run: self.run.clone(), files };
        whole.add(&at(RUN), &pretty(&json!(origin))).map_err(Failure::plain)?;
        whole.commit().map_err(Failure::plain)
    }

    /// The figures of the run: its metrics, and under `tube` the run beside the tube that its gains carry.
    pub fn figures(&self) -> serde_json::Value {
        figures(&self.metrics, self.tube.as_ref())
    }

    /// Whether the run came to its end, kept every bound, and no promise about it is broken.
    pub fn good(&self) -> bool {
        let ended = self.divergence.is_none() && self.abort.is_none();
        ended
            && self.metrics.within_spec
            && self.tube.as_ref().is_none_or(|run| run.broken().is_none())
    }

    /// The verdict as one word.
    fn verdict(&self) -> &'static str {
        if self.tube.as_ref().is_some_and(|run| run.broken().is_some()) {
            "certificate_broken"
        } else if self.divergence.is_some() {
            "diverged"
        } else if self.abort.is_some() {
            "stopped"
        } else if !self.metrics.within_spec {
            "outside_spec"
        } else if self.metrics.limited_steady_share > 0.0 {
            "within_spec_limited"
        } else {
            "within_spec"
        }
    }

    /// Tells what came out; the exit code says whether it is within spec.
    pub(crate) fn print(&self, as_json: bool, folder: &Path, report: Option<&Path>) -> ExitCode {
        let diverged = self.divergence.as_ref().map(|d| json!({ "t_s": d.t, "joint": d.joint }));
        let stopped = self.abort.as_ref().map(|a| {
            json!({ "t_s": a.t, "interface": a.interface, "joint": a.joint, "reason": a.reason })
        });
        if as_json {
            let document = json!({
                "study": self.study.name,
                "folder": folder,
                "report": report,
                "diverged": diverged,
                "stopped": stopped,
                "verdict": self.verdict(),
                "limited": limits_acted(&self.metrics),
                "metrics": self.figures(),
            });
            println!("{document:#}");
        } else {
            println!("{} · {}", self.study.name, self.study.title);
            println!("{}", table::metrics(&self.metrics));
            if let Some(run) = &self.tube {
                println!("{}", table::tube(run));
            }
            match &self.abort {
                Some(abort) => println!("{}", table::abort(abort)),
                None => println!("{}", table::verdict(&self.metrics, self.divergence.as_ref())),
            }
            match report {
                Some(page) => println!("report: {}", page.display()),
                None => println!("trace: {}", folder.join("trace.csv").display()),
            }
        }
        if self.good() { ExitCode::SUCCESS } else { ExitCode::from(1) }
    }
}

/// What metrics.json says.
pub(crate) fn figures(metrics: &Metrics, tube: Option<&TubeRun>) -> serde_json::Value {
    let mut figures = json!(metrics);
    if let Some(run) = tube {
        figures["tube"] = json!(run);
    }
    figures
}

/// The steady part begins when the certificate of this study says, where the study does not say it.
pub(crate) fn settle(study: &mut Study, gains: &Gains) {
    let certificate = gains.certificate.as_ref().filter(|_| gains.study_sha256 == study.sha256);
    let found = certificate.and_then(|certificate| certificate.settle);
    if let Some(found) = found.filter(|_| !study.spec.settle_stated) {
        study.spec.settle = found.settle_s;
    }
}

/// Files of a folder and those below it; none where it cannot be read.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let below = |path: PathBuf| if path.is_dir() { files_below(&path) } else { vec![path] };
    entries.flat_map(|entry| below(entry.path())).collect()
}

/// Gains for a study that leaves them to the design.
fn designed_gains(study: &Study, arm: &Arm, path: &Path) -> Result<Gains, Failure> {
    match knowledge::designed(study, arm, path, Advice::Changes)? {
        Outcome::Designed(gains) => Ok(*gains),
        Outcome::Infeasible(no) => Err(Failure::at(path, table::infeasible(&no)).infeasible()),
        _ => Err(Failure::plain("an outcome that this version does not know")),
    }
}

fn run_info(
    study: &Study,
    (command, mut warnings): (String, Vec<String>),
    divergence: Option<&Divergence>,
) -> RunInfo {
    let form = match study.control.form {
        LawForm::Observer => "observer",
        LawForm::Literal => "literal",
    };
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
        world: table::world(study),
        command,
        warnings,
    }
}
