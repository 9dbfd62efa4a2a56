//! `phihat bound`: a motion beside the class of motions of a certificate.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_design::Gains;
use phihat_session::{MotionBound, MotionClause};
use serde_json::json;

use crate::failure::Failure;
use crate::table::motion;

/// Exit code of a motion that is outside the class.
const OUTSIDE: u8 = 1;

/// Compare a motion with the class of motions that gains are certified for: is it inside, what bounds its error, and
/// if it is outside, by how much to slow it down.
///
/// The motion is a CSV file with `t_s` and every joint's name (rad), as of a planner: a natural cubic spline joins its
/// samples, as everywhere in phihat. Position, speed, acceleration and jerk are compared at every instant; it has to
/// begin and end at rest. With --study the bound for this motion alone is derived, too, from its own postures, speeds
/// and accelerations: it is less than that of the class.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 inside the class · 1 outside; the factor on its times that brings it inside is told ·\n\
                        2 a file cannot be used, or the gains bound no class of motions.\n\n\
                        Example (after `phihat design studies/franka_any.toml`):\n  \
                        phihat bound motion.csv --gains out/franka_any/gains.json --study studies/franka_any.toml"
)]
pub(crate) struct BoundMotion {
    /// The motion (CSV: `t_s` and every joint's name, rad).
    motion: PathBuf,
    /// The gains document (JSON) with a bound for a class of motions.
    #[arg(long, value_name = "FILE")]
    gains: PathBuf,
    /// The study that the gains are for: derive the bound for this motion alone, too.
    #[arg(long, value_name = "STUDY")]
    study: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

impl BoundMotion {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let (found, gains) =
            MotionBound::of_files(&self.motion, &self.gains, self.study.as_deref())?;
        if self.json {
            println!("{:#}", json!(found));
        } else {
            println!("{}\n{}", motion::table(&found, &gains), sentences(&found, &gains));
        }
        Ok(if found.inside { ExitCode::SUCCESS } else { ExitCode::from(OUTSIDE) })
    }
}

/// The answer in sentences.
fn sentences(found: &MotionBound, gains: &Gains) -> String {
    let (joint, clause) = &found.worst;
    let nearest = words(joint, clause, gains);
    if found.inside {
        let mut lines = vec![format!("INSIDE the class; nearest to a limit: {nearest}")];
        lines.extend(motion::bounds(found, gains));
        return lines.join("\n");
    }
    let slower = match found.slow_down {
        Some(factor) => format!(
            "{factor:.4} times as slow (all times times that) it is inside: {:.3} s in place of {:.3} s",
            factor * found.duration_s,
            found.duration_s
        ),
        None => "no slower run of it is inside: its positions, or a speed at its begin or its end, are in the way"
            .to_owned(),
    };
    format!("OUTSIDE the class: {nearest}\n{slower}")
}

/// A limit beside the motion's value.
fn words(joint: &str, clause: &MotionClause, gains: &Gains) -> String {
    let MotionClause { quantity, value, limit, share, at_s } = clause;
    let unit = motion::unit(quantity, gains.slides(joint));
    let (value, limit) = (motion::shown(*value), motion::shown(*limit));
    let percent = 100.0 * share;
    format!("{quantity} of {joint}, {value} of {limit} {unit} ({percent:.0} %) at t = {at_s:.3} s")
}
