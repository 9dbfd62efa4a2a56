//! The paper's statements on the arm as predicates of runs: decided here for every arm alike.

use super::run::Run;
use super::runs::Runs;
use super::studies::GainSetting;
use crate::part::PartError;
use crate::record::Verdict;
use phihat::Form;

/// (48) and (49) as one ladder: |∬e| \[rad·s²\], |∫e| \[rad·s\], |e| \[rad\], |ė| \[rad/s\].
/// (48) has no ∬e.
pub(crate) const BOUNDS: [f64; 4] = [1e-4, 1e-3, 1e-2, 1e-1];

/// Torques that differ by less than this share of the largest count as one curve.
const ONE_CURVE: f64 = 0.01;

/// Returns true if the steady part satisfies (48) for m = 1, (49) for m = 2; integrals count alike in either form.
pub(crate) fn keeps_bounds(run: &Run, setting: GainSetting) -> bool {
    let first = usize::from(setting == GainSetting::First);
    run.steady().is_some_and(|steady| {
        steady.iter().zip(BOUNDS).skip(first).all(|(value, bound)| *value <= bound)
    })
}

/// Returns true if joint 2 overshoots more in `second` than in `first`.
pub(crate) fn peaks_more(second: &Run, first: &Run) -> bool {
    second.overshoot(1) > first.overshoot(1)
}

/// Returns true if the rms mismatch of the worst joint is smaller in `second` than in `first`.
pub(crate) fn estimates_better(second: &Run, first: &Run) -> bool {
    !second.diverged() && !first.diverged() && second.mismatch()[1] < first.mismatch()[1]
}

/// Largest difference of two runs' torques in the steady part, over the largest torque there.
pub(crate) fn torque_difference(a: &Run, b: &Run) -> Option<f64> {
    if a.diverged() || b.diverged() {
        return None;
    }
    let from = a.steady_from();
    let (mut apart, mut most) = (0.0_f64, 0.0_f64);
    for (one, other) in a.joints().iter().zip(b.joints()) {
        for (x, y) in one.tau_applied.iter().zip(&other.tau_applied).skip(from) {
            apart = apart.max((x - y).abs());
            most = most.max(x.abs());
        }
    }
    Some(apart / most)
}

/// Returns true if the torques of two runs are one curve in the steady part.
pub(crate) fn same_torque(a: &Run, b: &Run) -> bool {
    torque_difference(a, b).is_some_and(|share| share < ONE_CURVE)
}

/// A statement on settings: whether it holds for a setting in a form.
pub(crate) type Holds = fn(&Runs, GainSetting, Form) -> Result<bool, PartError>;

/// A statement that is decided on every surrogate.
#[derive(Debug)]
pub(crate) struct Claim {
    /// In words.
    pub(crate) says: &'static str,
    /// True if it is about (48) or (49).
    pub(crate) bounds: bool,
    /// The settings it is about.
    pub(crate) settings: &'static [GainSetting],
    /// Test of the statement for one setting and form.
    pub(crate) holds: Holds,
}

/// Statements on the simulations.
pub(crate) const SIMULATED: &[Claim] = &[
    Claim {
        says: "m = 2 overshoots more than m = 1 (Figs. 5, 6)",
        bounds: false,
        settings: &GainSetting::SECOND,
        holds: |runs, setting, form| {
            Ok(peaks_more(runs.get(setting, form)?, runs.get(GainSetting::First, form)?))
        },
    },
    Claim {
        says: "the error keeps (48), (49) (Fig. 7)",
        bounds: true,
        settings: &GainSetting::ALL,
        holds: keeps,
    },
    Claim {
        says: "m = 2 leaves less mismatch than m = 1 (Fig. 8)",
        bounds: false,
        settings: &GainSetting::SECOND,
        holds: |runs, setting, form| {
            Ok(estimates_better(runs.get(setting, form)?, runs.get(GainSetting::First, form)?))
        },
    },
    Claim {
        says: "torques of m = 1 and 2 are one curve (50)",
        bounds: false,
        settings: &GainSetting::SECOND,
        holds: |runs, setting, form| {
            Ok(same_torque(runs.get(setting, form)?, runs.get(GainSetting::First, form)?))
        },
    },
];

/// Statements on the experiments, order by order; in the printed form they depend on the order.
pub(crate) const EXPERIMENTED: &[Claim] = &[
    Claim {
        says: "the arm settles in spite of saturation, m = 1 (Figs. 9, 10)",
        bounds: false,
        settings: &[GainSetting::First],
        holds: settles,
    },
    Claim {
        says: "the arm settles in spite of saturation, m = 2 (Figs. 9, 10)",
        bounds: false,
        settings: &GainSetting::SECOND,
        holds: settles,
    },
    Claim {
        says: "the error keeps (48) on the second turn, m = 1 (Fig. 11)",
        bounds: true,
        settings: &[GainSetting::First],
        holds: keeps,
    },
    Claim {
        says: "the error keeps (49) on the second turn, m = 2 (Fig. 11)",
        bounds: true,
        settings: &GainSetting::SECOND,
        holds: keeps,
    },
];

/// Statements by id, and the place in [`SIMULATED`] of the claim that each is about.
pub(crate) const SIMULATED_AS: [(&str, usize); 6] = [
    ("fig5-overshoot", 0),
    ("fig6-overshoot", 0),
    ("fig7-m1", 1),
    ("fig7-m2", 1),
    ("fig8-order", 2),
    ("eq50-torque", 3),
];
/// Places in [`EXPERIMENTED`]: (48), (49).
pub(crate) const KEEPS: [usize; 2] = [2, 3];

fn settles(runs: &Runs, setting: GainSetting, form: Form) -> Result<bool, PartError> {
    Ok(runs.get(setting, form)?.settled_at().is_some())
}

fn keeps(runs: &Runs, setting: GainSetting, form: Form) -> Result<bool, PartError> {
    Ok(keeps_bounds(runs.get(setting, form)?, setting))
}

impl Claim {
    /// Returns true if it holds for every setting in a form.
    pub(crate) fn everywhere(&self, runs: &Runs, form: Form) -> Result<bool, PartError> {
        let each = self.settings.iter().map(|setting| (self.holds)(runs, *setting, form));
        each.collect::<Result<Vec<_>, _>>().map(|all| all.into_iter().all(|holds| holds))
    }
}

/// Verdict on a statement that holds as printed, or only in the observer form; open where neither, as the arm is
/// assumed.
pub(crate) fn verdict(as_printed: bool, corrected: bool) -> Verdict {
    Verdict::assumed(as_printed, corrected)
}
