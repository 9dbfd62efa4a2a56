//! Finding how fast the arm's inertia may change.

mod cut;
mod find;

pub use phihat_certificate::Moving;
use phihat_certificate::Unstable;

use super::model::LoopModel;
use super::refutation::refuse;
use crate::JointRecord;
use crate::claims::Refutation;
use cut::{CLAIM, LoopCut};

/// Finding [`Moving`].
pub trait FindMoving: Sized {
    /// Finds the largest rate for joints with their laws in their loops, and a range of inertia.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when no rate is proved.
    fn find(loops: &[(&JointRecord, &LoopModel)], range: (f64, f64)) -> Result<Self, Refutation>;
}

impl FindMoving for Moving {
    fn find(
        loops: &[(&JointRecord, &LoopModel)],
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let mut about: Vec<LoopCut<'_>> = Vec::new();
        for (gains, model) in loops {
            if !about.iter().any(|known| known.is_of(gains, model)) {
                about.push(LoopCut::of(gains, model).map_err(|why| why.on(&gains.name))?);
            }
        }
        if about.is_empty() {
            return Err(refuse(CLAIM, "there is a joint", 0.0, 1.0));
        }
        let range = (low * (1.0 - 1e-9), high * (1.0 + 1e-9));
        let found = find::largest(&about, range).map_err(refused)?;
        found.verify(loops).map(|()| found)
    }
}

fn refused(why: Unstable) -> Refutation {
    refuse(CLAIM, why.inequality, why.left, why.right)
}
