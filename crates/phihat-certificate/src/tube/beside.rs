//! A claimed tube beside one that was derived again.

use serde::Serialize;

use crate::check::agree::agrees;
use crate::extremes::{Extremes as _, larger};
use crate::{Refutation, Tube, TubeJoint};

const CLAIM: &str = "tube";

/// A tube that is tighter than the derivation by no more than rounding is confirmed by it.
pub const CONFIRMED: f64 = 1.0 + 1e-9;

/// A tube that is tighter by more than this is refused.
///
/// Both are bounds, made differently, and neither must lie inside the other. Of 60 studies drawn by the
/// attack (2 to 11 joints, 200 Hz to 4 kHz) 36 were certified, and the derivation bounded 34: its error bound was
/// at most 1.45 times that of the tube in nine of ten, and 6.6 times in the worst. So this is a gross check only; that
/// every bin meets the derivation's, and that no drawn world leaves the tube, refuses much less, and of both bounds
/// the wider one is printed.
pub const TIGHTER: f64 = 100.0;

/// Largest difference of two derivations by rounding alone \[rad, rad/s, N·m\].
const ROUNDING: f64 = 1e-9;

/// Width that no encoder resolves and for which no tube is refused \[rad, rad/s\].
pub const UNREAD: f64 = 2e-9;

/// Torque that no drive resolves and for which no tube is refused \[N·m\].
const UNGIVEN: f64 = 1e-6;

/// One joint of a tube beside the derivation; errors from the tube's `settle_s` on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointBeside {
    /// Joint name.
    pub name: String,
    /// Largest |e| \[rad\] that is claimed.
    pub error_bound_rad: f64,
    /// Largest |e| \[rad\] that is derived here.
    pub derived_error_bound_rad: f64,
    /// Largest |ė| \[rad/s\] that is claimed.
    pub velocity_error_bound_rad_s: f64,
    /// Largest |ė| \[rad/s\] that is derived here.
    pub derived_velocity_error_bound_rad_s: f64,
    /// Factor by which the claim is tighter than the derivation: the largest of both ratios above and of the
    /// ratios of mean widths over the run, of `e` and `ė`.
    pub tighter: f64,
}

impl JointBeside {
    /// Returns true if the derivation confirms the claim.
    pub fn confirmed(&self) -> bool {
        self.tighter <= CONFIRMED
    }
}

/// Holds a tube against one that was derived for the same study.
///
/// # Errors
///
/// [`Refutation`]: a bin has nothing in common with the derivation's, though every run is in both; or the
/// tube is tighter than an honest one is.
pub fn beside(claimed: &Tube, own: &Tube) -> Result<Vec<JointBeside>, Refutation> {
    let same = claimed.joints.len() == own.joints.len() && claimed.bins() == own.bins();
    Refutation::unless(CLAIM, "bins are those of the study", 0.0, 1.0, same)?;
    agrees(CLAIM, "a bin is whole samples", (claimed.bin_s, own.bin_s), 1e-9)?;
    let pairs = claimed.joints.iter().zip(&own.joints);
    pairs
        .map(|(claim, own_joint)| {
            joint(claim, own_joint, claimed).map_err(|why| why.on(&claim.name))
        })
        .collect()
}

fn joint(claim: &TubeJoint, own: &TubeJoint, tube: &Tube) -> Result<JointBeside, Refutation> {
    let errors = Sides {
        what: "e",
        claimed: (&claim.error_low_rad, &claim.error_high_rad),
        own: (&own.error_low_rad, &own.error_high_rad),
    };
    let velocities = Sides {
        what: "ė",
        claimed: (&claim.velocity_low_rad_s, &claim.velocity_high_rad_s),
        own: (&own.velocity_low_rad_s, &own.velocity_high_rad_s),
    };
    errors.meet(tube)?;
    velocities.meet(tube)?;
    let ratios = [
        ("largest |e|", ratio(own.error_bound_rad, claim.error_bound_rad, UNREAD)),
        (
            "largest |ė|",
            ratio(own.velocity_error_bound_rad_s, claim.velocity_error_bound_rad_s, UNREAD),
        ),
        ("mean width of e", errors.tighter()),
        ("mean width of ė", velocities.tighter()),
        ("largest |τ|", ratio(own.torque_max_nm, claim.torque_max_nm, UNGIVEN)),
        ("largest |Δτ|", ratio(own.torque_step_max_nm, claim.torque_step_max_nm, UNGIVEN)),
        (
            "largest steady |Δτ|",
            ratio(own.torque_step_steady_max_nm, claim.torque_step_steady_max_nm, UNGIVEN),
        ),
    ];
    for (what, ratio) in ratios {
        let what =
            format!("{what}: the tube is at most so many times tighter than is derived here");
        Refutation::unless(CLAIM, &what, ratio, TIGHTER, ratio <= TIGHTER)?;
    }
    Ok(JointBeside {
        name: claim.name.clone(),
        error_bound_rad: claim.error_bound_rad,
        derived_error_bound_rad: own.error_bound_rad,
        velocity_error_bound_rad_s: claim.velocity_error_bound_rad_s,
        derived_velocity_error_bound_rad_s: own.velocity_error_bound_rad_s,
        tighter: ratios.iter().map(|(_, ratio)| *ratio).largest(),
    })
}

/// Bins of one quantity: low and high ends.
struct Sides<'a> {
    what: &'static str,
    claimed: (&'a [f64], &'a [f64]),
    own: (&'a [f64], &'a [f64]),
}

impl Sides<'_> {
    /// Every run is in both tubes, so every bin of one meets that of the other.
    fn meet(&self, tube: &Tube) -> Result<(), Refutation> {
        let claimed = self.claimed.0.iter().zip(self.claimed.1);
        let own = self.own.0.iter().zip(self.own.1);
        for (bin, ((low, high), (own_low, own_high))) in claimed.zip(own).enumerate() {
            let (what, t) = (self.what, tube.start_of(bin));
            let upper = format!("{what} of the bin at {t:.3} s reaches what is derived here");
            let reaches = *high >= own_low - ROUNDING;
            Refutation::unless(CLAIM, &upper, *high, *own_low, reaches)?;
            Refutation::unless(CLAIM, &upper, *low, *own_high, *low <= own_high + ROUNDING)?;
        }
        Ok(())
    }

    fn tighter(&self) -> f64 {
        let width = |(low, high): (&[f64], &[f64])| -> f64 {
            let sum: f64 = low.iter().zip(high).map(|(low, high)| high - low).sum();
            sum / low.len() as f64
        };
        ratio(width(self.own), width(self.claimed), UNREAD)
    }
}

/// `own` over `claimed`, which counts as `nothing` at least: an arm at rest with exact sensors has a tube of
/// what a payload does to second order, and another derivation that bounds it by norms gives ten thousand
/// times that width. NaN is no ratio.
fn ratio(own: f64, claimed: f64, nothing: f64) -> f64 {
    if own <= 0.0 && claimed >= 0.0 { 0.0 } else { own / larger(claimed, nothing) }
}
