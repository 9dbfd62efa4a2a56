//! Witnesses of a range of inertia: the postures where its ends were found, for anyone to check again.

use phihat_model::{Body, Robot, Rotor, Workspace};
use serde::{Deserialize, Serialize};

use crate::Refutation;

const CLAIM: &str = "range of inertia";

/// Relative rounding of an eigenvalue.
const ROUNDING: f64 = 1e-7;

/// A posture at which the arm has an eigenvalue at an end of its range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Witness {
    /// Posture \[rad, m\].
    pub q: Vec<f64>,
    /// Payload's mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass of the payload \[m\].
    pub com_m: [f64; 3],
    /// Inertia of the payload about its centre of mass, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub inertia_kg_m2: [f64; 6],
    /// Smallest or largest eigenvalue of `M̄^{-1/2} M(q) M̄^{-1/2}` there.
    pub eigenvalue: f64,
}

/// Search that found the ends of a range.
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
    /// Posture with the smallest eigenvalue.
    pub low: Witness,
    /// Posture with the largest eigenvalue.
    pub high: Witness,
    /// Bounds proved for all postures and payloads; `None`: none.
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
    /// Cells of postures that the proof looked at.
    pub cells: u64,
}

impl Witness {
    /// At a posture \[rad, m\] with a payload.
    pub fn new(q: Vec<f64>, body: &Body, eigenvalue: f64) -> Self {
        let Body { mass, com, inertia } = *body;
        Self { q, mass_kg: mass, com_m: com, inertia_kg_m2: inertia, eigenvalue }
    }

    /// `M̄^{-1/2} M(q) M̄^{-1/2}` at the witness, row by row, with the rotors at one place of their intervals.
    ///
    /// # Errors
    ///
    /// [`Refutation`] if the robot has other joints, or no such frame.
    pub fn matrix(
        &self,
        (robot, rotor): (&Robot, Rotor),
        frame: &str,
        nominal: &[f64],
    ) -> Result<Vec<f64>, Refutation> {
        let n = robot.joints.len();
        let fits = self.q.len() == n && nominal.len() == n;
        let unless = Refutation::unless;
        unless(CLAIM, "a witness has the robot's joints", self.q.len() as f64, n as f64, fits)?;
        let body = Body { mass: self.mass_kg, com: self.com_m, inertia: self.inertia_kg_m2 };
        let loaded = robot.plant_model_at(rotor).with_payload_on(frame, &body);
        let model = loaded.map_err(|why| Refutation {
            claim: CLAIM.to_owned(),
            inequality: why.to_string(),
            left: 0.0,
            right: 0.0,
        })?;
        let mut w = vec![0.0; n * n];
        model.mass_matrix(&mut Workspace::new(&model), &self.q, &mut w);
        for i in 0..n {
            for j in 0..n {
                w[i * n + j] /= (nominal[i] * nominal[j]).sqrt();
            }
        }
        Ok(w)
    }
}

impl Searched {
    /// Looks at both witnesses again: the arm has these eigenvalues there, at the ends of its spectrum.
    ///
    /// # Errors
    ///
    /// [`Refutation`] of the first that does not show what it says.
    pub fn replay(&self, robot: &Robot, nominal: &[f64]) -> Result<(), Refutation> {
        let low = self.low.matrix((robot, Rotor::Least), &self.frame, nominal)?;
        let high = self.high.matrix((robot, Rotor::Most), &self.frame, nominal)?;
        let holds = |inequality: &str, at: f64, holds: bool| {
            Refutation::unless(CLAIM, inequality, at, at, holds)
        };
        let (a, b) = (self.low.eigenvalue, self.high.eigenvalue);
        // W − a ≻ 0 for smaller a and not for larger; b − W likewise.
        let above = |at: f64| definite(&low, |i, j, w| w - if i == j { at } else { 0.0 });
        let below = |at: f64| definite(&high, |i, j, w| if i == j { at } else { 0.0 } - w);
        holds("no eigenvalue is below the low witness", a, above(a * (1.0 - ROUNDING)))?;
        holds("some eigenvalue is at the low witness", a, !above(a * (1.0 + ROUNDING)))?;
        holds("no eigenvalue is above the high witness", b, below(b * (1.0 + ROUNDING)))?;
        holds("some eigenvalue is at the high witness", b, !below(b * (1.0 - ROUNDING)))
    }

    /// Checks that its witnesses and proved bounds agree with a range `[low, high]`.
    ///
    /// # Errors
    ///
    /// The [`Refutation`].
    pub fn agrees(&self, low: f64, high: f64) -> Result<(), Refutation> {
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
        let (a, b) = (self.low.eigenvalue, self.high.eigenvalue);
        Refutation::unless(CLAIM, "low is that of its witness", low, a, close(low, a))?;
        Refutation::unless(CLAIM, "high is that of its witness", high, b, close(high, b))?;
        let Some(proved) = &self.proved else { return Ok(()) };
        let below = 0.0 <= proved.low && proved.low <= low * (1.0 + 1e-9);
        Refutation::unless(CLAIM, "what is proved holds the witness", proved.low, low, below)?;
        let above = high <= proved.high * (1.0 + 1e-9) && proved.high.is_finite();
        Refutation::unless(CLAIM, "what is proved holds the witness", high, proved.high, above)
    }

    /// The same, measured in `scale` times the nominal inertias.
    pub(crate) fn scaled(&self, scale: f64) -> Self {
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

/// Cholesky of a change of a symmetric matrix.
fn definite(w: &[f64], change: impl Fn(usize, usize, f64) -> f64) -> bool {
    let mut n = 0;
    while (n + 1) * (n + 1) <= w.len() {
        n += 1;
    }
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let mut left = change(i, j, w[i * n + j]);
            for k in 0..j {
                left -= l[i * n + k] * l[j * n + k];
            }
            if i != j {
                l[i * n + j] = left / l[j * n + j];
            } else if left > 0.0 {
                l[i * n + i] = left.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}
