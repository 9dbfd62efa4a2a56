//! `phihat realtime`: how well this machine keeps time, and what to change.

use std::process::ExitCode;

use clap::Args;
use phihat_drive::{Finding, Machine, MachineOptions};
use serde_json::json;

use crate::failure::Failure;

/// Measure how well this machine keeps time for a control loop, and say what to change.
///
/// Looks at the kernel (PREEMPT_RT), at what this user may have of the scheduler (FIFO) and of memory
/// (locked), and at the processor's frequency; then sleeps until absolute times at the loop's rate, and
/// measures how late it wakes. Linux only.
///
/// The exit code is 0 whatever was found: what to change is told. `phihat drive` refuses where it matters.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat realtime --seconds 1")]
pub(crate) struct Realtime {
    /// Rate of the loop.
    #[arg(long, value_name = "HERTZ", default_value_t = 1000.0)]
    rate_hz: f64,
    /// How long to measure.
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0)]
    seconds: f64,
    /// Measure on this processor.
    #[arg(long, value_name = "NUMBER")]
    processor: Option<usize>,
    /// Print one JSON document in place of lines.
    #[arg(long)]
    json: bool,
}

impl Realtime {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        for (option, value, least, most) in [
            ("--rate-hz", self.rate_hz, 1.0, 100_000.0),
            ("--seconds", self.seconds, 0.01, 86_400.0),
        ] {
            if !(least..=most).contains(&value) {
                return Err(Failure::plain(format!(
                    "{option} {value}: {least} to {most} is valid"
                )));
            }
        }
        let (rate_hz, seconds, processor) = (self.rate_hz, self.seconds, self.processor);
        let options = MachineOptions { rate_hz, seconds, processor };
        let machine = Machine::measure(&options).map_err(Failure::plain)?;
        if self.json {
            println!("{:#}", json!({ "good": machine.is_good(), "machine": machine }));
            return Ok(ExitCode::SUCCESS);
        }
        for finding in &machine.findings {
            println!("{}", line(finding));
        }
        let verdict = if machine.is_good() { "sound" } else { "not sound: see `change`" };
        println!("{} wake-ups at {} Hz: {verdict}", machine.samples, machine.rate_hz);
        Ok(ExitCode::SUCCESS)
    }
}

fn line(finding: &Finding) -> String {
    let word = if finding.good { "good" } else { "change" };
    let change = finding.change.as_ref().map_or_else(String::new, |change| format!(" → {change}"));
    format!("{word:<6} {}: {}{change}", finding.what, finding.found)
}
