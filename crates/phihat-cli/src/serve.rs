//! `phihat serve`: a study's world behind a robot's interface.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use indicatif::ProgressBar;
use phihat_fci::{Event, PORT, Pace};
use phihat_session::{ServeOptions, ServeWatch, ServedMotion};
use serde_json::json;

use crate::failure::Failure;
use crate::interrupt;
use crate::run::TraceOptions;

/// Serve a study's world as a Franka, to any program made for one.
///
/// A client of libfranka (protocol 5: 0.9; protocol 10: 0.18 and later) connects, and tells the study's arm
/// its torques. Each motion begins the study's world anew, at its start, and leaves trace.parquet,
/// metrics.json, run.json and report.html in out/STUDY/ when it ends; the trace is written as it comes, so
/// that memory does not grow with a motion's length. The robot stops as one does: on a torque that jumps, on
/// a joint that is too fast, on commands that stay away, by the study's profile and the arm's own limits. In
/// lock-step, the next state comes when the command for the last one came: the same torques give the same
/// trace, bit for bit, however slow the client is.
#[derive(Debug, Args)]
#[command(after_help = "Example (then run your program with the robot's address 127.0.0.1):\n  \
                        phihat serve studies/franka.toml --fci")]
pub(crate) struct ServeVerb {
    /// The study file (TOML), of an arm of seven joints at 1 kHz.
    study: PathBuf,
    /// Speak the Franka Control Interface.
    #[arg(long, required = true)]
    fci: bool,
    /// TCP port; 0 is any that is free, and is told.
    #[arg(long, value_name = "N", default_value_t = PORT)]
    port: u16,
    /// Address to listen on. Who can reach it can move the simulated arm.
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    listen: IpAddr,
    #[command(flatten)]
    time: Time,
    /// In lock-step: how long a command may take before it counts as lost.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 500,
        value_parser = clap::value_parser!(u64).range(1..=3_600_000))]
    patience_ms: u64,
    /// End after so many cycles of motion.
    #[arg(long, value_name = "N")]
    cycles: Option<u64>,
    /// Folder for the results [default: out/STUDY].
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    #[command(flatten)]
    trace: TraceOptions,
    /// Print a JSON document per line: where it listens, who comes, how each motion ended.
    #[arg(long)]
    json: bool,
}

/// Who makes time go on.
#[derive(Debug, Args)]
struct Time {
    /// The client makes time go on [default].
    #[arg(long, conflicts_with = "real_time")]
    lockstep: bool,
    /// The clock makes time go on: a state per millisecond, and what comes late is lost.
    #[arg(long)]
    real_time: bool,
}

impl ServeVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let real_time = self.time.real_time && !self.time.lockstep;
        let pace = if real_time {
            Pace::RealTime
        } else {
            Pace::LockStep { patience: Duration::from_millis(self.patience_ms) }
        };
        let options = ServeOptions {
            study: self.study.clone(),
            out: self.out.clone(),
            listen: self.listen,
            port: self.port,
            trace: self.trace.kind(),
            pace,
            cycles: self.cycles,
        };
        let mut serve = options.open()?;
        let (address, study) = (serve.address(), &serve.study().name);
        let who = if address.ip().is_loopback() {
            "this machine only"
        } else {
            "whoever reaches it moves the simulated arm"
        };
        let pace = if real_time { "real-time" } else { "lock-step" };
        if self.json {
            let document = json!({
                "listening": address.to_string(),
                "study": study,
                "protocols": [5, 10],
                "pace": pace,
                "loopback": address.ip().is_loopback(),
            });
            println!("{document}");
        } else {
            println!("{study} listens on {address} ({who}): protocols 5 and 10, {pace}");
        }
        let mut told = ServeLines { json: self.json, good: true };
        serve.run(&mut told)?;
        Ok(if told.good { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}

/// Tells what happens, a line each.
struct ServeLines {
    json: bool,
    /// True if the last motion was within spec.
    good: bool,
}

impl ServeLines {
    fn line(&self, document: &serde_json::Value, words: &str) {
        if self.json {
            println!("{document}");
        } else {
            println!("{words}");
        }
    }
}

impl ServeWatch for ServeLines {
    fn event(&mut self, event: Event) {
        match event {
            Event::Connected(from, protocol) => {
                let version = protocol.version();
                let document = json!({ "connected": from.to_string(), "protocol": version });
                self.line(&document, &format!("connected: {from}, protocol {version}"));
            }
            Event::Refused(from) => {
                let document = json!({ "refused": from.to_string() });
                self.line(&document, &format!("refused: {from}, since another client is served"));
            }
            Event::HungUp(why) => {
                let document = json!({ "hung_up": why.to_string() });
                self.line(&document, &format!("hung up: the client sent {why}"));
            }
            Event::Gone => self.line(&json!({ "gone": true }), "the client is gone"),
            other => self.line(&json!({ "event": format!("{other:?}") }), &format!("{other:?}")),
        }
    }

    fn begun(&mut self, unfinished: &[PathBuf]) {
        let words = "nothing is left of the motion that was going on".to_owned();
        interrupt::removes(&ProgressBar::hidden(), words, unfinished.to_owned(), None);
    }

    fn motion(&mut self, motion: &ServedMotion) {
        interrupt::done();
        let ServedMotion { ending, cycles, packets, record } = motion;
        let page = record.as_ref().map(|(_, page)| page);
        let verdict = record.as_ref().map(|(done, _)| done.verdict());
        self.good = record.as_ref().is_none_or(|(done, _)| done.good());
        let document = json!({
            "motion": ending.to_string(),
            "cycles": cycles,
            "verdict": verdict,
            "report": page,
            "packets": {
                "taken": packets.taken,
                "late": packets.late,
                "twice": packets.twice,
                "malformed": packets.malformed,
                "unasked": packets.unasked,
                "lost": packets.lost,
            },
        });
        let left = page.map_or_else(String::new, |page| format!(", report: {}", page.display()));
        let lost = packets.lost;
        self.line(
            &document,
            &format!("motion of {cycles} cycles ({lost} lost so far): {ending}{left}"),
        );
    }
}
