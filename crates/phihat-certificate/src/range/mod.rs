//! Range of an arm's inertia over all postures and payloads, proved by cells.

mod bound;
mod energy;
mod moment;
mod search;

use phihat_model::{Joint, JointKind, Rotor};
use phihat_study::{InertiaSource, Study};
use serde::Serialize;

use bound::EndOfArm;
pub use bound::{OutsideRange, ProvedEnd};
use energy::{Energy, MOST_JOINTS};
use search::{EndSearch, Travel};

use crate::loaded::loaded;
use crate::{ArmInertia, Refutation};

/// Distance \[rad, m\] by which the ends of travel are moved outward.
const OUTWARD: f64 = 1e-9;

/// Range of inertia that holds at every posture inside the joints' travel and with every payload of a study.
///
/// # Claim
///
/// All eigenvalues of `M̄^{-1/2} M(q, p) M̄^{-1/2}` lie in `[low, high]`.
///
/// # Method
///
/// Over a cell of postures each joint's `(cos q, sin q)` lies in the triangle between the ends of its arc and the point
/// where the tangents there meet. With the derivatives `D` of the links' placements by the joints, which are affine in
/// each pair, and the moments `P ⪰ 0` of the bodies, `M = DᵀPD + R`, `R` the rotors. For corners `v` of the triangles
/// with weights `w_v` that make a posture, and `Δ_j(v)` the change of `D(v)` when joint `j` goes to the middle of its
/// arc,
///
/// ```text
/// M ⪯ Σ w_v (D(v)ᵀP D(v)) + R,      M ⪰ Σ w_v (D(v)ᵀP D(v) − Σ_j Δ_j(v)ᵀP Δ_j(v)) + R                     as (RI1)
/// ```
///
/// So one Cholesky factor per product of corners decides whether all of a cell is inside. The cell with the worst bound
/// is halved next, along the joint that adds most. Among payloads,
/// [`PayloadSet::heaviest`](phihat_study::PayloadSet::heaviest) and
/// [`PayloadSet::lightest`](phihat_study::PayloadSet::lightest) bound all others in the same order; so do the ends of
/// the rotors' intervals, and `R` alone bounds from below.
///
/// # Rounding
///
/// The error of a form that is computed in doubles is at most a multiple of the same sums of the sizes of all terms. It
/// is added once. Neighbouring cells share their computed corners, whose distance from the circle is checked, so the
/// accuracy of a sine counts only at the ends of travel, which are moved outward by 1e-9.
///
/// # Not claimed
///
/// The arm is that of `phihat-model`: placements at three positions of each joint, moments and rotors are doubles,
/// taken as they are.
///
/// # References
///
/// B. Efron, C. Stein, *The jackknife estimate of variance*, Annals of Statistics 9 (1981), for the second inequality.
/// N. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, section 3.1 and theorem 10.5, for rounding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangeProof {
    /// No eigenvalue is below.
    pub low: f64,
    /// No eigenvalue is above.
    pub high: f64,
    /// Cells looked at.
    pub cells: u64,
    /// Step that is not done yet; `None`: both ends are as tight as they are sought.
    pub step: Option<RangeStep>,
    /// Posture that shows that the stated range is too narrow.
    pub outside: Option<OutsideRange>,
}

/// Factor within which an end of a range is being proved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RangeStep {
    /// Factor between the end that is to be proved and the stated one.
    pub factor: f64,
    /// Share of all postures over which it is.
    pub done: f64,
}

/// Reason why a range of inertia cannot be proved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RangeUnproved {
    /// The study types or estimates the range.
    #[error(
        "the range of inertia is typed or estimated in the study; only that of a robot's description can be proved"
    )]
    NotOfARobot,
    /// Nominal inertias and joints differ in number.
    #[error(
        "{nominal} nominal inertias for {joints} joints; valid: one each, for 32 joints at most"
    )]
    Joints {
        /// Number of nominal inertias.
        nominal: usize,
        /// Number of joints of the robot.
        joints: usize,
    },
    /// A body of the description is none.
    #[error("a body of {0} has no mass and yet a centre of mass away from its origin")]
    NoBody(String),
    /// The payload cannot be attached.
    #[error(transparent)]
    Payload(#[from] Refutation),
}

impl RangeProof {
    /// Proves the range of a study's arm within factors of 1.5, 1.19, 1.09, 1.04, 1.02 and 1.005 of a stated one, as
    /// far as `go_on` lets it: it is called with what is proved until then. Ends at a posture that is outside of the
    /// stated range by more than 0.1 %.
    ///
    /// # Errors
    ///
    /// [`RangeUnproved`].
    pub fn of(
        study: &Study,
        stated: &ArmInertia,
        go_on: &mut dyn FnMut(&Self) -> bool,
    ) -> Result<Self, RangeUnproved> {
        let mut low = search(study, stated, ProvedEnd::Low)?;
        let mut high = search(study, stated, ProvedEnd::High)?;
        loop {
            let cells = low.cells + high.cells;
            let outside = low.outside.clone().or_else(|| high.outside.clone());
            // The end that is less tight; of two as tight, the one that cost less.
            let low_next = (low.stage, low.cells) < (high.stage, high.cells);
            let step = if low_next { low.under_way() } else { high.under_way() };
            let step = step.map(|(factor, done)| RangeStep { factor, done });
            let proof = Self { low: low.proved(), high: high.proved(), cells, step, outside };
            if proof.step.is_none() || proof.outside.is_some() || !go_on(&proof) {
                return Ok(proof);
            }
            if low_next { low.step() } else { high.step() }
        }
    }
}

/// Search for one end of the range.
fn search(study: &Study, stated: &ArmInertia, end: ProvedEnd) -> Result<EndSearch, RangeUnproved> {
    let joints = &study.robot.joints;
    if !matches!(study.design.inertia, InertiaSource::Robot) {
        return Err(RangeUnproved::NotOfARobot);
    }
    let nominal = stated.nominal_kg_m2.clone();
    if nominal.len() != joints.len() || !(1..=MOST_JOINTS).contains(&joints.len()) {
        return Err(RangeUnproved::Joints { nominal: nominal.len(), joints: joints.len() });
    }
    let set = &study.design.payload;
    let (rotor, bodies, stated) = match end {
        ProvedEnd::Low => (Rotor::Least, vec![set.lightest()], stated.low),
        ProvedEnd::High => (Rotor::Most, set.heaviest(), stated.high),
    };
    let models = bodies.iter().map(|body| loaded(study, (rotor, body), &set.frame));
    let models: Vec<_> = models.collect::<Result<_, _>>()?;
    let slides: Vec<bool> = joints.iter().map(|j| j.kind == JointKind::Prismatic).collect();
    let energy = Energy::new(&study.robot.plant_model_at(rotor), &models, &slides)
        .ok_or_else(|| RangeUnproved::NoBody(study.robot.name.clone()))?;
    let travel: Vec<Travel> = joints.iter().map(travel).collect();
    Ok(EndSearch::new(EndOfArm { end, energy, nominal, slides }, &travel, stated))
}

/// A joint's ends of travel, moved outward; one turn where it has no ends or more than a turn.
fn travel(joint: &Joint) -> Travel {
    let pi = core::f64::consts::PI;
    let (low, high) = joint.position.unwrap_or((-pi, pi));
    let within_a_turn = high - low < 2.0 * pi;
    let (low, high) =
        if joint.kind == JointKind::Prismatic || within_a_turn { (low, high) } else { (-pi, pi) };
    (low - OUTWARD, high + OUTWARD)
}
