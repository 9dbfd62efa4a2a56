//! Standing of a claim after its check: proved, derived twice, or not proved.

use serde::{Deserialize, Serialize};

use crate::extremes::larger;
use crate::{ArmBasis, Certificate, ClassAgain, Gains, PhiBasis, TubeAgain};

/// Standing of a claim, from the weakest to the strongest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It rests on one derivation alone, or there is none.
    NotProved,
    /// Two derivations that share no code give it, both in double precision.
    DerivedTwice,
    /// Exact arithmetic shows it, under the assumptions that stand with it.
    Proved,
}

impl Verdict {
    /// Words for people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::NotProved => "NOT PROVED",
            Self::DerivedTwice => "DERIVED TWICE",
            Self::Proved => "PROVED",
        }
    }

    /// A bound on an error with its standing, for a line: `DERIVED TWICE ≤ 0.264 mrad`.
    ///
    /// `bound` is its value with its unit. One that rests on a single derivation is only claimed.
    #[must_use]
    pub fn of_bound(self, bound: &str) -> String {
        match self {
            Self::NotProved => format!(
                "claimed ≤ {bound} (derived once; `phihat verify GAINS --study STUDY` derives it again)"
            ),
            Self::DerivedTwice | Self::Proved => format!("{} ≤ {bound}", self.words()),
        }
    }
}

/// Bound on the steady error of one joint after a check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckedBound {
    /// Joint name.
    pub joint: String,
    /// Bound on `|e|` \[rad\]: the file's, or the wider one of a second derivation.
    pub error_bound_rad: f64,
    /// Bound in the file \[rad\].
    pub claimed_rad: f64,
    /// Standing of `error_bound_rad`.
    pub verdict: Verdict,
    /// Basis of the bound, in words.
    pub basis: String,
}

impl Certificate {
    /// Bounds on the errors with their standing, after the derivations that were made from a study; joints without a
    /// bound are left out.
    ///
    /// `studied`: a study was held against the file. A bound by peak gains is derived twice only
    /// with one that types `φ` and the range of inertia: a file alone
    /// may state any, and those from a reference, a simulation or a trace are not derived again.
    ///
    /// Two derivations that bound the same error by `E₁` and `E₂` both show `|e| ≤ max(E₁, E₂)`: that is the bound
    /// which is derived twice.
    pub(crate) fn checked_bounds(
        &self,
        gains: &Gains,
        (tube, class): (Option<&TubeAgain>, Option<&ClassAgain>),
        studied: bool,
    ) -> Vec<CheckedBound> {
        let joints = gains.joints.iter().enumerate();
        joints
            .filter_map(|(i, record)| {
                let claimed_rad = self.error_bound(i)?.error_bound_rad;
                let (error_bound_rad, verdict, basis) = match (&self.tube, &self.class) {
                    (Some(_), _) => tube_bound(claimed_rad, i, tube),
                    (None, Some(_)) => class_bound(claimed_rad, i, class),
                    (None, None) => self.own_bound(claimed_rad, i, studied),
                };
                Some(CheckedBound {
                    joint: record.name.clone(),
                    error_bound_rad,
                    claimed_rad,
                    verdict,
                    basis,
                })
            })
            .collect()
    }

    /// Standing of a bound by peak gains, which rests on `φ` and on the range of inertia.
    fn own_bound(&self, claimed: f64, joint: usize, studied: bool) -> Standing {
        let phi = self.joints.get(joint).and_then(|joint| joint.phi.as_ref());
        let typed = phi.is_some_and(|phi| phi.basis == PhiBasis::Typed);
        if !studied {
            return once(
                claimed,
                "φ and the range of inertia are on trust; --study STUDY states them",
            );
        }
        if !typed || self.arm.basis != ArmBasis::Typed {
            return once(
                claimed,
                "φ or the range of inertia is not typed, and not derived a second time",
            );
        }
        (claimed, Verdict::DerivedTwice, "peak gains times the stated φ".into())
    }
}

type Standing = (f64, Verdict, String);

fn once(claimed: f64, why: &str) -> Standing {
    (claimed, Verdict::NotProved, why.to_owned())
}

fn tube_bound(claimed: f64, joint: usize, again: Option<&TubeAgain>) -> Standing {
    let Some(again) = again else {
        return once(claimed, "the tube is on trust; --study STUDY derives it a second time");
    };
    if let Some(why) = &again.on_trust {
        return once(claimed, &format!("the tube could not be derived a second time, {why}"));
    }
    match again.joints.get(joint).map(|own| own.derived_error_bound_rad) {
        Some(derived) if derived.is_finite() => {
            (larger(claimed, derived), Verdict::DerivedTwice, "the wider of two derivations".into())
        }
        _ => once(claimed, "the second derivation gives no bound"),
    }
}

fn class_bound(claimed: f64, joint: usize, again: Option<&ClassAgain>) -> Standing {
    let Some(again) = again else {
        return once(claimed, "the bound is on trust; --study STUDY derives it a second time");
    };
    if let Some(why) = &again.on_trust {
        return once(claimed, &format!("the bound could not be derived a second time, {why}"));
    }
    if let Some(why) = again.limits_acting.first() {
        return once(claimed, &format!("by the second derivation {why}"));
    }
    match again.joints.get(joint).map(|own| own.error_bound_rad) {
        Some(pair) if pair.wider().is_finite() => {
            let basis = "the wider of two derivations, on maxima that both searched, assumption C8";
            (pair.wider(), Verdict::DerivedTwice, basis.into())
        }
        _ => once(claimed, "the second derivation gives no bound"),
    }
}

#[cfg(test)]
mod tests {
    use super::Verdict;

    #[test]
    fn a_bound_says_its_standing() {
        assert_eq!(Verdict::DerivedTwice.of_bound("0.3 mrad"), "DERIVED TWICE ≤ 0.3 mrad");
        assert_eq!(Verdict::Proved.of_bound("0.3 mrad"), "PROVED ≤ 0.3 mrad");
        let once = Verdict::NotProved.of_bound("0.3 mrad");
        assert!(once.starts_with("claimed ≤ 0.3 mrad (derived once") && !once.contains("PROVED"));
    }
}
