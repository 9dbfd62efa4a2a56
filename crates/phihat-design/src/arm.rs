//! What is known of an arm's inertia: the range that a constant nominal inertia has to stand for.

use nalgebra::DMatrix;
use phihat_certificate::{ArmBasis, ArmInertia};
use phihat_model::{Body, Model, Workspace};
use phihat_study::{InertiaSource, Study};
use thiserror::Error;

use crate::trace::InertiaEstimate;

/// Postures looked at per payload.
const POSTURES: u32 = 1500;

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
    /// The study wants an estimate from a trace that was not given.
    #[error("design.inertia_from is \"trace\": the trace's estimate is missing")]
    NoEstimate,
}

/// What is known of an arm's inertia, whatever the nominal one: looked up once, measured often.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    basis: ArmBasis,
    source: String,
    knowledge: Knowledge,
}

#[derive(Debug, Clone, PartialEq)]
enum Knowledge {
    /// `M(q)` at every posture, with every payload.
    Matrices(Vec<DMatrix<f64>>),
    /// Low and high \[kg·m²\] per joint.
    Intervals(Vec<f64>, Vec<f64>),
}

impl Arm {
    /// A study's arm, from its robot's postures or the intervals it types.
    ///
    /// # Errors
    ///
    /// [`ArmError`]; an estimate from a trace is made by [`Self::estimated`].
    pub fn of(study: &Study) -> Result<Self, ArmError> {
        match &study.design.inertia {
            InertiaSource::Robot => Self::sampled(study),
            InertiaSource::Typed { low, high } => Ok(Self {
                basis: ArmBasis::Typed,
                source: "an interval per joint typed in the study; coupling is not in it".into(),
                knowledge: Knowledge::Intervals(low.clone(), high.clone()),
            }),
            InertiaSource::Trace(_) => Err(ArmError::NoEstimate),
        }
    }

    /// An arm known by what a trace shows of it.
    pub fn estimated(estimates: &[InertiaEstimate]) -> Self {
        let windows = estimates.iter().map(|e| e.windows).min().unwrap_or(0);
        Self {
            basis: ArmBasis::Trace,
            source: format!(
                "ESTIMATE from a recorded trace, not a proof: regression over {windows} or more windows per \
                 joint, ± 3 standard errors; coupling is not in it"
            ),
            knowledge: Knowledge::Intervals(
                estimates.iter().map(|e| e.low_kg_m2).collect(),
                estimates.iter().map(|e| e.high_kg_m2).collect(),
            ),
        }
    }

    fn sampled(study: &Study) -> Result<Self, ArmError> {
        Ok(Self {
            basis: ArmBasis::Postures,
            source: format!(
                "{POSTURES} postures inside the joint limits of {}, rotors included, payload 0 and {} kg",
                study.robot.name,
                heaviest(study)
            ),
            knowledge: Knowledge::Matrices(mass_matrices(study)?),
        })
    }

    /// The geometric mean of each joint's own range \[kg·m²\]: a good nominal inertia.
    pub fn nominal(&self) -> Vec<f64> {
        match &self.knowledge {
            Knowledge::Intervals(low, high) => {
                low.iter().zip(high).map(|(l, h)| (l * h).sqrt()).collect()
            }
            Knowledge::Matrices(matrices) => {
                let n = matrices.first().map_or(0, DMatrix::nrows);
                let mean = |i: usize| {
                    let diagonal = || matrices.iter().map(|m| m[(i, i)]);
                    let low = diagonal().fold(f64::INFINITY, f64::min);
                    (low * diagonal().fold(0.0, f64::max)).sqrt()
                };
                (0..n).map(mean).collect()
            }
        }
    }

    /// The same arm known by fewer postures only: those with the smallest and the largest eigenvalues against
    /// some nominal inertias.
    pub(crate) fn extremes(&self, nominal: &[f64], count: usize) -> Self {
        let Knowledge::Matrices(matrices) = &self.knowledge else { return self.clone() };
        let ranges: Vec<(f64, f64)> =
            matrices.iter().map(|m| eigenvalues(core::slice::from_ref(m), nominal)).collect();
        let mut by_low: Vec<usize> = (0..matrices.len()).collect();
        let mut by_high = by_low.clone();
        by_low.sort_by(|a, b| ranges[*a].0.total_cmp(&ranges[*b].0));
        by_high.sort_by(|a, b| ranges[*b].1.total_cmp(&ranges[*a].1));
        let few = by_low.iter().take(count).chain(by_high.iter().take(count));
        let few = few.map(|i| matrices[*i].clone()).collect();
        Self { knowledge: Knowledge::Matrices(few), ..self.clone() }
    }

    /// The range of inertia, measured in given nominal inertias \[kg·m²\].
    ///
    /// # Errors
    ///
    /// [`ArmError::Mass`].
    pub fn against(&self, nominal: Vec<f64>) -> Result<ArmInertia, ArmError> {
        let (low, high) = match &self.knowledge {
            Knowledge::Intervals(low, high) => (
                low.iter().zip(&nominal).map(|(l, m)| l / m).fold(f64::INFINITY, f64::min),
                high.iter().zip(&nominal).map(|(h, m)| h / m).fold(0.0, f64::max),
            ),
            Knowledge::Matrices(matrices) => eigenvalues(matrices, &nominal),
        };
        if low.is_nan() || low <= 0.0 {
            return Err(ArmError::Mass(low));
        }
        let (basis, source) = (self.basis, self.source.clone());
        Ok(ArmInertia { basis, source, nominal_kg_m2: nominal, low, high })
    }
}

/// Smallest and largest eigenvalue of all `M̄^{-1/2} M M̄^{-1/2}`.
fn eigenvalues(matrices: &[DMatrix<f64>], nominal: &[f64]) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for matrix in matrices {
        let n = matrix.nrows();
        let scaled =
            DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (nominal[i] * nominal[j]).sqrt());
        let eigenvalues = scaled.symmetric_eigenvalues();
        low = low.min(eigenvalues.min());
        high = high.max(eigenvalues.max());
    }
    (low, high)
}

/// The design's payload, or the study's own if that is heavier.
fn heaviest(study: &Study) -> f64 {
    study.world.payload.as_ref().map_or(0.0, |p| p.mass).max(study.design.payload_max)
}

/// `M(q)` at every posture, without and with the heaviest payload.
fn mass_matrices(study: &Study) -> Result<Vec<DMatrix<f64>>, ArmError> {
    let bare = study.robot.plant_model();
    let with = |frame: &str, body: &Body| {
        bare.clone().with_payload_on(frame, body).map_err(|e| ArmError::Payload(e.to_string()))
    };
    let mut models = vec![bare.clone()];
    if study.design.payload_max > 0.0 {
        let body = Body { mass: study.design.payload_max, com: [0.0; 3], inertia: [0.0; 6] };
        models.push(with(&study.robot.tip, &body)?);
    }
    if let Some(own) = &study.world.payload {
        models.push(with(&own.frame, &own.body())?);
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
