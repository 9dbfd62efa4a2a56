//! `phihat drive`: a study's law in closed loop on whatever is at the other end of a link.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use clap::Args;
use phihat_drive::{
    Check, CheckName, DriveError, DriveOptions, Driven, End, On, Prepared, State, prepare,
};
use phihat_session::{Leave, RunOptions, how_to_recover};
use serde_json::json;

use crate::audit;
use crate::failure::Failure;
use crate::first_motion::{FirstMotionArguments, announced, verdict};
use crate::interrupt::StopRequest;
use crate::ros2::{Ros, counted};
use crate::run::{TraceOptions, document, show, write_layout};
use crate::shown::TerminalWatch;
use crate::terminal::PageOptions;

/// Drive an arm: checks first, then start, hold, track and finish, and the record of it.
///
/// At the other end is phihat's own world, in lock-step (`--on sim`: the trace is that of `phihat run`, bit
/// for bit) or by this machine's clock (`--real-time`); or a Franka (`--on fci://HOST`), or whatever speaks
/// its interface, such as `phihat serve`. Before anything moves, each of these has to pass, or to be accepted
/// by its name: certificate, window, motion, profile, supervisor, robot, description, real-time, rehearsal.
/// Ctrl-C is a safe stop; the record is written all the same.
///
/// Writes what `phihat run` writes, and drive.json: link, checks, losses, timing, and why it ended. If the
/// process is killed, the older record stays, and `phihat report --recover` makes a record of what was
/// driven, all but the last second at most; until then nothing is driven into that folder.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  phihat drive studies/first.toml --on sim --accept certificate\n  \
                        phihat drive studies/first.toml --on sim --first-motion --out first-motion"
)]
pub(crate) struct DriveVerb {
    /// The study file (TOML).
    study: PathBuf,
    /// Use these gains (a gains.json) in place of those the study states.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Follow the motion of this file in place of the study's (CSV: `t_s` and every joint's name, rad), to
    /// its last sample.
    #[arg(long, value_name = "FILE", conflicts_with = "first_motion")]
    reference: Option<PathBuf>,
    /// What is at the other end: `sim`, phihat's own world, or a Franka: `fci://HOST`, with `:PORT` and
    /// `?protocol=5` if need be.
    #[arg(long, value_name = "LINK", default_value = "sim")]
    on: String,
    /// Keep to this machine's clock.
    #[arg(long)]
    real_time: bool,
    /// Go on in spite of a check that does not pass; recorded. May be given several times.
    #[arg(long, value_name = "CHECK")]
    accept: Vec<String>,
    /// Run the control thread on this processor.
    #[arg(long, value_name = "NUMBER", requires = "real_time")]
    processor: Option<usize>,
    /// Bring a robot back that stopped by itself, before the drive and after it.
    #[arg(long)]
    recover: bool,
    /// Folder for the results [default: out/STUDY].
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    #[command(flatten)]
    trace: TraceOptions,
    /// Write a log for ROS tools and viewers too (MCAP; builds with the feature `mcap`).
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Write how Foxglove or Lichtblick shows that log.
    #[arg(long, value_name = "FILE", requires = "mcap")]
    layout: Option<PathBuf>,
    #[command(flatten)]
    first: FirstMotionArguments,
    #[command(flatten)]
    ros: Ros,
    #[command(flatten)]
    page: PageOptions,
    /// Print one JSON document in place of the tables.
    #[arg(long)]
    json: bool,
}

const BAR: &str = "driving {wide_bar} {percent:>3} % · {elapsed} of about {duration}";

/// Stop request, set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

impl DriveVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let mut prepared = prepare(&self.options()?)?;
        if prepared.is_refused() {
            return Ok(self.refused(&prepared));
        }
        if !self.json {
            println!("{}\n{}", lines(&prepared.checks), prepared.bound.sentence);
            if let Some(rigid) = prepared.rigid_joints() {
                println!("{rigid}");
            }
            if let Some(told) = announced(&prepared) {
                println!("{told}");
            }
        }
        let first = prepared.first.clone().map(Box::new);
        let folder = prepared.folder.clone();
        let beside = self.ros.beside(&mut prepared)?;
        let driven = driven(prepared, &folder)?;
        let counts = beside.ended();
        write_layout(self.layout.as_deref(), &driven.done)?;
        let measured = first.map(|first| self.first.measured(&first, &folder)).transpose()?;
        let missing = measured.as_ref().is_some_and(|first| first.found.all().is_none());
        let page = folder.join("report.html");
        let audited = audit::after(&folder);
        if self.json {
            let mut all = document(&driven.done, &folder, Some(&page));
            all["drive"] = driven.document.clone();
            all["audit"] = json!(audited);
            if let Some(counts) = &counts {
                all["ros2"] = counts.clone();
            }
            if let Some(first) = &measured {
                all["first_motion"] = json!(first.found);
                all["first_motion_arm"] = json!(first.arm(&folder));
            }
            println!("{all:#}");
        } else {
            show(&driven.done, &folder, Some(&page));
            println!("{}", told(&driven));
            if let Some(counts) = &counts {
                println!("{}", counted(counts));
            }
            if let Some(first) = &measured {
                println!("{}", verdict(first, &folder));
            }
            if let Some(audited) = &audited {
                println!("{}", audit::lines(audited, false));
            }
        }
        self.page.show(&page);
        Ok(if driven.good() && !missing { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }

    fn options(&self) -> Result<DriveOptions, Failure> {
        let on = On::of(&self.on, self.real_time).map_err(Failure::plain)?;
        let accept = self.accept.iter().map(|word| {
            CheckName::of(word).ok_or_else(|| {
                let all: Vec<_> = CheckName::ALL.iter().map(|check| check.word()).collect();
                let all = all.join(", ");
                Failure::plain(format!("--accept {word}: there is no such check; there are {all}"))
            })
        });
        let run = RunOptions {
            study: self.study.clone(),
            gains: self.gains.clone(),
            out: self.out.clone(),
            trace: self.trace.kind(),
            log: self.mcap.clone(),
            ..RunOptions::default()
        };
        let accept = accept.collect::<Result<_, _>>()?;
        let first = self.first.asked()?;
        let (processor, recover) = (self.processor, self.recover);
        let reference = self.reference.clone();
        Ok(DriveOptions { run, on, accept, processor, recover, first, reference })
    }

    /// Tells why nothing moves.
    fn refused(&self, prepared: &Prepared) -> ExitCode {
        let why = DriveError::Refused(prepared.checks.clone()).to_string();
        if self.json {
            let all = json!({ "error": why, "exit_code": 2, "checks": prepared.checks });
            println!("{all:#}");
        }
        eprintln!("{}\nerror: {why}", lines(&prepared.checks));
        ExitCode::from(2)
    }
}

/// Drives, until it is over or a person stops it.
#[inline(never)]
fn driven(prepared: Prepared, folder: &Path) -> Result<Box<Driven>, Failure> {
    let page = folder.join("report.html");
    let asked = StopRequest { stop: &STOP, parks: prepared.parks() };
    let words = format!("no record was written; {}", how_to_recover(folder));
    let mut shown = TerminalWatch::stoppable(BAR, words, asked);
    let leave = Leave { folder, page: Some(&page) };
    Ok(Box::new(prepared.drive(leave, &mut shown, &STOP)?))
}

/// A line per check.
fn lines(checks: &[Check]) -> String {
    let line = |check: &Check| {
        let word = match check.state {
            State::Passed => "passed",
            State::Failed => "REFUSED:",
            State::Accepted => "accepted",
            State::NotAsked => "not asked",
        };
        let valid =
            check.valid.as_ref().map_or_else(String::new, |valid| format!("; valid: {valid}"));
        format!("{word:<9} {}: {}{valid}", check.name.word(), check.found)
    };
    checks.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Lines that only a drive has.
fn told(driven: &Driven) -> String {
    let mut lines: Vec<String> =
        driven.facts.iter().map(|(label, value)| format!("{label}: {value}")).collect();
    if driven.tally.tracked == 0 {
        lines.push("HELD: the arm never followed its motion".to_owned());
    }
    match driven.tally.end {
        End::Complete => {}
        End::Asked => lines.push("STOPPED by a person; the record ends there".to_owned()),
        End::Fault(why) => lines.push(format!("STOPPED: {why}")),
        End::Faulted => lines.push("STOPPED by the supervisor; the record ends there".to_owned()),
        End::Over | End::Unread => lines.push("the drive ended before the study did".to_owned()),
    }
    lines.join("\n")
}

impl From<DriveError> for Failure {
    fn from(why: DriveError) -> Self {
        match why {
            DriveError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}
