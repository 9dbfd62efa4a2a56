//! `phihat studio`: a study under control, live, in a browser.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;

/// See a study's arm under control, live, in a browser.
///
/// A page of this machine shows the simulated arm in real time: drag a joint to push it, drop and pick up a
/// payload, add friction, noise, losses and faults, change gains and the error that is wished and see what is
/// certified of them, edit the study, save what came as one that `phihat run` repeats; run another law beside
/// phihat's. Or play what was recorded, with --replay. It listens on this machine alone, reads and writes
/// nothing outside of the folder that it is started in, and ends with Ctrl-C. It never talks to a robot. In
/// builds with the feature `studio`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example (then open the address that it prints):\n  phihat studio studies/first.toml"
)]
pub(crate) struct StudioVerb {
    /// The study file (TOML); with --replay of a record's folder it is not needed.
    #[arg(required_unless_present = "replay")]
    study: Option<PathBuf>,
    /// Play what was recorded: the folder of a run or a drive, or a log (MCAP) with /joint_states of the study's arm.
    #[arg(long, value_name = "RECORD", conflicts_with = "gains")]
    replay: Option<PathBuf>,
    /// Use these gains (a gains.json) in place of those the study states.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// TCP port on this machine; 0 is any that is free, and is told.
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Open the page in the browser.
    #[arg(long)]
    open: bool,
    /// Print one JSON document: where it listens.
    #[arg(long)]
    json: bool,
}

impl StudioVerb {
    #[cfg(feature = "studio")]
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let options = phihat_studio::StudioOptions {
            study: self.study.clone(),
            gains: self.gains.clone(),
            replay: self.replay.clone(),
            folder: PathBuf::from("."),
            port: self.port,
        };
        let studio = options.open()?;
        let link = studio.link();
        if self.json {
            let document = serde_json::json!({
                "study": studio.study(),
                "listening": studio.address().to_string(),
                "open": link,
            });
            println!("{document}");
        } else {
            for warning in studio.warnings() {
                eprintln!("warning: {warning}");
            }
            println!("{} is live at {link} (this machine only; Ctrl-C ends it)", studio.study());
        }
        if self.open
            && let Err(why) = open::that_detached(&link)
        {
            eprintln!("warning: no browser can be opened here: {why}");
        }
        studio.serve()?;
        Ok(ExitCode::SUCCESS)
    }

    #[cfg(not(feature = "studio"))]
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let Self { study, replay, gains: _, port: _, open: _, json: _ } = self;
        let what = study
            .as_ref()
            .or(replay.as_ref())
            .map_or(String::new(), |path| format!(" of {}", path.display()));
        Err(Failure::plain(format!(
            "no studio{what}: this phihat is built with --no-default-features; in a clone: cargo phihat studio"
        )))
    }
}
