//! `phihat robots`: the arms at hand, and what is known of one.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use clap::builder::PossibleValuesParser;
use phihat_model::xacro::{Expanded, expand, is_xacro};
use phihat_model::{
    Chain, InertiaRange, KnownArm, NamedTexts, Part, Profile, Recognition, Robot, RobotError,
};
use phihat_session::{ArmOptions, ambiguity_text, files, recognition_text, write_arm};
use serde_json::json;

use crate::failure::Failure;
use crate::table;
use crate::xacro::Xacro;

/// Postures sampled for the range of inertia.
const POSTURES: usize = 1500;

/// Seed of these postures.
const SEED: u64 = 1;

/// List the built-in arms, or show one: joints, limits, friction, inertia range, sources.
///
/// Of a file with more than one chain of joints, it lists those that could be arms, the longest first.
///
/// The inertia range tells the nominal inertia M̄ of each joint that centres the window (not the one with the least
/// error, which a design finds), and the ratio of eigenvalues that the
/// law's stability window has to hold.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  phihat robots\n  phihat robots panda\n  phihat robots fr3.urdf.xacro hand:=true --urdf \
        fr3.urdf\n  phihat robots scene.xml --tip attachment_site"
)]
pub(crate) struct Robots {
    /// A built-in arm, or a file: a URDF, MJCF, xacro, or the TOML that stands beside one.
    name: Option<String>,
    #[command(flatten)]
    xacro: Xacro,
    /// Write a URDF: the one that xacro expands to, else one made of the arm, as of an MJCF.
    #[arg(long, value_name = "ARM.urdf", requires = "name", conflicts_with = "write")]
    urdf: Option<PathBuf>,
    /// Link that the arm stands on, in a file of a larger robot.
    #[arg(long, value_name = "LINK")]
    base: Option<String>,
    /// Link that the arm ends in.
    #[arg(long, value_name = "LINK")]
    tip: Option<String>,
    /// Arm that it is, of those known by name, or none [default: by the names in the description].
    #[arg(long = "arm", value_name = "NAME|none")]
    known: Option<String>,
    /// Torque interface [default: that of the arm, where it is known, for that file].
    #[arg(long, value_name = "PROFILE", value_parser = PossibleValuesParser::new(Profile::NAMES), requires = "write")]
    profile: Option<String>,
    /// Write the commented file of an arm of a bare URDF or MJCF, with estimates of what that leaves out: beside it,
    /// or above it.
    #[arg(long, value_name = "ARM.toml", requires = "name")]
    write: Option<PathBuf>,
    /// Torque limits of the drives for that file, one for all joints or one each, separated by commas.
    #[arg(long, value_name = "NM,…", value_delimiter = ',', requires = "write")]
    torque_max: Vec<f64>,
    /// Replace the file to write, if it is there.
    #[arg(long, requires = "name")]
    force: bool,
    /// Print one JSON document in place of tables.
    #[arg(long)]
    json: bool,
}

impl Robots {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        match &self.name {
            None => self.list()?,
            Some(name) => match (&self.write, &self.urdf) {
                (Some(out), _) => self.write(name, out)?,
                (None, Some(out)) => self.expand(name, out)?,
                (None, None) => self.show(name)?,
            },
        }
        Ok(ExitCode::SUCCESS)
    }

    fn list(&self) -> Result<(), Failure> {
        let robots: Vec<Robot> = Robot::names()
            .iter()
            .map(|name| Robot::named(name))
            .collect::<Result<_, _>>()
            .map_err(Failure::plain)?;
        if self.json {
            let rows: Vec<_> = robots
                .iter()
                .map(|r| {
                    json!({ "name": r.name, "joints": r.joints.len(), "description": r.description })
                })
                .collect();
            println!("{:#}", json!(rows));
        } else {
            println!("{}", table::robots(&robots));
            println!(
                "`phihat robots NAME` shows one; a study can also name a URDF or MJCF file of yours."
            );
        }
        Ok(())
    }

    fn write(&self, name: &str, out: &Path) -> Result<(), Failure> {
        let options = ArmOptions {
            arm: name.to_owned(),
            part: Part { base: self.base.clone(), tip: self.tip.clone(), ..Part::default() },
            xacro: self.xacro.options()?,
            torque_max_nm: self.torque_max.clone(),
            known: self.known.clone(),
            profile: self.profile.clone(),
            files: NamedTexts::DISK,
        };
        let notes = write_arm(&options, out, self.force)?;
        if self.json {
            println!("{:#}", json!({ "file": out, "notes": notes }));
            return Ok(());
        }
        for note in &notes {
            println!("note: {note}");
        }
        println!("written: {}", out.display());
        Ok(())
    }

    /// Writes the URDF that a file of xacro expands to, or that an arm makes.
    fn expand(&self, name: &str, out: &Path) -> Result<(), Failure> {
        if out.exists() && !self.force {
            let why = format!("{}: it is there already; --force replaces it", out.display());
            return Err(Failure::plain(why));
        }
        let (urdf, mut document, lines) = if is_xacro(Path::new(name), &NamedTexts::DISK) {
            let expanded =
                expand(Path::new(name), &self.xacro.options()?).map_err(Failure::plain)?;
            let files: Vec<String> =
                expanded.files.iter().map(|file| file.display().to_string()).collect();
            let argument = |(name, value)| format!("argument: {name}:={value}");
            let lines: Vec<String> = expanded.arguments.iter().map(argument).collect();
            (expanded.urdf, json!({ "arguments": expanded.arguments, "files": files }), lines)
        } else {
            let robot = self.read(name)?.0.map_err(Failure::plain)?;
            let lines = robot.warnings.iter().map(|warning| format!("warning: {warning}"));
            (robot.as_urdf(), json!({ "warnings": robot.warnings }), lines.collect())
        };
        files::write(out, &urdf).map_err(Failure::plain)?;
        if self.json {
            document["file"] = json!(out);
            println!("{document:#}");
            return Ok(());
        }
        for line in lines {
            println!("{line}");
        }
        println!("written: {}", out.display());
        Ok(())
    }

    /// The arm of a file or a built-in one, and the chains of a file in which no part is stated.
    fn read(&self, name: &str) -> Result<(Result<Robot, RobotError>, Vec<Chain>), Failure> {
        let file = Some(Path::new(name)).filter(|path| path.extension().is_some());
        let mut part = Part { base: self.base.clone(), tip: self.tip.clone(), ..Part::default() };
        let xacro = self.xacro.options()?;
        let Some(path) = file else {
            if part.is_stated() {
                let why =
                    "--base and --tip cut an arm out of a file; built-in robots are arms already";
                return Err(Failure::plain(why));
            }
            return Ok((Robot::named(name), Vec::new()));
        };
        let expanded = if is_xacro(path, &NamedTexts::DISK) {
            Some(expand(path, &xacro).map_err(Failure::plain)?)
        } else if let Some(argument) = xacro.arguments.keys().next() {
            let why =
                format!("{argument}:= is an argument of xacro, and {name} is no file of xacro");
            return Err(Failure::plain(why));
        } else {
            None
        };
        let chains = match &expanded {
            Some(Expanded { urdf, origin, .. }) => Robot::chains_of_text(urdf, origin),
            None => Robot::chains(path),
        };
        let read = |part: &Part| match &expanded {
            Some(Expanded { urdf, origin, .. }) => Robot::part_of_text(urdf, part, origin),
            None => Robot::read_part(path, part),
        };
        let robot = read(&part);
        if part.is_stated() {
            return Ok((robot, Vec::new()));
        }
        let chains = chains.map_err(Failure::plain)?;
        // Of a known arm, its hand is no part.
        if let [first, ..] = &chains[..] {
            (part.base, part.tip) = (Some(first.base.clone()), Some(first.tip.clone()));
            let bare =
                robot.as_ref().is_ok_and(|robot| robot.bare_file().is_some() || expanded.is_some());
            if let Some(arm) = read(&part).ok().filter(|_| bare)
                && let Recognition::Known(..) = self.recognised(&arm)?
            {
                return Ok((Ok(arm), chains));
            }
        }
        Ok((robot, chains))
    }

    /// Known arm that a robot is.
    fn recognised(&self, robot: &Robot) -> Result<Recognition, Failure> {
        KnownArm::chosen(robot, self.known.as_deref()).map_err(Failure::plain)
    }

    fn show(&self, name: &str) -> Result<(), Failure> {
        let (robot, chains) = self.read(name)?;
        let whole = robot.as_ref().is_ok_and(|robot| {
            chains.iter().all(|chain| chain.joints == robot.model.joint_names())
        });
        if !self.json && !whole && !chains.is_empty() {
            println!("{}", table::chains(&chains));
            if let [first, ..] = &chains[..] {
                println!(
                    "an arm of them alone: --base {} --tip {}, or base and tip in [robot]\n",
                    first.base, first.tip
                );
            }
        }
        let robot = match robot {
            // Which arm it is remains to be chosen: that is an answer.
            Err(why @ RobotError::SeveralArms { .. }) if !self.json => {
                println!("note: {why}");
                return Ok(());
            }
            robot => robot.map_err(Failure::plain)?,
        };
        let known = self.recognised(&robot)?;
        let range = robot.inertia_range(POSTURES, SEED);
        if self.json {
            let mut told = document(&robot, &range, &chains);
            told["known"] = match &known {
                Recognition::Known(arm, why) => json!({
                    "name": arm.name, "title": arm.title, "profile": arm.profile, "encoder": arm.encoder,
                    "recognised": recognition_text(arm, why), "notes": arm.notes, "source": arm.source,
                }),
                _ => serde_json::Value::Null,
            };
            println!("{told:#}");
            return Ok(());
        }
        println!("{} · {}", robot.name, robot.description);
        tell_known(&known);
        println!("{}", table::joints(&robot, &range));
        println!(
            "inertia over {POSTURES} postures inside the joint limits, rotors included, no payload;\n\
             eigenvalues of M̄^-½ M M̄^-½: {:.3} … {:.3}, ratio {:.1}",
            range.lambda_min,
            range.lambda_max,
            range.ratio()
        );
        println!("tip frame: {}", robot.tip);
        for (pose, q) in &robot.poses {
            println!("pose {pose}: {q:?} rad");
        }
        println!("licence: {}\nprovenance: {}", robot.licence, robot.provenance);
        for (of, source) in &robot.sources {
            println!("{of}: {source}");
        }
        for warning in &robot.warnings {
            println!("warning: {warning}");
        }
        Ok(())
    }
}

/// Prints which known arm a robot is, or which ones it could be.
fn tell_known(known: &Recognition) {
    match known {
        Recognition::Known(arm, why) => {
            println!("{}", recognition_text(arm, why));
            for note in &arm.notes {
                println!("note: {note}");
            }
            println!("source: {}", arm.source);
        }
        Recognition::OneOf(arms) => println!("note: {}", ambiguity_text(arms)),
        Recognition::None => {}
    }
}

fn document(robot: &Robot, range: &InertiaRange, chains: &[Chain]) -> serde_json::Value {
    let chain = |c: &Chain| json!({ "base": c.base, "tip": c.tip, "joints": c.joints });
    let joint = |(i, j): (usize, &phihat_model::Joint)| {
        json!({
            "name": j.name,
            "position_rad": j.position.map(|(low, high)| [low, high]),
            "velocity_max_rad_s": j.velocity_max,
            "torque_max_nm": j.torque_max,
            "torque_rate_max_nm_s": j.torque_rate_max,
            "armature_kg_m2": j.armature,
            "armature_range_kg_m2": j.armature_range.map(|(low, high)| [low, high]),
            "coulomb_range_nm": j.friction.coulomb_range.map(|(low, high)| [low, high]),
            "viscous_nm_s_rad": j.friction.viscous,
            "coulomb_nm": j.friction.coulomb,
            "encoder_bits": j.encoder_bits,
            "drive_bandwidth_hz": j.drive_bandwidth_hz,
            "inertia_min_kg_m2": range.min[i],
            "inertia_max_kg_m2": range.max[i],
            "inertia_nominal_kg_m2": range.mean[i],
        })
    };
    json!({
        "name": robot.name,
        "description": robot.description,
        "licence": robot.licence,
        "provenance": robot.provenance,
        "sources": robot.sources,
        "tip": robot.tip,
        "frames": robot.model.frame_names(),
        "poses": robot.poses,
        "eigenvalue_min": range.lambda_min,
        "eigenvalue_max": range.lambda_max,
        "eigenvalue_ratio": range.ratio(),
        "warnings": robot.warnings,
        "chains": chains.iter().map(chain).collect::<Vec<_>>(),
        "joints": robot.joints.iter().enumerate().map(joint).collect::<Vec<_>>(),
    })
}
