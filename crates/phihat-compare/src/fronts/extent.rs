//! Extent of a comparison at equal noise.

use serde::{Deserialize, Serialize};

use crate::protocol::{CAPS, FOLLOWING, PER_SCALAR, SPLITS};

/// Extent of a comparison at equal noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrontsExtent {
    /// Caps on noise above 50 Hz, over the torque limit: one tuning each, all of one search.
    pub caps: Vec<f64>,
    /// Searches of each law, the first from its default values, the others from random ones.
    pub restarts: u64,
    /// Evaluations of a search for each free scalar and one more under the loosest cap; under every other cap
    /// a quarter as many, from the best candidate so far.
    pub per_scalar: usize,
    /// Largest number of times that ranges are widened tenfold at ends that are hit.
    pub widenings: usize,
    /// Worlds to train in, to choose by, to be judged in.
    pub worlds: [u32; 3],
    /// Length of a run, and where its scored part begins \[s\].
    pub span: (f64, f64),
    /// Decides all that is drawn.
    pub seed: u64,
}

impl FrontsExtent {
    /// Extent for publication: days on two cores.
    pub fn full() -> Self {
        Self {
            caps: CAPS.to_vec(),
            restarts: 10,
            per_scalar: PER_SCALAR,
            widenings: 2,
            worlds: SPLITS.map(|(_, count)| count),
            span: (5.0, 1.0),
            seed: 1,
        }
    }

    /// Enough to see the page, and that every law can be tuned.
    pub fn quick() -> Self {
        Self {
            caps: vec![2e-3, 1e-2],
            restarts: 2,
            per_scalar: 6,
            widenings: 1,
            worlds: [2, 2, 4],
            span: (2.0, 1.0),
            ..Self::full()
        }
    }

    /// Evaluations of one search of a law with so many free scalars, under all caps, if no range gives way.
    pub fn evaluations(&self, scalars: usize) -> usize {
        let following = self.per_scalar.div_ceil(FOLLOWING) * self.caps.len().saturating_sub(1);
        if scalars == 0 { 1 } else { (self.per_scalar + following) * (scalars + 1) }
    }
}
