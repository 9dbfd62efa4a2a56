//! `phihat new`: a study that runs, made of an arm alone.

use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use clap::builder::PossibleValuesParser;
use phihat_certificate::extremes::Extremes as _;
use phihat_model::{NamedTexts, Part, Profile, Robot};
use phihat_report::kit::{MILLI, unit_of};
use phihat_session::{ArmOptions, BeginOptions, Begun, begin};
use serde_json::json;

use crate::failure::Failure;
use crate::numbers::{NoNumber, not_negative, positive};
use crate::shown::TerminalWatch;
use crate::xacro::Xacro;

/// Write a study that runs, for an arm of yours.
///
/// What a URDF leaves out (rotor inertia, friction, encoders) is estimated, as intervals, and written with
/// its sources into a file of the arm, NAME_arm.toml, beside the study; it says what to measure. The motion
/// keeps inside the limits of position, speed and torque. The smallest error that can be promised is looked
/// for, and simulated with every rotor at both ends of its interval, before anything is written. Without an
/// ARM, on a terminal, the few things that matter are asked for.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 1: the files are written, and no gains keep any error; what would make them possible is \
                        told.\n\nExamples:\n  phihat new planar3r --out my_first.toml --payload 0.2\n  phihat new \
                        fr3.urdf.xacro hand:=true\n  phihat new ur.urdf --arm ur5e --payload 2"
)]
pub(crate) struct New {
    /// A URDF, MJCF or xacro file, the TOML of an arm, or a built-in arm's name.
    arm: Option<String>,
    #[command(flatten)]
    xacro: Xacro,
    /// Link that the arm stands on, in a file of a larger robot [default: that of the longest chain].
    #[arg(long, value_name = "LINK")]
    base: Option<String>,
    /// Link that the arm ends in.
    #[arg(long, value_name = "LINK")]
    tip: Option<String>,
    /// The study to write [default: NAME.toml, of the arm's name].
    #[arg(long, value_name = "STUDY.toml")]
    out: Option<PathBuf>,
    /// Heaviest payload, centred within 10 cm of the tip along each axis; the run carries it at the tip.
    #[arg(long, value_name = "KG", value_parser = not_negative)]
    payload: Option<f64>,
    /// Largest error of a joint [default: the smallest that can be promised, with a margin].
    #[arg(long, value_name = "MRAD", value_parser = positive)]
    error: Option<f64>,
    /// Torque limits of the drives, one for all joints or one each, separated by commas [default: those of the file].
    #[arg(long, value_name = "NM,…", value_delimiter = ',', value_parser = positive)]
    torque_max: Vec<f64>,
    /// Arm that it is, of those known by name, or none [default: by the names in the description].
    #[arg(long = "arm", value_name = "NAME|none")]
    known: Option<String>,
    /// Torque interface [default: that of the arm, where it is known].
    #[arg(long, value_name = "PROFILE", value_parser = PossibleValuesParser::new(Profile::NAMES))]
    profile: Option<String>,
    /// Control samples per second [default: that of the torque interface, at most 1000].
    #[arg(long, value_name = "HZ", value_parser = positive)]
    rate: Option<f64>,
    /// Samples from measuring to the torque that acts [default: 1].
    #[arg(long, value_name = "SAMPLES", value_parser = clap::value_parser!(u32).range(0..=8))]
    delay: Option<u32>,
    /// Bits of the encoders over one turn of the joint [default: the arm's].
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(1..=32))]
    encoder_bits: Option<u32>,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
    /// Print one JSON document in place of sentences.
    #[arg(long)]
    json: bool,
}

impl New {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let options = match &self.arm {
            Some(arm) => self.options(arm)?,
            None if io::stdin().is_terminal() && !self.json => self.asked()?,
            None => {
                let why = format!(
                    "which arm? give a URDF or MJCF, the TOML of an arm, or one of {}",
                    Robot::names().join(", ")
                );
                return Err(Failure::plain(why));
            }
        };
        let mut shown = TerminalWatch::steps();
        let begun = begin(&options, &mut shown)?;
        self.tell(&begun);
        Ok(if begun.infeasible.is_none() { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }

    fn options(&self, arm: &str) -> Result<BeginOptions, Failure> {
        let out = match &self.out {
            Some(out) => out.clone(),
            None => {
                default_out(arm).ok_or_else(|| Failure::plain("name the study: --out NAME.toml"))?
            }
        };
        Ok(BeginOptions {
            arm: ArmOptions {
                arm: arm.to_owned(),
                part: Part { base: self.base.clone(), tip: self.tip.clone(), ..Part::default() },
                xacro: self.xacro.options()?,
                torque_max_nm: self.torque_max.clone(),
                known: self.known.clone(),
                profile: self.profile.clone(),
                files: NamedTexts::DISK,
            },
            out,
            payload_kg: self.payload.unwrap_or(0.0),
            error_bound: self.error.map(|mrad| 1e-3 * mrad),
            first_kept: false,
            rate_hz: self.rate,
            delay_samples: self.delay,
            encoder_bits: self.encoder_bits,
            replace: self.force,
        })
    }

    /// Asks a person for what matters most; an empty answer takes what is proposed.
    fn asked(&self) -> Result<BeginOptions, Failure> {
        let names = Robot::names().join(", ");
        let arm = loop {
            let arm = answer(&format!(
                "Which arm? A URDF or MJCF, the TOML of an arm, or one of {names}:"
            ))?;
            if !arm.is_empty() {
                break arm;
            }
        };
        let mut options = self.options(&arm)?;
        let kg = |text: &str| not_negative(text);
        options.payload_kg =
            asked_number("Heaviest payload in kg [none]:", kg)?.unwrap_or(options.payload_kg);
        let mrad =
            asked_number("Largest error in mrad [the smallest that can be promised]:", positive)?;
        options.error_bound = mrad.map(|mrad| 1e-3 * mrad).or(options.error_bound);
        options.rate_hz =
            asked_number("Control samples per second [1000]:", positive)?.or(options.rate_hz);
        let out = answer(&format!("The study to write [{}]:", options.out.display()))?;
        if !out.is_empty() {
            options.out = out.into();
        }
        Ok(options)
    }

    fn tell(&self, begun: &Begun) {
        if self.json {
            let document = json!({
                "study": begun.study,
                "files": begun.files,
                "joints": begun.joints,
                "error_bound_rad": begun.error_bound,
                "simulated_error_peak_rad": begun.simulated,
                "notes": begun.notes,
                "infeasible": begun.infeasible,
                "exit_code": i32::from(begun.infeasible.is_some()),
            });
            println!("{document:#}");
            return;
        }
        for note in &begun.notes {
            println!("note: {note}");
        }
        let files: Vec<String> =
            begun.files.iter().map(|path| path.display().to_string()).collect();
        println!("written: {}", files.join(", "));
        if let Some(why) = &begun.infeasible {
            println!("no gains keep it: {why}");
            return;
        }
        let seen = begun.simulated.as_deref().unwrap_or_default();
        let of = |slides: bool| {
            let most = |list: &[f64]| {
                let own = begun.slides.iter().zip(list).filter(|(own, _)| **own == slides);
                MILLI * own.map(|(_, error)| *error).largest()
            };
            let unit = unit_of("mrad", slides);
            begun.slides.contains(&slides).then(|| {
                let (asked, seen) = (most(&begun.error_bound), most(seen));
                format!("an error of {asked:.3} {unit} is promised, {seen:.3} {unit} was the largest simulated")
            })
        };
        let told: Vec<String> = [false, true].into_iter().filter_map(of).collect();
        println!("{} joints; {}", begun.joints.len(), told.join("; where they slide, "));
        let study = begun.study.display();
        println!("next: phihat run {study}");
        if begun.files.len() > 1 {
            println!(
                "on the arm: phihat drive {study} --on ROBOT --first-motion, which measures what is estimated here"
            );
        }
    }
}

/// The study of an arm, in the folder that the program runs in.
fn default_out(arm: &str) -> Option<PathBuf> {
    let stem = Path::new(arm).file_stem()?.to_str()?.to_lowercase();
    let stem = stem.trim_end_matches(".urdf");
    let plain = |c: char| if matches!(c, 'a'..='z' | '0'..='9' | '_' | '-') { c } else { '_' };
    let name: String = stem.chars().map(plain).take(64).collect();
    (!name.is_empty()).then(|| PathBuf::from(format!("{name}.toml")))
}

fn answer(question: &str) -> Result<String, Failure> {
    print!("{question} ");
    io::stdout().flush().map_err(Failure::plain)?;
    let mut line = String::new();
    if io::stdin().lock().read_line(&mut line).map_err(Failure::plain)? == 0 {
        return Err(Failure::plain("no answer"));
    }
    Ok(line.trim().to_owned())
}

/// A number, or nothing; asked again until it is one of them.
fn asked_number(
    question: &str,
    read: impl Fn(&str) -> Result<f64, NoNumber>,
) -> Result<Option<f64>, Failure> {
    loop {
        let text = answer(question)?;
        if text.is_empty() {
            return Ok(None);
        }
        match read(&text) {
            Ok(value) => return Ok(Some(value)),
            Err(why) => println!("{why}"),
        }
    }
}
