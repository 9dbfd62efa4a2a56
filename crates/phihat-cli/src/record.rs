//! One study being run, and what the run leaves in its folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use phihat_campaign::disk::{Lock, Whole};
use phihat_design::{Arm, Gains, Outcome, arm_inside_window, requested_gains};
use phihat_report::{Record, RunInfo, TubeRun, limits_acted};
use phihat_sim::{Abort, Divergence, Metrics, Simulation, Trace};
use phihat_study::{LawForm, Study};
use serde_json::json;

use crate::failure::Failure;
use crate::kept::{Origin, PARQUET, RUN, TRACE};
use crate::knowledge::Advice;
use crate::report::{add_page, remove_page};
use crate::{files, knowledge, table};

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
    /// Every signal of every joint.
    pub trace: Trace,
    /// The figures of the run.
    pub metrics: Metrics,
    /// Set when the run diverged and was stopped.
    pub divergence: Option<Divergence>,
    /// Set when the robot's torque interface stopped the run.
    pub abort: Option<Abort>,
}

impl RunArguments {
    /// Reads and checks everything; nothing is written before all of it fits.
    pub(crate) fn open(&self) -> Result<(Session, PathBuf), Failure> {
        let study = Box::new(Study::read(&self.study).map_err(|e| Failure::study(&e))?);
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

    /// Runs the loop behind a progress bar and leaves its record, with or without its page. What the robot's torque
    /// interface will not bear is said before; no other process writes to the folder meanwhile.
    pub(crate) fn simulate(self, folder: &Path, page: Option<&Path>) -> Result<Done, Failure> {
        let _held = Lock::take(folder).map_err(Failure::plain)?;
        self.warnings.iter().filter(|w| w.starts_with("forecast:")).for_each(|w| eprintln!("{w}"));
        let bar = ProgressBar::new(self.simulation.samples());
        if let Ok(style) = ProgressStyle::with_template(
            "simulating {wide_bar} {percent:>3} % · {elapsed} of about {duration}",
        ) {
            bar.set_style(style);
        }
        let done = self.run(|done| bar.set_position(done));
        bar.finish_and_clear();
        done.leave(folder, page)?;
        Ok(done)
    }

    /// Runs the loop; `progress` is told how many samples are done.
    pub fn run(self, progress: impl FnMut(u64)) -> Done {
        let outcome = self.simulation.run(progress);
        let metrics = Metrics::of(&outcome.trace, &self.study);
        let mut warnings = self.warnings;
        warnings.extend(outcome.abort.as_ref().map(table::abort));
        let run = run_info(&self.study, (self.command, warnings), outcome.divergence.as_ref());
        Done {
            study: self.study,
            gains: self.gains,
            run,
            trace: outcome.trace,
            metrics,
            divergence: outcome.divergence,
            abort: outcome.abort,
        }
    }
}

impl Done {
    /// The record that a report is made from.
    pub fn record(&self) -> Record<'_> {
        Record {
            run: &self.run,
            study_text: &self.study.text,
            gains: &self.gains,
            trace: &self.trace,
            metrics: &self.metrics,
        }
    }

    /// Writes trace, metrics, gains, origin and study into a folder: a whole record in place of an older one, whose page
    /// goes.
    ///
    /// # Errors
    ///
    /// [`Failure`], naming the file that cannot be written, or that another process is at work there.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        let _held = Lock::take(folder).map_err(Failure::plain)?;
        self.leave(folder, None)
    }

    /// The same in a folder that is locked, with a page.
    fn leave(&self, folder: &Path, page: Option<&Path>) -> Result<(), Failure> {
        let at = |name: &str| folder.join(name);
        let pretty = |value: &serde_json::Value| format!("{value:#}\n").into_bytes();
        let mut whole = Whole::in_locked_folder();
        let mut files = BTreeMap::new();
        let gains = self.gains.to_json().map_err(Failure::plain)?;
        for (name, bytes) in [
            ("study.toml", self.study.text.clone().into_bytes()),
            ("gains.json", gains.into_bytes()),
            ("metrics.json", pretty(&self.figures())),
        ] {
            let sum = whole.add(&at(name), &bytes).map_err(Failure::plain)?;
            files.insert(name.to_owned(), sum);
        }
        let sum = whole.add_with(&at(TRACE), |file| self.trace.write_csv(file));
        files.insert(TRACE.to_owned(), sum.map_err(Failure::plain)?);
        #[cfg(feature = "parquet")]
        {
            let sum = whole.add_with(&at(PARQUET), |file| self.trace.write_parquet(file));
            files.insert(PARQUET.to_owned(), sum.map_err(Failure::plain)?);
        }
        // One that an older run left would stand beside a trace that is not its own.
        #[cfg(not(feature = "parquet"))]
        whole.remove(at(PARQUET));
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
        let mut figures = json!(self.metrics);
        if let Some(run) = self.tube() {
            figures["tube"] = json!(run);
        }
        figures
    }

    /// The run beside the tube that its gains carry.
    pub fn tube(&self) -> Option<TubeRun> {
        TubeRun::of(&self.record())
    }

    /// Whether the run came to its end, kept every bound, and no promise about it is broken.
    pub fn good(&self) -> bool {
        let ended = self.divergence.is_none() && self.abort.is_none();
        ended && self.metrics.within_spec && self.tube().is_none_or(|run| run.broken().is_none())
    }

    /// The verdict as one word.
    fn verdict(&self) -> &'static str {
        if self.tube().is_some_and(|run| run.broken().is_some()) {
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
            if let Some(run) = self.tube() {
                println!("{}", table::tube(&run));
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

/// The steady part begins when the certificate of this study says, where the study does not say it.
pub(crate) fn settle(study: &mut Study, gains: &Gains) {
    let certificate = gains.certificate.as_ref().filter(|_| gains.study_sha256 == study.sha256);
    let found = certificate.and_then(|certificate| certificate.settle);
    if let Some(found) = found.filter(|_| !study.spec.settle_stated) {
        study.spec.settle = found.settle_s;
    }
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
