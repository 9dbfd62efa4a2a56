//! Options of a new study.

use std::path::PathBuf;

use phihat_model::xacro::XacroOptions;
use phihat_model::{Joint, NamedTexts, Part};

use crate::error::SessionError;

/// Arm of a new study.
#[derive(Debug, Clone, Default)]
pub struct ArmOptions {
    /// Name of a built-in arm, or a URDF, MJCF, xacro or TOML file.
    pub arm: String,
    /// The part of the file that is the arm; the chain that is proposed, where none is stated.
    pub part: Part,
    /// Arguments and packages, where the file is one of xacro.
    pub xacro: XacroOptions,
    /// Torque limits \[N·m\]: one for all joints or one each, in place of those of the description; empty: those.
    pub torque_max_nm: Vec<f64>,
    /// Known arm that it is, by its name in [`phihat_model::KnownArm`]; `"none"`: none; `None`: by its description.
    pub known: Option<String>,
    /// Torque interface, in place of the arm's: one of [`phihat_model::Profile::NAMES`].
    pub profile: Option<String>,
    /// Source of the file and of those that it names.
    pub files: NamedTexts,
}

impl ArmOptions {
    /// Puts the torque limits that are stated in place of those of a description.
    pub(super) fn limit(&self, joints: &mut [Joint]) -> Result<(), SessionError> {
        let n = joints.len();
        match &self.torque_max_nm[..] {
            [] => {}
            [one] => joints.iter_mut().for_each(|joint| joint.torque_max = Some(*one)),
            all if all.len() == n => {
                let each = joints.iter_mut().zip(all);
                each.for_each(|(joint, torque)| joint.torque_max = Some(*torque));
            }
            all => {
                let why = format!("--torque-max has {} values; the arm has {n} joints", all.len());
                return Err(SessionError::other(why));
            }
        }
        Ok(())
    }
}

/// Options of a new study.
#[derive(Debug, Clone, Default)]
pub struct BeginOptions {
    /// Arm of a new study.
    pub arm: ArmOptions,
    /// The study file to write.
    pub out: PathBuf,
    /// Heaviest payload \[kg\].
    pub payload_kg: f64,
    /// Largest error \[rad, m\]; `None`: the smallest that can be promised, with a margin.
    pub error_bound: Option<f64>,
    /// Ends with the first error that gains and runs keep: no smaller one is looked for.
    pub first_kept: bool,
    /// Control samples per second.
    pub rate_hz: Option<f64>,
    /// Transport delay in samples.
    pub delay_samples: Option<u32>,
    /// Encoder resolution \[bit\]; `None`: the arm's, else an assumption.
    pub encoder_bits: Option<u32>,
    /// Replaces files that are there.
    pub replace: bool,
}

impl BeginOptions {
    /// The study's name: its file's, without `.toml`.
    pub(super) fn study_name(&self) -> Result<String, SessionError> {
        let stem = self.out.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        let is_toml = self.out.extension().is_some_and(|extension| extension == "toml");
        let plain = |c: char| matches!(c, 'a'..='z' | '0'..='9' | '_' | '-');
        if is_toml && !stem.is_empty() && stem.len() <= 64 && stem.chars().all(plain) {
            return Ok(stem.to_owned());
        }
        let why = "a study's file is called NAME.toml, with 1 to 64 of a-z, 0-9, _ and - in NAME";
        Err(SessionError::at(&self.out, why))
    }
}
