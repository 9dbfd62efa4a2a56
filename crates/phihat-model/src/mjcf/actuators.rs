//! Actuators: the largest torque of each joint, and what they add to it.

use std::collections::BTreeMap;

use super::classes::{ACTUATORS, DefaultClasses, WithDefaults};
use super::compiler::CompilerSettings;
use crate::markup::MarkupElement;
use crate::whole::Result;

/// Drive of a joint by all of its actuators together.
#[derive(Debug, Clone, Default)]
pub(super) struct DriveOfJoint {
    /// Number of actuators.
    count: usize,
    /// Largest torque in both directions \[N·m, N\]; `None`: an actuator has no limit.
    pub(super) torque_max: Option<f64>,
    /// Rotor inertia \[kg·m², kg\] and damping \[N·m·s/rad, N·s/m\] at the joint.
    pub(super) armature: f64,
    pub(super) damping: f64,
    /// True if damping is no multiple of the speed.
    pub(super) bends: bool,
    pub(super) warnings: Vec<String>,
}

/// Drives of a file, by the joint's name.
#[derive(Debug, Default)]
pub(super) struct Actuators {
    by_joint: BTreeMap<String, DriveOfJoint>,
    none: DriveOfJoint,
}

impl Actuators {
    /// Actuators of all sections of a file.
    pub(super) fn of_file(
        root: &MarkupElement,
        classes: &DefaultClasses,
        settings: &CompilerSettings,
    ) -> Result<Self> {
        let mut all = Self::default();
        let sections = root.elements().filter(|section| section.name == "actuator");
        for element in sections.flat_map(MarkupElement::elements) {
            let joint = element.attribute("joint").or_else(|| element.attribute("jointinparent"));
            let (Some(joint), true) = (joint, ACTUATORS.contains(&&*element.name)) else {
                continue;
            };
            let actuator = classes.with(element, 0)?;
            all.by_joint.entry(joint.to_owned()).or_default().add(&actuator, settings)?;
        }
        Ok(all)
    }

    /// The drive of a joint.
    pub(super) fn of(&self, joint: &str) -> &DriveOfJoint {
        self.by_joint.get(joint).unwrap_or(&self.none)
    }
}

impl DriveOfJoint {
    fn add(&mut self, actuator: &WithDefaults<'_>, settings: &CompilerSettings) -> Result<()> {
        let [gear, ..] = actuator.up_to("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        let gain = match &*actuator.own().name {
            "motor" => 1.0,
            _ => actuator.first("gainprm")?.unwrap_or(1.0),
        };
        let limit = |range: &str, limited: &str| -> Result<Option<(f64, f64)>> {
            let (low, high) = actuator.ends(range)?.unwrap_or((0.0, 0.0));
            let is_there = low != 0.0 || high != 0.0;
            let counts = actuator.setting(limited)?.counts(is_there, settings.autolimits);
            Ok(counts.then_some((low, high)))
        };
        let scaled = |(low, high): (f64, f64), factor: f64| {
            let (a, b) = (factor * low, factor * high);
            (-a.min(b)).min(a.max(b))
        };
        let by_force = limit("forcerange", "forcelimited")?.map(|range| scaled(range, gear));
        let by_control = if is_motor(actuator) {
            limit("ctrlrange", "ctrllimited")?.map(|range| scaled(range, gear * gain))
        } else {
            None
        };
        let most = least(by_force, by_control);
        if let Some(most) = most.filter(|most| *most <= 0.0) {
            self.warnings.push(format!("an actuator that acts one way only, limit {most}"));
        }
        self.torque_max = match (self.count, self.torque_max, most) {
            (0, _, most) => most,
            (_, Some(before), Some(most)) => Some(before + most),
            _ => None,
        };
        self.count += 1;
        let damping = actuator.first("damping")?.unwrap_or(0.0);
        self.armature += gear * gear * actuator.number("armature")?.unwrap_or(0.0);
        self.damping += gear * gear * damping;
        self.bends |= actuator.bends("damping")?;
        Ok(())
    }
}

/// The lesser of two limits, either of which may not be there.
pub(super) fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a < b { a } else { b }),
        (a, b) => a.or(b),
    }
}

/// Returns true if an actuator's torque is its control times a constant.
fn is_motor(actuator: &WithDefaults<'_>) -> bool {
    let plain = |(key, wanted): (&str, &str)| {
        let decided = actuator.levels.iter().find_map(|level| match &*level.name {
            "general" => level.attribute(key).map(|own| own == wanted),
            servo => Some(servo == "motor"),
        });
        decided.unwrap_or(true)
    };
    [("biastype", "none"), ("gaintype", "fixed"), ("dyntype", "none")].into_iter().all(plain)
}
