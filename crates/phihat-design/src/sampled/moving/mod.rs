//! Finding how fast the arm's inertia may change.

mod find;

pub use phihat_certificate::Moving;
use phihat_certificate::{Failure, Loop};

use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::refutation::{plausible, plausible_loop, refuse};
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "stability while moving";

/// Finding [`Moving`].
pub trait FindMoving: Sized {
    /// Finds the largest rate for a range of inertia.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when no rate is proved.
    fn find(gains: &JointRecord, model: &LoopModel, range: (f64, f64)) -> Result<Self, Refutation>;

    /// Checks the claim for one joint's gains and loop; they have to be the same for all joints.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which the proof fails.
    fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation>;
}

impl FindMoving for Moving {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let about = cut(gains, model)?;
        let range = (low * (1.0 - 1e-9), high * (1.0 + 1e-9));
        find::largest(&about, range, model.period_s).map_err(refused)
    }

    fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        self.check(&cut(gains, model)?, model.period_s)
    }
}

/// The loop cut at the inertia.
fn cut(gains: &JointRecord, model: &LoopModel) -> Result<Loop, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    if let Some(hz) = model.drive_bandwidth_hz {
        let inequality = "the torque acts at once: a drive's lag is not in the proof";
        return Err(refuse(CLAIM, inequality, hz, f64::INFINITY));
    }
    let (open, kick) = OpenLoop::with_kick(gains, model);
    let coefficients = |p: &super::polynomial::Polynomial| p.coefficients().to_vec();
    Ok(Loop {
        numerator: coefficients(&open.numerator),
        denominator: coefficients(&open.denominator),
        kick: coefficients(&kick),
    })
}

fn refused(why: Failure) -> Refutation {
    refuse(CLAIM, why.inequality, why.left, why.right)
}
