//! Finding how fast the arm's inertia may change.

mod find;

pub use phihat_certificate::Moving;
use phihat_certificate::Unstable;

use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::polynomial::Polynomial;
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
}

impl FindMoving for Moving {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let about = cut(gains, model)?;
        let range = (low * (1.0 - 1e-9), high * (1.0 + 1e-9));
        find::largest(&about, range).map_err(refused)
    }
}

/// One joint's loop, cut where its torque meets the inertia.
#[derive(Debug)]
struct Cut<'a> {
    gains: &'a JointRecord,
    model: &'a LoopModel,
    open: OpenLoop,
    /// `K`.
    kick: Polynomial,
}

fn cut<'a>(gains: &'a JointRecord, model: &'a LoopModel) -> Result<Cut<'a>, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    if let Some(hz) = model.drive_bandwidth_hz {
        let inequality = "the torque acts at once: a drive's lag is not in the proof";
        return Err(refuse(CLAIM, inequality, hz, f64::MAX));
    }
    let (open, kick) = OpenLoop::with_kick(gains, model);
    Ok(Cut { gains, model, open, kick })
}

fn refused(why: Unstable) -> Refutation {
    refuse(CLAIM, why.inequality, why.left, why.right)
}
