//! An arm's postures with the lightest and the heaviest payloads, and the eigenvalues there.

use core::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use phihat_model::{Body, Joint, JointKind, Model, Rotor, Workspace, evenly};
use phihat_study::{PayloadSet, Study};

use super::error::ArmError;

/// Postures inside the joints' travel looked at per payload.
pub(super) const SAMPLES: u32 = 1500;

/// An arm with one of the payloads that decide.
#[derive(Debug, Clone)]
pub(super) struct Loaded {
    pub(super) body: Body,
    pub(super) model: Model,
}

/// `M(q)` at a posture, with the payload of an index.
#[derive(Debug, Clone)]
pub(super) struct PostureInertia {
    pub(super) q: Vec<f64>,
    pub(super) payload: usize,
    pub(super) matrix: DMatrix<f64>,
}

/// All postures looked at.
#[derive(Debug, Clone)]
pub(super) struct PostureSet {
    pub(super) frame: String,
    /// The lightest; the heaviest ones; and, where these are several, a body between them.
    pub(super) payloads: Vec<Loaded>,
    /// Number of heaviest payloads among them, from index 1 on.
    pub(super) heaviest: usize,
    /// Ends of travel \[rad, m\]; one turn where a joint has no ends.
    pub(super) travel: Vec<(f64, f64)>,
    pub(super) slides: Vec<bool>,
    /// With the lightest payload, and with heavy ones.
    pub(super) light: Vec<PostureInertia>,
    pub(super) heavy: Vec<PostureInertia>,
    /// Position and velocity at points of a reference.
    pub(super) passing: Vec<(Vec<f64>, Vec<f64>)>,
    /// Largest speeds \[rad/s, m/s\].
    pub(super) speeds: Vec<Option<f64>>,
}

impl PostureSet {
    /// Samples a study's robot.
    pub(super) fn of(study: &Study) -> Result<Self, ArmError> {
        let set = &study.design.payload;
        let mut bodies = vec![set.lightest()];
        let heaviest = set.heaviest();
        let count = heaviest.len();
        bodies.extend(heaviest);
        if count > 1 {
            bodies.push(between(set));
        }
        // `M(q) + diag(J)` grows with each rotor: its ends are at those of their intervals.
        let (light, heavy) = (Rotor::Least, Rotor::Most);
        let bare = |rotor: Rotor| study.robot.plant_model_at(rotor);
        let load = |(at, body): (usize, Body)| {
            let bare = bare(if at == 0 { light } else { heavy });
            let model = bare.with_payload_on(&set.frame, &body);
            model.map(|model| Loaded { body, model }).map_err(|e| ArmError::Payload(e.to_string()))
        };
        let mut postures = Self {
            frame: set.frame.clone(),
            payloads: bodies.into_iter().enumerate().map(load).collect::<Result<_, _>>()?,
            heaviest: count,
            travel: study.robot.joints.iter().map(travel).collect(),
            slides: study.robot.joints.iter().map(|j| j.kind == JointKind::Prismatic).collect(),
            light: Vec::new(),
            heavy: Vec::new(),
            passing: Vec::new(),
            speeds: study.robot.joints.iter().map(|joint| joint.velocity_max).collect(),
        };
        let last = postures.payloads.len() - 1;
        for q in evenly(&postures.travel, SAMPLES) {
            postures.light.push(postures.tried(&q, 0)?);
            postures.heavy.push(postures.tried(&q, last)?);
        }
        Ok(postures)
    }

    /// Looks at the postures of a reference too, with every heaviest payload.
    pub(super) fn along(&mut self, reference: &[(Vec<f64>, Vec<f64>)]) -> Result<(), ArmError> {
        let n = self.travel.len();
        for (q, dq) in reference.iter().filter(|(q, dq)| q.len() == n && dq.len() == n) {
            self.light.push(self.tried(q, 0)?);
            for payload in 1..=self.heaviest {
                self.heavy.push(self.tried(q, payload)?);
            }
            self.passing.push((q.clone(), dq.clone()));
        }
        Ok(())
    }

    /// Number of postures of a reference.
    pub(super) fn of_reference(&self) -> u32 {
        u32::try_from(self.passing.len()).unwrap_or(u32::MAX)
    }

    /// Number of postures tried.
    pub(super) fn count(&self) -> u32 {
        u32::try_from(self.light.len()).unwrap_or(u32::MAX)
    }

    fn tried(&self, q: &[f64], payload: usize) -> Result<PostureInertia, ArmError> {
        let (n, model) = (q.len(), &self.payloads[payload].model);
        let mut entries = vec![0.0; n * n];
        model.mass_matrix(&mut Workspace::new(model), q, &mut entries);
        if !entries.iter().all(|entry| entry.is_finite()) {
            return Err(ArmError::NotFinite(q.to_vec()));
        }
        Ok(PostureInertia {
            q: q.to_vec(),
            payload,
            matrix: DMatrix::from_row_slice(n, n, &entries),
        })
    }
}

/// The heaviest body with the mean of the corners' second moments about the box's centre.
fn between(set: &PayloadSet) -> Body {
    let moment = 3.0 * set.second_moment();
    let spread = set.com.map(|(low, high)| {
        let half = 0.5 * (high - low);
        moment + set.mass.1 * half * half
    });
    let [x, y, z] = spread;
    let com = set.com.map(|(low, high)| 0.5 * (low + high));
    Body { mass: set.mass.1, com, inertia: [y + z, 0.0, 0.0, x + z, 0.0, x + y] }
}

/// A joint's ends of travel; one turn about 0 or about its middle where that is all there is to see.
fn travel(joint: &Joint) -> (f64, f64) {
    let (low, high) = joint.position.unwrap_or((-PI, PI));
    match joint.kind {
        _ if !(high - low).is_finite() => (-PI, PI),
        JointKind::Prismatic => (low, high),
        _ if high - low > 2.0 * PI => (0.5 * (low + high) - PI, 0.5 * (low + high) + PI),
        _ => (low, high),
    }
}

/// `M̄^{-1/2} M M̄^{-1/2}`.
pub(super) fn scaled(matrix: &DMatrix<f64>, nominal: &[f64]) -> DMatrix<f64> {
    let n = matrix.nrows();
    DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (nominal[i] * nominal[j]).sqrt())
}

/// `M̄^{-1/2} M(q) M̄^{-1/2}`.
pub(super) fn scaled_mass_matrix(
    model: &Model,
    workspace: &mut Workspace,
    q: &[f64],
    nominal: &[f64],
) -> DMatrix<f64> {
    let n = q.len();
    let mut entries = vec![0.0; n * n];
    model.mass_matrix(workspace, q, &mut entries);
    scaled(&DMatrix::from_row_slice(n, n, &entries), nominal)
}

/// An eigenvalue with its vector.
pub(super) type Eigen = (f64, DVector<f64>);

/// Smallest and largest eigenvalue of a symmetric matrix, with their vectors.
pub(super) fn eigen(w: &DMatrix<f64>) -> (Eigen, Eigen) {
    let all = w.clone().symmetric_eigen();
    let of = |i: usize| (all.eigenvalues[i], all.eigenvectors.column(i).into_owned());
    let (mut low, mut high) = (0, 0);
    for i in 0..all.eigenvalues.len() {
        low = if all.eigenvalues[i] < all.eigenvalues[low] { i } else { low };
        high = if all.eigenvalues[i] > all.eigenvalues[high] { i } else { high };
    }
    (of(low), of(high))
}
