//! Finding how fast the arm's inertia may change.

mod cut;
mod find;

pub use phihat_certificate::Moving;
use phihat_certificate::Unstable;

use super::model::LoopModel;
use super::refutation::refuse;
use crate::JointRecord;
use crate::claims::Refutation;
use cut::{CLAIM, Cut};

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
        let about = Cut::of(gains, model)?;
        let range = (low * (1.0 - 1e-9), high * (1.0 + 1e-9));
        find::largest(&about, range).map_err(refused)
    }
}

fn refused(why: Unstable) -> Refutation {
    refuse(CLAIM, why.inequality, why.left, why.right)
}
