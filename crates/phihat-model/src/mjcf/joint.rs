//! Joints: kind, axis, travel, friction and drive.

use super::actuators::{Actuators, least};
use super::attributes::wrong;
use super::classes::WithDefaults;
use super::compiler::{AngleUnit, CompilerSettings};
use crate::description::{JointMotion, JointOf};
use crate::joint::{Friction, Joint, JointKind};
use crate::placement::{Placement, about, add, apply, mul, normalised};
use crate::whole::{Moves, NamedElement, Result, StatedJoint};

/// A travel beyond this is what some write for none \[rad, m\].
const BOUNDLESS: f64 = 1e4;

/// Ends of travel beyond this are rare in rad and common in degrees; those below this are the other way round \[rad\],
/// \[degree\].
const TRAVEL_DEGREES: f64 = 6.0 * std::f64::consts::PI;
const TRAVEL_RADIANS: f64 = 2.0 * std::f64::consts::PI + 0.01;

/// Motion of one joint of a body.
pub(super) struct JointOfBody {
    pub(super) moves: Moves,
    /// Unit vector in the body's axes.
    pub(super) axis: [f64; 3],
    /// Point of the body that the joint leaves in place, in the body's frame \[m\].
    pub(super) anchor: [f64; 3],
    /// Position in the posture that the file is drawn in \[rad, m\].
    pub(super) reference: f64,
    pub(super) travel: Option<(f64, f64)>,
}

impl JointOfBody {
    /// A joint in the frame that it stands in.
    pub(super) fn of(
        joint: &WithDefaults<'_>,
        settings: &CompilerSettings,
        frame: &Placement,
    ) -> Result<Self> {
        let anchor = joint.finite("pos")?.unwrap_or([0.0; 3]);
        let anchor = add(frame.p, apply(&frame.r, anchor));
        let turns = match joint.word("type").unwrap_or("hinge") {
            "hinge" => true,
            "slide" => false,
            "ball" => return Ok(Self { moves: Moves::Free("a ball"), anchor, ..Self::free() }),
            "free" => return Ok(Self::free()),
            other => {
                let why = format!("type \"{other}\" is not read; hinge, slide, ball and free are");
                return Err(wrong(joint.own(), &why));
            }
        };
        let stated = joint.finite("axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let axis = normalised(apply(&frame.r, stated))
            .ok_or_else(|| wrong(joint.own(), "its axis has no direction"))?;
        let angle = |x: f64| if turns { settings.angle(x) } else { x };
        let reference = angle(joint.number("ref")?.unwrap_or(0.0));
        let (low, high) = joint.ends("range")?.unwrap_or((0.0, 0.0));
        let is_there = low != 0.0 || high != 0.0;
        let limited = joint.setting("limited")?.counts(is_there, settings.autolimits);
        let travel = limited.then(|| (angle(low), angle(high)));
        let kind = match (turns, travel) {
            (false, _) => JointKind::Prismatic,
            (true, Some((low, high))) if high - low <= BOUNDLESS => JointKind::Revolute,
            (true, _) => JointKind::Continuous,
        };
        Ok(Self { moves: Moves::Driven(kind), axis, anchor, reference, travel })
    }

    /// A `<freejoint>`, which has no class.
    pub(super) fn free() -> Self {
        let (axis, anchor) = ([0.0, 0.0, 1.0], [0.0; 3]);
        Self { moves: Moves::Free("free"), axis, anchor, reference: 0.0, travel: None }
    }

    /// Kind of a joint that a drive moves, and the numbers that its position has.
    pub(super) fn kind(&self) -> (Option<JointKind>, usize) {
        match self.moves {
            Moves::Driven(kind) | Moves::Follows { kind, .. } => (Some(kind), 1),
            Moves::Free("free") => (None, 7),
            Moves::Free(_) => (None, 4),
            Moves::Not => (None, 0),
        }
    }

    /// The joint where its body stands at `at` in its reference posture.
    pub(super) fn at(&self, (at, kind): (&Placement, Option<JointKind>), name: String) -> JointOf {
        let p = add(at.p, apply(&at.r, self.anchor));
        let (motion, placement) = match kind {
            None => (JointMotion::Fixed, Placement { p, r: at.r }),
            Some(JointKind::Prismatic) => {
                let back = self.axis.map(|x| -self.reference * x);
                let p = add(p, apply(&at.r, back));
                (JointMotion::Prismatic, Placement { p, r: at.r })
            }
            Some(_) if self.reference.abs() <= 0.0 => {
                (JointMotion::Revolute, Placement { p, r: at.r })
            }
            Some(_) => {
                let r = mul(&at.r, &about(self.axis, -self.reference));
                (JointMotion::Revolute, Placement { r, p })
            }
        };
        JointOf { name, motion, parent: 0, placement, axis: self.axis }
    }

    /// Limits, friction and drive.
    pub(super) fn stated(
        &self,
        (named, joint): (&NamedElement, &WithDefaults<'_>),
        settings: &CompilerSettings,
        actuators: &Actuators,
    ) -> Option<Result<StatedJoint>> {
        let Moves::Driven(kind) = self.moves else { return None };
        Some(self.driven((named, joint), kind, (settings, actuators)))
    }

    fn driven(
        &self,
        (named, joint): (&NamedElement, &WithDefaults<'_>),
        kind: JointKind,
        (settings, actuators): (&CompilerSettings, &Actuators),
    ) -> Result<StatedJoint> {
        let name = &named.name;
        let (mut warnings, mut notes) = (Vec::new(), Vec::new());
        let position = match kind {
            JointKind::Continuous => None,
            _ => Some(self.ends((named, joint), kind, (settings, &mut notes))?),
        };
        let drive = actuators.of(name);
        let positive = |key: &str, first: f64| match first {
            x if x.is_finite() && x >= 0.0 => Ok(x),
            x => Err(named.error(format!("{key}=\"{x}\" must be finite and at least 0"))),
        };
        let damping = joint.first("damping")?.unwrap_or(0.0);
        if joint.bends("damping")? || drive.bends {
            let what = "damping that is no multiple of the speed: the multiple alone is read";
            warnings.push(format!("joint \"{name}\": {what}"));
        }
        let viscous = positive("damping", damping)? + positive("damping", drive.damping)?;
        let coulomb = positive("frictionloss", joint.number("frictionloss")?.unwrap_or(0.0))?;
        let armature = positive("armature", joint.number("armature")?.unwrap_or(0.0))?
            + positive("armature", drive.armature)?;
        let springs = joint.first("stiffness")?.is_some_and(|k| k != 0.0);
        if springs || joint.bends("stiffness")? || joint.word("springdamper").is_some() {
            warnings.push(format!("joint \"{name}\": its spring is not read"));
        }
        warnings.extend(drive.warnings.iter().map(|why| format!("joint \"{name}\": {why}")));
        let own = joint.ends("actuatorfrcrange")?.unwrap_or((0.0, 0.0));
        let is_there = own.0 != 0.0 || own.1 != 0.0;
        let limited = joint.setting("actuatorfrclimited")?.counts(is_there, settings.autolimits);
        let own = limited.then(|| own.1.min(-own.0));
        let most = least(own, drive.torque_max);
        let torque_max = most.filter(|most| *most > 0.0 && *most <= BOUNDLESS * 10.0);
        if let (Some(most), None) = (most, torque_max) {
            warnings.push(format!("joint \"{name}\": a torque limit of {most} is read as none"));
        }
        Ok(StatedJoint {
            joint: Joint {
                name: name.clone(),
                kind,
                position,
                velocity_max: None,
                torque_max,
                torque_rate_max: None,
                armature,
                armature_range: None,
                friction: Friction { viscous, coulomb, coulomb_range: None, sigmoid: None },
                drive_bandwidth_hz: None,
                spring: None,
                encoder_bits: None,
            },
            warnings,
            notes,
        })
    }

    /// Ends of travel of a joint that has some.
    fn ends(
        &self,
        (named, joint): (&NamedElement, &WithDefaults<'_>),
        kind: JointKind,
        (settings, notes): (&CompilerSettings, &mut Vec<String>),
    ) -> Result<(f64, f64)> {
        let travel = self.travel.filter(|(low, high)| high - low <= BOUNDLESS);
        let Some((low, high)) = travel else {
            let stated = joint.word("range").is_some();
            let hint = if stated && !settings.autolimits {
                ", or limited=\"true\": the range that it has counts for nothing without, where autolimits is false"
            } else {
                ""
            };
            let why = format!(
                "it slides without ends: state its travel in metres, range{hint}; of a base that drives, name the arm \
                    on it by base and tip"
            );
            return Err(named.error(why));
        };
        if low >= high {
            return Err(
                named.error(format!("range {low} … {high}: the first must be below the second"))
            );
        }
        let largest = low.abs().max(high.abs());
        let line = named.line;
        if kind == JointKind::Revolute
            && settings.unit == AngleUnit::Radian
            && largest > TRAVEL_DEGREES
        {
            notes.push(format!(
                "joint \"{}\" (line {line}): range {low} … {high} rad is {:.1} turns; if it is degrees, the file needs \
                    <compiler angle=\"degree\"/>",
                named.name,
                (high - low) / std::f64::consts::TAU
            ));
        }
        let degrees = largest.to_degrees();
        if kind == JointKind::Revolute
            && settings.unit == AngleUnit::Unstated
            && degrees <= TRAVEL_RADIANS
        {
            notes.push(format!(
                "joint \"{}\" (line {line}): its range is at most {degrees:.3} degrees, MJCF's unit where the file \
                    states none; if it is rad, the file needs <compiler angle=\"radian\"/>",
                named.name
            ));
        }
        Ok((low, high))
    }
}
