//! What is known of an arm's inertia: the range that a constant nominal inertia has to stand for.

use nalgebra::DMatrix;
use phihat_model::{Body, Model, Workspace};
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Postures looked at per payload.
const POSTURES: u32 = 1500;

/// The arm's inertia against a nominal one.
///
/// # Claim
///
/// Over the postures and payloads tried, all eigenvalues of `M̄^{-1/2} M(q) M̄^{-1/2}` lie in `[low, high]`, rotor
/// inertia included.
///
/// # Not claimed
///
/// Postures between those tried. With a typed interval per joint: coupling between joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmInertia {
    /// Where the range comes from, in words.
    pub source: String,
    /// Nominal inertia `M̄` \[kg·m²\] per joint that the range is measured in.
    pub nominal_kg_m2: Vec<f64>,
    /// Smallest eigenvalue.
    pub low: f64,
    /// Largest eigenvalue.
    pub high: f64,
}

/// Why the range cannot be found.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ArmError {
    /// The payload cannot be attached.
    #[error("design.payload_max_kg: {0}")]
    Payload(String),
    /// A mass matrix is not positive definite.
    #[error("the mass matrix of the robot has an eigenvalue of {0} at some posture")]
    Mass(f64),
}

impl ArmInertia {
    /// The range of a study's arm, measured in the geometric mean of each joint's own range.
    ///
    /// # Errors
    ///
    /// [`ArmError`].
    pub fn of(study: &Study) -> Result<Self, ArmError> {
        if let Some((low, high)) = &study.design.inertia {
            let nominal: Vec<f64> = low.iter().zip(high).map(|(l, h)| (l * h).sqrt()).collect();
            return Ok(Self::typed(low, high, nominal));
        }
        let matrices = mass_matrices(study)?;
        let n = study.robot.joints.len();
        let diagonal = |i: usize| matrices.iter().map(move |m| m[(i, i)]);
        let nominal = (0..n)
            .map(|i| {
                let low = diagonal(i).fold(f64::INFINITY, f64::min);
                (low * diagonal(i).fold(0.0, f64::max)).sqrt()
            })
            .collect();
        Self::measured(study, &matrices, nominal)
    }

    /// The range of a study's arm, measured in given nominal inertias.
    ///
    /// # Errors
    ///
    /// [`ArmError`].
    pub fn against(study: &Study, nominal: Vec<f64>) -> Result<Self, ArmError> {
        match &study.design.inertia {
            Some((low, high)) => Ok(Self::typed(low, high, nominal)),
            None => Self::measured(study, &mass_matrices(study)?, nominal),
        }
    }

    /// The same arm measured in `scale` times the nominal inertias.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        Self {
            source: self.source.clone(),
            nominal_kg_m2: self.nominal_kg_m2.iter().map(|m| m * scale).collect(),
            low: self.low / scale,
            high: self.high / scale,
        }
    }

    fn typed(low: &[f64], high: &[f64], nominal: Vec<f64>) -> Self {
        let least = low.iter().zip(&nominal).map(|(l, m)| l / m).fold(f64::INFINITY, f64::min);
        let most = high.iter().zip(&nominal).map(|(h, m)| h / m).fold(0.0, f64::max);
        let source = "an interval per joint typed in the study; coupling is not in it".to_owned();
        Self { source, nominal_kg_m2: nominal, low: least, high: most }
    }

    fn measured(
        study: &Study,
        matrices: &[DMatrix<f64>],
        nominal: Vec<f64>,
    ) -> Result<Self, ArmError> {
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        for matrix in matrices {
            let n = matrix.nrows();
            let scaled =
                DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (nominal[i] * nominal[j]).sqrt());
            let eigenvalues = scaled.symmetric_eigenvalues();
            low = low.min(eigenvalues.min());
            high = high.max(eigenvalues.max());
        }
        if low.is_nan() || low <= 0.0 {
            return Err(ArmError::Mass(low));
        }
        let heaviest = heaviest(study);
        let source = format!(
            "{} postures inside the joint limits of {}, rotors included, payload 0 and {heaviest} kg",
            POSTURES, study.robot.name
        );
        Ok(Self { source, nominal_kg_m2: nominal, low, high })
    }
}

/// The design's payload, or the study's own if that is heavier.
fn heaviest(study: &Study) -> f64 {
    study.world.payload.as_ref().map_or(0.0, |p| p.mass).max(study.design.payload_max)
}

/// `M(q)` at every posture, without and with the heaviest payload.
fn mass_matrices(study: &Study) -> Result<Vec<DMatrix<f64>>, ArmError> {
    let bare = study.robot.plant_model();
    let mut models = vec![bare.clone()];
    let refuse = |why: String| ArmError::Payload(why);
    if study.design.payload_max > 0.0 {
        let tip = bare.frame(&study.robot.tip);
        let tip = tip.ok_or_else(|| refuse(format!("no frame {}", study.robot.tip)))?;
        let body = Body { mass: study.design.payload_max, com: [0.0; 3], inertia: [0.0; 6] };
        models.push(bare.clone().with_payload(tip, &body).map_err(|e| refuse(e.to_string()))?);
    }
    if let Some(own) = &study.world.payload {
        let frame = bare.frame(&own.frame);
        let frame = frame.ok_or_else(|| refuse(format!("no frame {}", own.frame)))?;
        let body = Body { mass: own.mass, com: own.com, inertia: own.inertia };
        models.push(bare.with_payload(frame, &body).map_err(|e| refuse(e.to_string()))?);
    }
    Ok(models.iter().flat_map(|model| sampled(model, study)).collect())
}

/// Postures from the additive recurrence on square roots of primes: even, and the same every time.
fn sampled(model: &Model, study: &Study) -> Vec<DMatrix<f64>> {
    const PRIMES: [f64; 16] = [
        2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0,
    ];
    let n = study.robot.joints.len();
    let mut workspace = Workspace::new(model);
    let mut entries = vec![0.0; n * n];
    let mut posture = |k: u32| {
        let q: Vec<f64> = (0..n)
            .map(|i| {
                let pi = core::f64::consts::PI;
                let (low, high) = study.robot.joints[i].position.unwrap_or((-pi, pi));
                let share = (f64::from(k) * PRIMES[i % PRIMES.len()].sqrt()).fract();
                low + share * (high - low)
            })
            .collect();
        model.mass_matrix(&mut workspace, &q, &mut entries);
        DMatrix::from_row_slice(n, n, &entries)
    };
    (1..=POSTURES).map(&mut posture).collect()
}
