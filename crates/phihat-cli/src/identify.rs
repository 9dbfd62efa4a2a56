//! `phihat identify`: what a record of a real arm shows of its joints.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_design::DryFriction;
use phihat_session::{
    Identification, IdentifiedJoint, IdentifyOptions, UndeterminedJoint, files, identify,
};
use serde_json::json;

use crate::failure::Failure;
use crate::table;

/// Find inertia and unknown torque of each joint in records of a real arm.
///
/// A record is a table (CSV or Parquet) with a row per sample and joint: `t_s`, `joint`, `q_rad`, `tau_nm`,
/// the torque that acted from this sample to the next; other columns are left alone, so the trace of a run,
/// or its folder, serves too. Each joint has to move with two sines at least, of different frequencies, and
/// differently from the others. Several records, in other postures and with other loads, are taken together:
/// an interval contains those of all records that determine it.
///
/// An interval of inertia explains every sample of its record: with the largest torque that is left
/// unexplained taken as if it were inertia, and the encoder's noise as if it were acceleration. A joint whose
/// inertia, gravity and friction cannot be distinguished in any record gets no interval, but the motion that
/// would do. An estimate, not a proof: postures and loads that no record visits are not in it. Prints a table,
/// and the `[[joint]]` sections of a study.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 every joint has an interval · 1 at least one has none; the others have · 2 error.\n\n\
                        Example (after `phihat run studies/first.toml`):\n  \
                        phihat identify out/first --from 1"
)]
pub(crate) struct Identify {
    /// The records: CSV, Parquet, or folders of runs.
    #[arg(required = true)]
    records: Vec<PathBuf>,
    /// Seconds left out at the beginning of each record.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    from: f64,
    /// Width of the boxes that positions are differenced over: wider for coarser encoders, narrower for faster motions.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 10.0)]
    width_ms: f64,
    /// What sizes and rates of φ are multiplied by: no record holds the worst that will come.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.5)]
    margin: f64,
    /// Joints that slide, separated by commas: their positions are in m, their torques forces in N.
    #[arg(long, value_name = "JOINT,…", value_delimiter = ',')]
    slides: Vec<String>,
    /// Where to write the `[[joint]]` sections [default: standard output].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of tables.
    #[arg(long)]
    json: bool,
}

impl Identify {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        for (option, value, least, most) in [
            ("--from", self.from, 0.0, 86_400.0),
            ("--width-ms", self.width_ms, 0.01, 1000.0),
            ("--margin", self.margin, 1.0, 100.0),
        ] {
            if !(least..=most).contains(&value) {
                return Err(Failure::plain(format!(
                    "{option} {value}: {least} to {most} is valid"
                )));
            }
        }
        let options = IdentifyOptions {
            records: self.records.clone(),
            from: self.from,
            width: 1e-3 * self.width_ms,
            margin: self.margin,
            slides: self.slides.clone(),
        };
        let Identification { joints, undetermined } = identify(&options)?;
        let code = ExitCode::from(u8::from(!undetermined.is_empty()));
        let lacking: Vec<String> = undetermined.iter().map(undetermined_words).collect();
        // Lists of friction are of all joints.
        let without =
            |joint: &IdentifiedJoint| IdentifiedJoint { dry_friction: None, ..joint.clone() };
        let mut sections = if lacking.is_empty() {
            sections(&joints, self.margin)
        } else {
            sections(&joints.iter().map(without).collect::<Vec<_>>(), self.margin)
        };
        for words in &lacking {
            // Infallible: a String takes everything.
            let _ = write!(sections, "\n# {words}\n");
        }
        if let Some(path) = &self.out {
            files::write(path, &sections)?;
        }
        if self.json {
            let document =
                json!({ "joints": joints, "undetermined": undetermined, "file": self.out });
            println!("{document:#}");
            return Ok(code);
        }
        if !joints.is_empty() {
            println!("{}", table::identified(&joints));
            println!(
                "an estimate, not a proof: inertia that explains every sample of the records; φ for the middle of its \
                    interval, times {}",
                self.margin
            );
        }
        for words in &lacking {
            println!("{words}");
        }
        match &self.out {
            Some(path) => println!("sections: {}", path.display()),
            None => print!("\n{sections}"),
        }
        Ok(code)
    }
}

/// Reason why a joint has no interval, as a line.
fn undetermined_words(joint: &UndeterminedJoint) -> String {
    format!("joint {}: no record tells its inertia: {}", joint.name, joint.why)
}

/// The `[[joint]]` sections of a study.
pub(crate) fn sections(joints: &[IdentifiedJoint], margin: f64) -> String {
    let mut text = format!(
        "# By `phihat identify`: inertia that explains every sample, φ times {margin}. Widen what your records do not \
         visit: other\n# postures, other loads. Limits are those of the drive's data sheet: uncomment and fill in.\n"
    );
    for joint in joints {
        // Infallible: a String takes everything.
        let _ = write!(
            text,
            "\n[[joint]]\nname = {:?}\n{}inertia_min_kg_m2 = {}\ninertia_max_kg_m2 = {}\n\
             phi_rate_max_nm_s = {}\nphi_jump_max_nm = {}\n# torque_max_nm = \n# velocity_max_rad_s = \n\
             # position_min_rad = \n# position_max_rad = \n",
            joint.name,
            if joint.slides { "slides = true\n" } else { "" },
            at_least(joint.inertia.low_kg_m2),
            at_most(joint.inertia.high_kg_m2),
            at_most(joint.phi_rate_max_nm_s),
            at_most(joint.phi_jump_max_nm),
        );
    }
    text + &dry_friction(joints, margin)
}

/// Dry friction for a study of an arm that has a description, as a comment; empty where a joint never
/// reversed.
fn dry_friction(joints: &[IdentifiedJoint], margin: f64) -> String {
    let Some(dry) = joints.iter().map(|joint| joint.dry_friction).collect::<Option<Vec<_>>>()
    else {
        return String::new();
    };
    let list =
        |of: &dyn Fn(&DryFriction) -> String| dry.iter().map(of).collect::<Vec<_>>().join(", ");
    format!(
        "\n# Dry friction where joints reverse, its interval {margin} times wider either way. In a study of this arm's \
         description, whose laws\n# are from positions, the level goes in with the reference, and the tube is for all \
         of the interval:\n# [feedforward]\n# coulomb_nm = [{}]\n# [design]\n# coulomb_min_nm = [{}]\n# coulomb_max_nm \
         = [{}]\n",
        list(&|dry| at_most(dry.level_nm)),
        list(&|dry| at_least(dry.low_nm / margin)),
        list(&|dry| at_most(dry.high_nm * margin)),
    )
}

/// Four significant figures of a bound from below, as TOML writes a number.
fn at_least(bound: f64) -> String {
    outward(bound, false)
}

/// The same of a bound from above.
fn at_most(bound: f64) -> String {
    outward(bound, true)
}

/// The next number of four significant figures that leaves an interval no narrower.
fn outward(bound: f64, above: bool) -> String {
    let four = |value: f64| format!("{value:.3e}").parse().unwrap_or(value);
    let near: f64 = four(bound);
    let step = 10.0_f64.powf(near.abs().log10().floor() - 3.0);
    let wide = match above {
        true if near < bound => four(near + step),
        false if near > bound => four(near - step),
        _ => near,
    };
    format!("{wide:?}")
}

#[cfg(test)]
mod tests {
    use super::{at_least, at_most};

    #[test]
    fn four_figures_never_narrow_an_interval() {
        for k in 1..2000_u32 {
            let x = 1e-4 * f64::from(k).powf(1.7);
            let (low, high): (f64, f64) =
                (at_least(x).parse().unwrap(), at_most(x).parse().unwrap());
            assert!(low <= x && x <= high, "{low} {x} {high}");
            assert!(high - low <= 1.1e-3 * x, "{low} {x} {high}");
        }
        assert_eq!([at_least(0.0), at_most(0.0), at_most(0.25)], ["0.0", "0.0", "0.25"]);
        assert_eq!([at_least(1.23456), at_most(1.23456)], ["1.234", "1.235"]);
    }
}
