//! `phihat drive --first-motion`: how it is asked for, and what is shown of it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use phihat_drive::Prepared;
use phihat_model::JointKind;
use phihat_report::kit::unit_of;
use phihat_session::{
    FIRST_WIDTH, FirstMeasured, FirstMotion, FirstStudy, IdentifyOptions, MeasuredJoint,
    NarrowedArm, files, first_measured, narrowed_arm,
};

use crate::failure::Failure;
use crate::identify::sections;
use crate::table;

/// File of the sections, in the folder of the record.
const JOINTS: &str = "joints.toml";

#[derive(Debug, Args)]
pub(crate) struct FirstMotionArguments {
    /// Move each joint a little, one after the other, about where the arm stands, in place of the study's
    /// motion, and measure inertia, friction and φ: under cautious gains, which need no certificate.
    #[arg(long = "first-motion", id = "first_motion", conflicts_with = "gains")]
    asked: bool,
    /// Of a first motion: how far a joint moves to either side.
    #[arg(long, value_name = "RAD", default_value_t = 0.05, requires = "first_motion")]
    amplitude_rad: f64,
    /// Of a first motion: the share of its largest torque that a joint is told at most.
    #[arg(long, value_name = "SHARE", default_value_t = 0.3, requires = "first_motion")]
    torque_share: f64,
    /// Of a first motion: by what factor the true inertia may be off from what the study says, either way.
    #[arg(long, value_name = "FACTOR", default_value_t = 3.0, requires = "first_motion")]
    inertia_within: f64,
    /// Of a first motion: what sizes and rates of φ are multiplied by.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.5, requires = "first_motion")]
    margin: f64,
}

impl FirstMotionArguments {
    /// Requested first motion, if any.
    pub(crate) fn asked(&self) -> Result<Option<FirstMotion>, Failure> {
        for (option, value, least, most) in [
            ("--amplitude-rad", self.amplitude_rad, 1e-3, 0.3),
            ("--torque-share", self.torque_share, 0.01, 1.0),
            ("--inertia-within", self.inertia_within, 1.0, 20.0),
            ("--margin", self.margin, 1.0, 100.0),
        ] {
            if !(least..=most).contains(&value) {
                let valid = format!("{option} {value}: {least} to {most} is valid");
                return Err(Failure::plain(valid));
            }
        }
        Ok(self.asked.then_some(FirstMotion {
            amplitude: self.amplitude_rad,
            torque_share: self.torque_share,
            inertia_within: self.inertia_within,
        }))
    }

    /// Reads what the record in a folder shows, and writes the sections beside it.
    pub(crate) fn measured(
        &self,
        first: &FirstStudy,
        folder: &Path,
    ) -> Result<MeasuredAndWritten, Failure> {
        let options = IdentifyOptions {
            width: FIRST_WIDTH,
            margin: self.margin,
            slides: first.study.robot.sliding(),
            ..IdentifyOptions::default()
        };
        let found = first_measured(&first.study, folder, &options)?;
        // A drive that ended early says nothing that the next step could build on.
        let Some(joints) = found.all() else {
            return Ok(MeasuredAndWritten { found, narrowed: None });
        };
        files::write(&folder.join(JOINTS), &sections(&joints, self.margin))?;
        let narrowed = narrowed_arm(&first.study, &found)?;
        if let Some(arm) = &narrowed {
            files::write(&folder.join(&arm.name), &arm.text)?;
        }
        Ok(MeasuredAndWritten { found, narrowed })
    }
}

/// Measurements of a first motion, and the arm's file with narrower intervals, where there is one.
pub(crate) struct MeasuredAndWritten {
    pub(crate) found: FirstMeasured,
    narrowed: Option<NarrowedArm>,
}

impl MeasuredAndWritten {
    /// The written file of the arm.
    pub(crate) fn arm(&self, folder: &Path) -> Option<PathBuf> {
        self.narrowed.as_ref().map(|arm| folder.join(&arm.name))
    }
}

/// Announcement of a first motion.
pub(crate) fn announced(prepared: &Prepared) -> Option<String> {
    let first = prepared.first.as_ref()?;
    let mut text = format!("first motion: {:.0} s, one joint at a time;", first.study.duration);
    let joints = first.study.robot.joints.iter().zip(&first.torque).zip(&first.guess);
    for ((joint, torque), guess) in joints {
        // Infallible: a String takes everything.
        let _ = write!(
            text,
            "\n  {}: at most {torque:.2} {}, inertia guessed {guess:.4} {}",
            joint.name,
            unit_of("N·m", joint.kind == JointKind::Prismatic),
            unit_of("kg·m²", joint.kind == JointKind::Prismatic)
        );
    }
    Some(text)
}

/// The verdict, on one screen.
pub(crate) fn verdict(measured: &MeasuredAndWritten, folder: &Path) -> String {
    let found = &measured.found;
    let mut lines = Vec::new();
    let known: Vec<_> = found.joints.iter().filter_map(|joint| joint.found.clone()).collect();
    if !known.is_empty() {
        lines.push(table::identified(&known));
    }
    lines.extend(found.joints.iter().map(line));
    lines.push(if found.all().is_some() {
        format!("MEASURED all {} joints: {}", known.len(), folder.join(JOINTS).display())
    } else {
        format!(
            "NOT measured: {} of {} joints",
            found.joints.len() - known.len(),
            found.joints.len()
        )
    });
    let written = measured.narrowed.as_ref().zip(measured.arm(folder));
    lines.extend(written.into_iter().flat_map(|(arm, path)| narrower(arm, &path)));
    lines.join("\n")
}

/// The arm's file with narrower intervals, and the next command.
fn narrower(arm: &NarrowedArm, path: &Path) -> Vec<String> {
    let mut lines = Vec::new();
    if !arm.contradicted.is_empty() {
        lines.push(format!(
            "{}: no rotor within its interval explains the measured inertia: the masses of the description, a load, or \
             the interval are wrong; its interval stays",
            arm.contradicted.join(", ")
        ));
    }
    lines.push(format!(
        "written: {}, the arm with rotors and friction as measured (widest interval of a rotor: {:.3} kg·m², before \
            {:.3})",
        path.display(),
        arm.widest_kg_m2.1,
        arm.widest_kg_m2.0
    ));
    lines.push(format!("next: phihat new {}", path.display()));
    lines
}

/// A joint beside what the study says of it.
fn line(joint: &MeasuredJoint) -> String {
    let name = &joint.name;
    let (low, high) = joint.study_kg_m2;
    let told = if low < high { format!("{low:.4} … {high:.4}") } else { format!("{low:.4}") };
    let (Some(same), Some(found)) = (joint.as_told(), &joint.found) else {
        let why = joint.why.as_deref().unwrap_or("it did not move");
        return format!("{name}: not measured: {why}");
    };
    let word = if same { "as the study says" } else { "NOT as the study says" };
    let friction = 0.5 * found.phi_jump_max_nm;
    format!(
        "{name}: inertia {word} ({told} {}); dry friction at most {friction:.2} {}",
        unit_of("kg·m²", found.slides),
        unit_of("N·m", found.slides)
    )
}
