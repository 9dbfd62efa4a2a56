//! A study before it is text: what every run shares, and the world, which the runs of one study vary.

use core::fmt::{Debug, Write as _};
use std::path::Path;

use phihat_study::{Study, StudyError};

use crate::arm::UserArm;

/// A body that the arm carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DraftLoad {
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\].
    pub com: [f64; 3],
    /// Inertia about it, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub inertia: [f64; 6],
}

/// Payload, friction and encoder phase of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct DraftWorld {
    /// Body that the arm carries, if any.
    pub load: Option<DraftLoad>,
    /// Dry friction on top of the robot's \[N·m\] per joint.
    pub coulomb: Vec<f64>,
    /// By how much of a quantum the encoders' steps are displaced, per joint; empty: not at all.
    pub phase: Vec<f64>,
}

/// Scope of the study: payloads and friction that a run may have.
#[derive(Debug, Clone, PartialEq)]
pub struct DraftScope {
    /// Frame that carries the payload; `None`: the tip.
    pub frame: Option<String>,
    /// Mass \[kg\].
    pub mass: (f64, f64),
    /// Box of its centre \[m\].
    pub com: [(f64, f64); 3],
    /// Largest second moment about the centre over mass, its root \[m\].
    pub gyration: f64,
    /// Dry friction on top of the robot's \[N·m\] per joint.
    pub coulomb: (Vec<f64>, Vec<f64>),
}

/// Source of a study's laws.
#[derive(Debug, Clone, PartialEq)]
pub enum DraftLaws {
    /// From its design.
    Designed,
    /// From its `[gains]`.
    Typed {
        /// They, as text.
        gains: String,
        /// Seed of the filters on their innovation; `None`: no filters.
        filter: Option<u64>,
    },
    /// From the search by positions, once: the shares of the allowed torque noise, per joint.
    Sketched(Vec<f64>),
}

/// A study to be.
#[derive(Debug, Clone)]
pub struct Draft {
    /// The arm.
    pub arm: UserArm,
    /// Simulated time \[s\].
    pub duration: f64,
    /// When the steady part begins \[s\].
    pub settle: f64,
    /// Largest |e| per joint.
    pub error_bound: Vec<f64>,
    /// The robot's own dry friction, where it acts \[N·m\] per joint.
    pub own_coulomb: Vec<f64>,
    /// Lines of `[design]` besides those of the scope.
    pub design: String,
    /// Source of the laws.
    pub laws: DraftLaws,
    /// Lines of `[loop]`.
    pub control: String,
    /// Lines of `[sensor]`.
    pub sensor: String,
    /// Lines of `[world]` besides friction and payload.
    pub world: String,
    /// Integration steps per sample.
    pub substeps: u32,
    /// `[[world.push]]` and all sections after `[world]`.
    pub rest: String,
    /// Payloads and friction that runs may have.
    pub scope: DraftScope,
    /// Payload and friction of the study itself.
    pub nominal: DraftWorld,
    /// Names of its features.
    pub tags: Vec<String>,
}

impl Draft {
    /// Text of the study, in some world.
    pub fn text(&self, world: &DraftWorld) -> String {
        let mut text = String::new();
        if !world.phase.is_empty() {
            // No key of a study: the attack's own loop, and the second opinion, read it.
            let _ = writeln!(text, "# encoder_phase = {:?}", world.phase);
        }
        let mut line = |key: &str, value: &dyn Debug| _ = writeln!(text, "{key} = {value:?}");
        line("duration_s", &self.duration);
        let (robot, _) = self.arm.section();
        let _ = writeln!(text, "\n[robot]\n{robot}\n\n[spec]\nsettle_s = {:?}", self.settle);
        let _ = writeln!(
            text,
            "error_bound_rad = {:?}\n\n[design]\n{}",
            self.error_bound,
            self.known()
        );
        self.ranges(&mut text);
        if let DraftLaws::Typed { gains, .. } = &self.laws {
            text += gains;
        }
        let _ = write!(text, "\n[loop]\n{}", self.control);
        // What a random arm is asked for may be beyond its drives: the record then says what became of the claims.
        let _ = write!(text, "beyond_drives = \"allow\"\n\n[sensor]\n{}\n[world]\n", self.sensor);
        let _ = writeln!(text, "{}coulomb_extra_nm = {:?}", self.world, world.coulomb);
        let _ = writeln!(text, "substeps = {}", self.substeps);
        if let Some(DraftLoad { mass, com, inertia }) = world.load {
            let _ = writeln!(text, "\n[world.payload]\nmass_kg = {mass:?}\ncom_m = {com:?}");
            let _ = writeln!(text, "inertia_kg_m2 = {inertia:?}");
            if let Some(frame) = &self.scope.frame {
                let _ = writeln!(text, "frame = {frame:?}");
            }
        }
        text + &self.rest
    }

    /// Lines of `[design]`, without those for a search where the laws are typed.
    fn known(&self) -> String {
        let typed = matches!(self.laws, DraftLaws::Typed { .. });
        let kept = self.design.lines().filter(|line| !(typed && line.starts_with("orders")));
        kept.fold(String::new(), |text, line| text + line + "\n")
    }

    /// The scope, as keys of `[design]`.
    fn ranges(&self, text: &mut String) {
        let scope = &self.scope;
        let (low, high) = scope.mass;
        if high > 0.0 {
            let com = scope.com.map(|(low, high)| [low, high]);
            let _ = writeln!(text, "payload_kg = {:?}\npayload_com_m = {com:?}", [low, high]);
            let _ = writeln!(text, "payload_gyration_m = {:?}", scope.gyration);
            if let Some(frame) = &scope.frame {
                let _ = writeln!(text, "payload_frame = {frame:?}");
            }
        }
        let all = |extra: &[f64]| -> Vec<f64> {
            extra.iter().zip(&self.own_coulomb).map(|(a, b)| a + b).collect()
        };
        let (low, high) = (all(&scope.coulomb.0), all(&scope.coulomb.1));
        let _ = writeln!(text, "coulomb_min_nm = {low:?}\ncoulomb_max_nm = {high:?}");
    }

    /// The study, in some world; `folder` has the arm's files.
    ///
    /// # Errors
    ///
    /// [`StudyError`]: this draft is no study.
    pub fn study(&self, world: &DraftWorld, folder: &Path) -> Result<Study, StudyError> {
        Study::from_text(&self.text(world), "study.toml", folder)
    }
}
