//! From a specification to gains with a certificate, or a "no" with its reason.

mod advice;
mod candidate;
mod infeasible;
mod known;
mod nominal;
mod paper;
mod refine;
mod search;
mod verdict;

use phihat_study::{DesignMethod, Study};
use thiserror::Error;

pub use advice::{Alternative, alternatives};
pub use infeasible::{Clause, Infeasible};

use crate::Gains;
use crate::Phi;
use crate::arm::{Arm, ArmError};
use crate::claims::{PaperError, Refutation};
use candidate::Candidate;
use search::{COARSE, FINE, Grid, Search};
use verdict::{KEYS, Nearest};

/// What is known of `φ` for a joint and its nominal inertia.
pub type PhiOf<'a> = &'a dyn Fn(usize, f64) -> Phi;

/// What a design comes to: gains, or why there are none.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Gains with their certificate: by our method they keep every clause; by the paper's the certificate says
    /// what holds.
    Designed(Box<Gains>),
    /// No gains keep every clause.
    Infeasible(Infeasible),
}

/// Why a design cannot begin.
#[derive(Debug, Error)]
pub enum DesignError {
    /// The study does not say which error is allowed.
    #[error("spec.error_max_rad is missing: a design needs the largest error you can live with")]
    NoSpec,
    /// The paper's recipe lacks a limit.
    #[error("{0} is missing: the paper's recipe starts from φ_max and limits on ∫e, e and ė")]
    PaperSpec(&'static str),
    /// The paper's recipe has no gains for these limits.
    #[error("the paper's recipe: {0}")]
    Paper(#[from] PaperError),
    /// The arm's inertia cannot be found.
    #[error("{0}")]
    Arm(#[from] ArmError),
    /// A claim that the search relies on cannot be made.
    #[error("{0}")]
    Claim(#[from] Refutation),
}

/// Finds gains that keep a study's specification, by the method it asks for.
///
/// # Method
///
/// All joints share `K_p = ω²`, `K_d = 2ω` and the estimator (all poles at `ω_o`), so that the eigenvalue
/// argument holds for the coupled arm; `M̄` is shared out so that the joints with the worst error have more of
/// it. Over a grid of order, `ω`, `ω_o/ω`, a common factor on `M̄` and, where it is left to the design, the
/// velocity filter: those that keep the inertia window with its margin, in the order of the torque that
/// encoder steps cause; the first whose certified bounds keep the specification is taken. Where none does,
/// the search goes on between the points of the grid. What is infeasible in the end is told with the
/// nearest value of each clause, and with changes of the loop that make it feasible.
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
/// #     error_max_rad = 0.02
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
    if let Outcome::Infeasible(no) = &mut outcome {
        no.alternatives = alternatives(study, arm, phi)?;
    }
    Ok(outcome)
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
    let search = Search::new(study, arm, phi)?;
    let attempt = Attempt::of(&search, &FINE)?;
    if let Some(gains) = attempt.gains {
        return Ok(Outcome::Designed(Box::new(gains)));
    }
    let clauses = search.clauses(&attempt.nearest);
    let (tried, stable) = (attempt.tried, attempt.stable);
    Ok(Outcome::Infeasible(Infeasible { clauses, alternatives: Vec::new(), tried, stable }))
}

/// One search for gains.
struct Attempt {
    gains: Option<Gains>,
    nearest: Nearest,
    tried: u32,
    stable: u32,
}

impl Attempt {
    fn of(search: &Search<'_>, grid: &Grid) -> Result<Self, DesignError> {
        let (mut candidates, tried) = search.candidates(grid);
        candidates.sort_by(|a, b| a.noise().total_cmp(&b.noise()));
        let stable = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
        let mut found = Self { gains: None, nearest: Nearest::default(), tried, stable };
        let mut verdicts = Vec::with_capacity(candidates.len());
        for candidate in &candidates {
            let verdict = search.judge(candidate);
            if verdict.within() && found.take(search, &candidates, candidate)? {
                return Ok(found);
            }
            found.nearest.note(&verdict);
            verdicts.push(verdict);
        }
        for clause in (0..KEYS.len()).filter(|clause| search.limit(*clause).is_some()) {
            for &order in &search.study.design.orders {
                let of_order =
                    (0..candidates.len()).filter(|i| candidates[*i].shape.order == order);
                let price = |i: &usize| refine::cost(&verdicts[*i], clause);
                let Some(start) = of_order.min_by(|a, b| price(a).total_cmp(&price(b))) else {
                    continue;
                };
                if price(&start) > grid.reach {
                    continue;
                }
                let (mut quietest, mut closest): (Option<Candidate>, Option<(f64, Candidate)>) =
                    (None, None);
                search.refine(&candidates[start], clause, |candidate, verdict| {
                    found.nearest.note(verdict);
                    if !verdict.within() {
                        return;
                    }
                    let cost = refine::cost(verdict, clause);
                    if quietest.as_ref().is_none_or(|q| candidate.noise() < q.noise()) {
                        quietest = Some(candidate.clone());
                    }
                    if closest.as_ref().is_none_or(|(least, _)| cost < *least) {
                        closest = Some((cost, candidate.clone()));
                    }
                });
                // The estimate that is furthest inside may hold where the quietest does not.
                for candidate in quietest.iter().chain(closest.iter().map(|(_, c)| c)) {
                    if found.take(search, &candidates, candidate)? {
                        return Ok(found);
                    }
                }
            }
        }
        Ok(found)
    }

    /// Takes a candidate if its certificate keeps the specification too.
    fn take(
        &mut self,
        search: &Search<'_>,
        candidates: &[Candidate],
        chosen: &Candidate,
    ) -> Result<bool, DesignError> {
        let Some(mut gains) = search.certify(chosen)? else { return Ok(false) };
        let mut all = candidates.to_vec();
        if !all.contains(chosen) {
            let at = all.partition_point(|other| other.noise() < chosen.noise());
            all.insert(at, chosen.clone());
        }
        gains.trade_off = search.trade_off(&all, chosen);
        self.gains = Some(gains);
        Ok(true)
    }
}
