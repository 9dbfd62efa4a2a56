//! How a range of inertia is known: the postures where its ends were found, for anyone to look at again.

use phihat_model::{Body, Model, Robot, Workspace};
use serde::{Deserialize, Serialize};

use super::ArmError;
use super::postures::{eigen, scaled_mass_matrix};

/// A posture at which the arm has an eigenvalue at an end of its range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Witness {
    /// Posture \[rad, m\].
    pub q: Vec<f64>,
    /// Payload's mass \[kg\].
    pub mass_kg: f64,
    /// Its centre of mass \[m\].
    pub com_m: [f64; 3],
    /// Its inertia about the centre of mass, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub inertia_kg_m2: [f64; 6],
    /// Smallest or largest eigenvalue of `M̄^{-1/2} M(q) M̄^{-1/2}` there.
    pub eigenvalue: f64,
}

/// How the ends of a range were found.
///
/// # Claim
///
/// The arm has the two eigenvalues at the two witnesses: the range is no narrower than said. All postures and
/// payloads that were tried lie inside.
///
/// # Not claimed
///
/// That no posture lies outside, unless [`proved`](Self::proved) says how far one could.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Searched {
    /// Postures looked at, those of the reference among them.
    pub postures: u32,
    /// Postures of the reference among them.
    pub of_reference: u32,
    /// Postures from which each end was sought by coordinate ascent.
    pub starts: u32,
    /// Frame that the payload is welded to.
    pub frame: String,
    /// Where the smallest eigenvalue is.
    pub low: Witness,
    /// Where the largest is.
    pub high: Witness,
    /// What is proved of all postures and payloads; `None`: nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proved: Option<Proved>,
}

/// Bounds that hold at every posture inside the joints' travel, with every payload of the set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proved {
    /// No eigenvalue is below.
    pub low: f64,
    /// No eigenvalue is above.
    pub high: f64,
    /// Cells of postures that the proof of `high` needed.
    pub cells: u64,
}

impl Witness {
    pub(super) fn new(q: Vec<f64>, body: &Body, eigenvalue: f64) -> Self {
        let Body { mass, com, inertia } = *body;
        Self { q, mass_kg: mass, com_m: com, inertia_kg_m2: inertia, eigenvalue }
    }

    /// Smallest and largest eigenvalue at the witness, looked at again on a robot.
    ///
    /// # Errors
    ///
    /// [`ArmError::Payload`] if the robot has no such frame or joints.
    pub fn replay(
        &self,
        robot: &Robot,
        frame: &str,
        nominal: &[f64],
    ) -> Result<(f64, f64), ArmError> {
        let n = robot.joints.len();
        if self.q.len() != n || nominal.len() != n {
            let why = format!("a witness of {} joints for an arm of {n}", self.q.len());
            return Err(ArmError::Payload(why));
        }
        let body = Body { mass: self.mass_kg, com: self.com_m, inertia: self.inertia_kg_m2 };
        let model: Model = robot
            .plant_model()
            .with_payload_on(frame, &body)
            .map_err(|e| ArmError::Payload(e.to_string()))?;
        let w = scaled_mass_matrix(&model, &mut Workspace::new(&model), &self.q, nominal);
        let (low, high) = eigen(&w);
        Ok((low.0, high.0))
    }
}

impl Searched {
    /// The same, measured in `scale` times the nominal inertias.
    pub(super) fn scaled(&self, scale: f64) -> Self {
        let mut scaled = self.clone();
        scaled.low.eigenvalue /= scale;
        scaled.high.eigenvalue /= scale;
        if let Some(proved) = &mut scaled.proved {
            proved.low /= scale;
            proved.high /= scale;
        }
        scaled
    }
}
