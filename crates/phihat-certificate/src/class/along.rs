//! The bound for one motion of a class, which is known beforehand: (CM2) to (CM7) at its own postures, speeds,
//! accelerations and jerks.

use phihat_study::{MotionClass, ReferenceRequest, Study};
use serde::Serialize;

use super::bends::MARGIN;
use super::derive::PlacedModel;
use super::maxima::Maxima;
use super::setting::{CLAIM, ClassSetting, models};
use super::solve::{BoundProblem, PlayedPosture};
use crate::check::plausible::at_most;
use crate::parallel::shared;
use crate::refutation::refuse;
use crate::{Certificate, Gains, JointRecord, LoopModel, Refutation};

/// Instants of the motion at which kicks are played, with the payloads in turn.
const PLAYED: usize = 24;

/// Instants at which second derivatives are looked at, with the payloads in turn, beside those.
const BENT: usize = 48;

/// One motion of a class, known beforehand.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownMotion {
    /// Its box, largest speeds, accelerations and jerks per joint.
    pub extent: MotionClass,
    /// Position, velocity and acceleration of every joint at instants that are close to each other.
    pub instants: Vec<[Vec<f64>; 3]>,
}

/// Bounds on the error along one motion of a class.
///
/// # Claim
///
/// That of [`ClassBound`](super::ClassBound) for this motion as the reference in force, from a start of the law at rest
/// on its first position on.
///
/// # Not claimed
///
/// One derivation, the checker's: its maxima are the largest at instants of the motion (assumption C8), with
/// derivatives of the dynamics times 1.1. Sums are in double precision.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlongBound {
    /// Bound on `|e|` \[rad\] per joint.
    pub error_bound_rad: Vec<f64>,
    /// Bound on `|ė|` \[rad/s\] per joint.
    pub velocity_error_bound_rad_s: Vec<f64>,
    /// Bound on the change of the commanded torque per sample \[N·m\] per joint.
    pub torque_step_nm: Vec<f64>,
    /// Bound on the torque \[N·m\] per joint.
    pub torque_nm: Vec<f64>,
    /// Postures at which kicks were played.
    pub postures: usize,
    /// Points at which torque rates were looked at.
    pub points: usize,
}

impl Certificate {
    /// Derives the bound along one motion of the certificate's class; some tenths of a second.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: there is no bound for a class, the study is another one, the motion is not in the class, or
    /// (CM5) has no solution.
    pub fn derive_along(
        &self,
        gains: &Gains,
        study: &Study,
        motion: &KnownMotion,
    ) -> Result<AlongBound, Refutation> {
        let claimed = self
            .class
            .as_ref()
            .ok_or_else(|| refuse(CLAIM, "the certificate bounds a class of motions", 0.0, 1.0))?;
        let ReferenceRequest::Any { class, .. } = &study.reference else {
            return Err(refuse(CLAIM, "the study's reference is a class of motions", 0.0, 1.0));
        };
        let loop_models: Vec<LoopModel> = self.joints.iter().map(|joint| joint.model).collect();
        ClassSetting::of(study, gains, class, &loop_models)?.is_of(claimed, study)?;
        is_within(&motion.extent, class)?;
        let setting = ClassSetting::of(study, gains, &motion.extent, &loop_models)?;
        let models = models(study)?;
        let loops: Vec<(&JointRecord, &LoopModel)> =
            gains.joints.iter().zip(&loop_models).collect();
        let places = |count: usize| -> Vec<PlacedModel> {
            let all = models.iter().cycle().zip(spread(&motion.instants, count));
            all.map(|(model, [q, ..])| (model.clone(), q.clone())).collect()
        };
        let (placed, bent) = (places(PLAYED), places(BENT));
        let maxima = Maxima::along(&setting.torques(), &models, &motion.instants);
        let played = shared(placed.len(), |at| setting.played(&loops, &placed[at]));
        let played: Vec<PlayedPosture> = played.into_iter().collect::<Result<_, Refutation>>()?;
        let bends = setting.bends(&placed, &bent);
        let start = setting.start.imbalance((&maxima, claimed), (study, MARGIN))?;
        let start = (start, claimed.start_s);
        let own = BoundProblem { setting: &setting, maxima: &maxima, bends: &bends, start }
            .solve(&played)?;
        Ok(AlongBound {
            error_bound_rad: own.error,
            velocity_error_bound_rad_s: own.velocity,
            torque_step_nm: own.step,
            torque_nm: own.torque,
            postures: placed.len(),
            points: maxima.points,
        })
    }
}

/// So many of a list, the first and the last among them.
fn spread<T>(all: &[T], count: usize) -> impl Iterator<Item = &T> {
    let last = all.len().saturating_sub(1);
    (0..count.min(all.len())).filter_map(move |k| {
        let gaps = count.min(all.len()).saturating_sub(1).max(1);
        all.get(k * last / gaps)
    })
}

/// Refuses a motion that is not of the class.
fn is_within(own: &MotionClass, class: &MotionClass) -> Result<(), Refutation> {
    let lists = [
        ("low end of the class's box ≤ lowest position", &class.low, &own.low),
        ("highest position ≤ high end of the class's box", &own.high, &class.high),
        ("speed ≤ the class's", &own.speed, &class.speed),
        ("acceleration ≤ the class's", &own.acceleration, &class.acceleration),
        ("jerk ≤ the class's", &own.jerk, &class.jerk),
    ];
    for (what, least, most) in lists {
        let joints = most.len() as f64;
        let same = least.len() == most.len();
        Refutation::unless(CLAIM, "one entry per joint", least.len() as f64, joints, same)?;
        for (least, most) in least.iter().zip(most) {
            let room = SAME_LIMIT * (1.0 + most.abs());
            at_most(CLAIM, what, *least, *most + room)?;
        }
    }
    Ok(())
}

/// Rounding of a limit, as a share.
const SAME_LIMIT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn a_spread_has_both_ends_and_no_more_than_there_are() {
        let all: Vec<usize> = (0..101).collect();
        assert_eq!(spread(&all, 5).copied().collect::<Vec<_>>(), [0, 25, 50, 75, 100]);
        assert_eq!(spread(&all[..2], 5).copied().collect::<Vec<_>>(), [0, 1]);
        assert_eq!(spread(&all[..1], 5).count() + spread(&all[..0], 5).count(), 1);
    }
}
