//! Contradictions between values typed in a study and the model of its own robot.

use phihat_study::{InertiaSource, Study};
use thiserror::Error;

use crate::arm::{Arm, ArmError};

/// Relative slack: a figure that was copied from the model contradicts nothing.
const SLACK: f64 = 1e-9;

/// Postures for the range of each joint's own inertia, and the seed of their order.
const POSTURES: (usize, u64) = (1500, 1);

/// A typed value that the model of the study's own robot contradicts.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "{key}{}: {typed} {unit} is typed, and the model of the study's robot has {model:.6} {unit} ({what}); a typed \
     value must hold the model's", .joint.as_ref().map_or_else(String::new, |joint| format!(" of joint {joint}"))
)]
pub struct Contradiction {
    /// Key in the study.
    pub key: String,
    /// The joint; `None`: the arm.
    pub joint: Option<String>,
    /// Typed value.
    pub typed: f64,
    /// Value of the model.
    pub model: f64,
    /// The unit of both; empty for a ratio.
    pub unit: &'static str,
    /// Quantity of the model.
    pub what: &'static str,
}

/// Why typed knowledge cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ContradictionError {
    /// The model says otherwise.
    #[error("{0}")]
    Typed(Box<Contradiction>),
    /// The model cannot be asked.
    #[error("{0}")]
    Arm(#[from] ArmError),
}

impl From<Contradiction> for ContradictionError {
    fn from(found: Contradiction) -> Self {
        Self::Typed(Box::new(found))
    }
}

/// Checks that typed intervals of inertia contain the arm of the study's robot: for every joint its own
/// inertia, and for the coupled arm, at every posture and payload tried,
///
/// ```text
/// diag(low) ≼ M(q) ≼ diag(high)
/// ```
///
/// so that the eigenvalues of `M̄^{-1/2} M M̄^{-1/2}` lie between the typed ends over `M̄`, whatever `M̄` is.
///
/// Nothing is typed: nothing is contradicted.
///
/// # Errors
///
/// [`ContradictionError`].
pub fn typed_inertia_holds(study: &Study) -> Result<(), ContradictionError> {
    const KEYS: [&str; 2] = ["design.inertia_low_kg_m2", "design.inertia_high_kg_m2"];
    let InertiaSource::Typed { low, high } = &study.design.inertia else { return Ok(()) };
    let own = study.robot.inertia_range(POSTURES.0, POSTURES.1);
    for (i, joint) in study.robot.joints.iter().enumerate() {
        let of = |key: usize, typed: f64, model: f64, what| Contradiction {
            key: KEYS[key].to_owned(),
            joint: Some(joint.name.clone()),
            typed,
            model,
            unit: "kg·m²",
            what,
        };
        if own.min[i] < low[i] * (1.0 - SLACK) {
            let what = "the smallest over its postures, without payload";
            return Err(of(0, low[i], own.min[i], what).into());
        }
        if own.max[i] > high[i] * (1.0 + SLACK) {
            let what = "the largest over its postures, without payload";
            return Err(of(1, high[i], own.max[i], what).into());
        }
    }
    let mut described = study.clone();
    described.design.inertia = InertiaSource::Robot;
    let arm = Arm::of(&described)?;
    let of = |key: usize, model: f64, what| {
        let key = KEYS[key].to_owned();
        Contradiction { key, joint: None, typed: 1.0, model, unit: "", what }
    };
    let least = arm.against(low.clone())?.low;
    if least < 1.0 - SLACK {
        let what = "the coupled arm's smallest eigenvalue, with its payloads, measured in the typed low ends";
        return Err(of(0, least, what).into());
    }
    let most = arm.against(high.clone())?.high;
    if most > 1.0 + SLACK {
        let what = "the coupled arm's largest eigenvalue, with its payloads, measured in the typed high ends";
        return Err(of(1, most, what).into());
    }
    Ok(())
}
