//! From a specification to a candidate, joint by joint, or the reason why there is none.

mod advice;
mod attempt;
mod candidate;
pub(crate) mod error;
pub(crate) mod infeasible;
pub(crate) mod known;
mod loops;
pub(crate) mod nominal;
pub(crate) mod outcome;
mod paper;
mod refine;
mod search;
mod verdict;

use phihat::Form;
use phihat_study::{DesignMethod, Study};

pub use advice::{Alternative, alternatives};
pub use error::DesignError;
pub use infeasible::{Clause, Infeasible};
pub use known::PhiOf;
pub use outcome::Outcome;

use crate::arm::Arm;
use crate::positions;
use attempt::Attempt;
use search::{DesignSearch, FINE};

/// Finds a candidate for a study's specification, by the method that the study states.
///
/// # Method
///
/// All joints share `K_p = ω²`, `K_d = 2ω` and the estimator (all poles at `ω_o`), so that the eigenvalue
/// argument holds for the coupled arm; `M̄` is shared out so that the joints with the worst error have more of
/// it. Over a grid of order, `ω`, `ω_o/ω`, a common factor on `M̄` and, where it is left to the design, the
/// velocity filter: those that keep the inertia window with its margin, in the order of the torque that
/// encoder steps cause; the first is taken whose errors keep the specification by its certified gains and `φ`, each
/// joint by itself. Where none does,
/// the search goes on between the points of the grid. What is infeasible in the end is told with the
/// nearest value of each clause, and with changes of the loop that make it feasible.
///
/// # Not claimed
///
/// That a coupled arm keeps the specification: joints push each other, and the certificate bounds no error until a tube
/// does.
///
/// # Errors
///
/// [`DesignError`]. That no gains exist is an [`Outcome`].
///
/// # Example
///
/// ```
/// use phihat_design::{Arm, Outcome, Phi, PhiBasis, design};
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 0.02
/// #     [design]
/// #     orders = [1]
/// #     payload_max_kg = 0.2
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = phihat_study::Study::from_text(text, "demo.toml", "".as_ref())?;
/// // `study` states the largest error and the largest payload, and no gains.
/// let arm = Arm::of(&study)?;
/// // What is known of φ beforehand: how fast it changes, and how far it jumps, per joint.
/// let phi = |_joint: usize, _inertia: f64| Phi {
///     basis: PhiBasis::Typed,
///     source: "an estimate by hand".to_owned(),
///     size_nm: Some(15.0),
///     rate_nm_s: 30.0,
///     jump_nm: 0.5,
///     motion: None,
/// };
/// match design(&study, &arm, &phi)? {
///     Outcome::Designed(gains) => {
///         let certificate = gains.certificate.as_ref().ok_or("no certificate")?;
///         certificate.verify(&gains)?;
///     }
///     Outcome::Infeasible(no) => println!("{} is in the way", no.clauses[0].key),
///     _ => {}
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn design(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Outcome, DesignError> {
    let mut outcome = search(study, arm, phi)?;
    if let Outcome::Infeasible(no) = &mut outcome
        && study.control.form != Form::Positions
    {
        no.alternatives = alternatives(study, arm, phi)?;
    }
    Ok(outcome)
}

/// Order of a law of the search of [`design`] that satisfies every clause by the search's own estimates;
/// `None`: there is none. Uncertified, and much quicker where there is one.
///
/// # Errors
///
/// [`DesignError`].
pub fn has_law(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Option<usize>, DesignError> {
    Ok(DesignSearch::new(study, arm, phi)?.any(&FINE))
}

/// Finds gains as [`design`] does, without looking for [`alternatives`], each of which is a search of its own.
///
/// # Errors
///
/// [`DesignError`].
pub fn search(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Outcome, DesignError> {
    if study.design.method == DesignMethod::Paper {
        return paper::design(study, arm, phi).map(|gains| Outcome::Designed(Box::new(gains)));
    }
    if study.control.form == Form::Positions {
        return positions::search(study, arm, phi);
    }
    let search = DesignSearch::new(study, arm, phi)?;
    let attempt = Attempt::of(&search, &FINE)?;
    if let Some(gains) = attempt.gains {
        return Ok(Outcome::Designed(Box::new(gains)));
    }
    let clauses = search.clauses(&attempt.nearest);
    Ok(Outcome::Infeasible(Infeasible {
        clauses,
        alternatives: Vec::new(),
        tried: attempt.tried,
        stable: attempt.stable,
        words: vec![search.words(attempt.fastest)],
        beyond_any_law: false,
        nearest: attempt.closest(&search),
        front: attempt.front,
    }))
}
