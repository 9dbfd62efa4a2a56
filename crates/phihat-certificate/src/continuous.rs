//! Claims about the law in continuous time, at the nominal inertia.

use serde::{Deserialize, Serialize};

use crate::check::agree::agrees;
use crate::{Attenuation, Iss, NormH, Optimality, PaperRadius, PeakGains, Refutation, UnitLaw};

/// Claims of the paper's own kind: the law in continuous time, one joint by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContinuousLaw {
    /// Levels `γ` at which the law is optimal.
    pub attenuation: Attenuation,
    /// Inverse optimality at one `K̃`; `None` where no diagonal `Q` exists.
    pub optimality: Option<Optimality>,
    /// Input-to-state stability.
    pub iss: Iss,
    /// The paper's bound (40) on `|x|` per unit of `φ/M̄`, and the ultimate bound that holds.
    pub paper: PaperRadius,
    /// H-infinity norm from φ to the error.
    pub norm: NormH,
    /// Continuous peak-to-peak gains at `μ = 1`.
    pub peaks: PeakGains,
}

impl ContinuousLaw {
    pub(crate) fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        self.attenuation.verify(law)?;
        if let Some(optimality) = &self.optimality {
            optimality.verify(law)?;
        }
        self.paper.verify(law, &self.iss)?;
        for (claim, mu) in [("H-infinity norm", self.norm.mu), ("performance", self.peaks.mu)] {
            agrees(claim, "μ = 1", (mu, 1.0), 1e-12)?;
        }
        self.norm.verify(law)?;
        self.peaks.verify(law)
    }
}
