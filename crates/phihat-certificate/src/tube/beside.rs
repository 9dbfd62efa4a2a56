//! A claimed tube beside one that was derived again.

use serde::Serialize;

use crate::{Refutation, Tube, TubeJoint};

const CLAIM: &str = "tube";

/// How much tighter than the derivation a bin of an honest file may be.
pub const TIGHTER: f64 = 1.5;

/// What both derivations may differ by where nothing but rounding is left \[rad, rad/s\].
const FLOOR: (f64, f64) = (1e-7, 1e-5);

/// One joint of a tube beside the derivation; errors from the tube's `settle_s` on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointBeside {
    /// Joint name.
    pub name: String,
    /// Largest |e| \[rad\] that is claimed, and that is derived here.
    pub error_max_rad: (f64, f64),
    /// Largest |ė| \[rad/s\], likewise.
    pub velocity_error_max_rad_s: (f64, f64),
    /// How much tighter than the derivation the tightest bin is: in `e`, in `ė`.
    pub tightest: (f64, f64),
}

/// Holds a tube against one that was derived for the same study.
///
/// # Errors
///
/// [`Refutation`]: the tube is about something else, or claims more than is derived here.
pub fn beside(claimed: &Tube, own: &Tube) -> Result<Vec<JointBeside>, Refutation> {
    let pairs = claimed.joints.iter().zip(&own.joints);
    pairs.map(|(claim, own)| joint(claim, own)).collect()
}

fn joint(claim: &TubeJoint, own: &TubeJoint) -> Result<JointBeside, Refutation> {
    let e = tightest((&claim.error_low_rad, &claim.error_high_rad), (&own.error_low_rad, &own.error_high_rad), FLOOR.0);
    let v = tightest((&claim.velocity_low_rad_s, &claim.velocity_high_rad_s), (&own.velocity_low_rad_s, &own.velocity_high_rad_s), FLOOR.1);
    Ok(JointBeside {
        name: claim.name.clone(),
        error_max_rad: (claim.error_max_rad, own.error_max_rad),
        velocity_error_max_rad_s: (claim.velocity_error_max_rad_s, own.velocity_error_max_rad_s),
        tightest: (e.0, v.0),
    })
}

type Span<'a> = (&'a [f64], &'a [f64]);

/// The largest factor by which a side of a bin is closer to the derivation's middle than the derivation's own side,
/// and the bin.
fn tightest(claim: (&Vec<f64>, &Vec<f64>), own: (&Vec<f64>, &Vec<f64>), floor: f64) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for (bin, ((cl, ch), (ol, oh))) in claim.0.iter().zip(claim.1).zip(own.0.iter().zip(own.1)).enumerate() {
        let (middle, half) = (0.5 * (ol + oh), 0.5 * (oh - ol));
        for side in [ch - middle, middle - cl] {
            let factor = half / (side + floor).max(1e-300);
            if factor.is_nan() || factor > worst.0 {
                worst = (factor, bin);
            }
        }
    }
    worst
}
