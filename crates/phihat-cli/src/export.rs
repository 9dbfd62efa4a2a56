//! `phihat export`: gains for controllers that people already run.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use phihat_design::export::{Target, export};
use serde_json::json;

use phihat_session::{files, read_gains};

use crate::failure::Failure;

/// Write gains for ROS 2, C or a table, with what the target lacks and what is claimed of it instead.
///
/// Gains of order 1 are PIDs; ROS 2 takes no others. A certificate is checked before anything is written.
#[derive(Debug, Args)]
#[command(after_help = "Example (after `phihat design studies/panda_design.toml`):\n  \
                        phihat export out/panda_design/gains.json --format c-header --out gains.h")]
pub(crate) struct Export {
    /// The gains document (JSON).
    gains: PathBuf,
    /// What to write.
    #[arg(long, value_enum)]
    format: Format,
    /// The file to write [default: the terminal].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document: the file's name, or its text where none is named.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// Parameters (YAML) of joint_trajectory_controller with effort commands.
    Ros,
    /// Constants for C99 and C++, any order.
    CHeader,
    /// A table, one row per joint, any order.
    Csv,
}

impl Export {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let gains = read_gains(&self.gains)?;
        let target = match self.format {
            Format::Ros => Target::Ros,
            Format::CHeader => Target::CHeader,
            Format::Csv => Target::Csv,
        };
        let exported = export(&gains, target).map_err(|e| Failure::at(&self.gains, e))?;
        let certified = gains.certificate.is_some();
        if let Some(file) = &self.out {
            files::write(file, &exported)?;
            if self.json {
                println!("{:#}", json!({ "file": file, "certified": certified }));
            } else {
                println!("exported: {}", file.display());
            }
        } else if self.json {
            println!("{:#}", json!({ "text": exported, "certified": certified }));
        } else {
            print!("{exported}");
        }
        Ok(ExitCode::SUCCESS)
    }
}
