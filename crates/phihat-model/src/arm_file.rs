//! The TOML file of an arm, written: every key with its unit, a value where one can be estimated, and what to measure.

use std::fmt::Write as _;

use crate::estimate::{EstimatedInterval, SPEED_ASSUMED, dry_friction, rotor_inertia};
use crate::{Joint, JointKind, JointSpring, Part, Robot};

/// Encoder resolution that is assumed \[bit\] over one turn, and that of small servos.
const BITS: (u32, u32) = (18, 12);

/// Arms of which no joint has more torque than this have small servos \[N·m\].
const SMALL_NM: f64 = 10.0;

/// Source of a section's figures, where they are estimated.
const ROTOR: &str = "estimate: J = t * torque limit / speed limit, t = 0.011 to 0.07 s (geared drives; 0.0035 to 0.02 \
    s above 12 rad/s), which holds published drives of Franka, KUKA and Unitree; `rotor_inertia` in phihat-model";
const FRICTION: &str = "estimate: dry friction is 0.6 to 7 % of the torque limit, which holds the Panda's identified \
    friction; `dry_friction` in phihat-model";
const ENCODER: &str =
    "assumption: 18 bits over one turn of the joint, 12 where no joint has more than 10 N m";

impl Robot {
    /// Joints without a torque limit: what nothing can be estimated for.
    pub fn without_torque_limit(&self) -> Vec<&str> {
        let without = self.joints.iter().filter(|joint| joint.torque_max.is_none());
        without.map(|joint| joint.name.as_str()).collect()
    }

    /// This robot with estimates of the values that its description omits: rotor inertia and dry friction as
    /// intervals, and an encoder. Described values stay; so do joints
    /// [without a torque limit](Self::without_torque_limit).
    #[must_use]
    pub fn estimated(mut self) -> Self {
        let torques = self.joints.iter().filter_map(|joint| joint.torque_max);
        let small = torques.max_by(f64::total_cmp).is_none_or(|most| most <= SMALL_NM);
        let (mut rotor, mut friction, mut encoder) = (false, false, false);
        for joint in &mut self.joints {
            let Some(torque) = joint.torque_max else { continue };
            if joint.armature <= 0.0 && joint.armature_range.is_none() {
                let found = rotor_inertia(torque, joint.velocity_max).rounded();
                (joint.armature, joint.armature_range) =
                    (found.value, Some((found.low, found.high)));
                rotor = true;
            }
            if joint.friction.sigmoid.is_none() && joint.friction.coulomb_range.is_none() {
                let found = dry_friction(torque).rounded();
                let own = Some(joint.friction.coulomb).filter(|own| *own > 0.0);
                let value = own.unwrap_or(found.value);
                joint.friction.coulomb = value;
                joint.friction.coulomb_range = Some((found.low.min(value), found.high.max(value)));
                friction = true;
            }
            if joint.encoder_bits.is_none() {
                joint.encoder_bits = Some(if small { BITS.1 } else { BITS.0 });
                encoder = true;
            }
        }
        let made = [
            ("rotor", rotor, ROTOR),
            ("friction", friction, FRICTION),
            ("encoder", encoder, ENCODER),
        ];
        for (section, _, source) in made.into_iter().filter(|(_, made, _)| *made) {
            self.sources.insert(section.to_owned(), source.to_owned());
        }
        self
    }

    /// The text of a TOML file that says of the URDF or MJCF `urdf`, beside it, what this robot knows
    /// beyond it; it reads back. `part` is what of the description it is.
    pub fn arm_file(&self, urdf: &str, part: &Part) -> String {
        let mut text = String::new();
        self.write_head(&mut text, (urdf, part));
        self.write_rotor(&mut text);
        self.write_transmission(&mut text);
        self.write_friction(&mut text);
        self.write_limits(&mut text);
        self.write_rest(&mut text);
        text
    }

    fn write_head(&self, text: &mut String, (urdf, part): (&str, &Part)) {
        let q = |word: &str| toml::Value::String(word.to_owned()).to_string();
        line(
            text,
            &format!(
                "# {}: what {urdf} leaves out. Lists follow `joints`. A study names this file:",
                self.name
            ),
        );
        line(
            text,
            "# [robot] file = \"THIS FILE\". Only the description is needed; what is estimated says so, and what to \
                measure.",
        );
        line(text, &format!("name = {}", q(&self.name)));
        let is_mjcf = [".xml", ".mjcf"].iter().any(|ending| urdf.ends_with(ending));
        line(text, &format!("{} = {}", if is_mjcf { "mjcf" } else { "urdf" }, q(urdf)));
        if part.is_stated() {
            line(
                text,
                "# The arm in a larger robot: joints between these two links; all others stand still.",
            );
        }
        if let Some(base) = &part.base {
            line(text, &format!("base = {}", q(base)));
        }
        line(text, &format!("tip = {}", q(&self.tip)));
        if !part.locked.is_empty() {
            let locked: Vec<String> =
                part.locked.iter().map(|(n, at)| format!("{} = {at:?}", q(n))).collect();
            line(text, &format!("locked = {{ {} }}", locked.join(", ")));
        }
        line(text, "joints = [");
        for joint in &self.joints {
            line(text, &format!("  {},", q(&joint.name)));
        }
        line(text, "]");
    }

    fn write_rotor(&self, text: &mut String) {
        let known =
            self.joints.iter().all(|joint| joint.armature > 0.0 || joint.armature_range.is_some());
        line(
            text,
            "\n# Inertia of each rotor as its joint feels it, behind the gear: rotor inertia times the gear ratio \
                squared",
        );
        line(
            text,
            "# [kg·m², kg for a sliding joint]. A simulated run has `armature_kg_m2`; a design holds for every value \
                from min to",
        );
        line(
            text,
            "# max, and a wide interval costs accuracy. Take it from the motor's data sheet. Or measure: hold the \
                joint where",
        );
        line(
            text,
            "# gravity does not turn it, apply a small torque step; torque over acceleration, less the inertia of the \
                links, is it.",
        );
        Self::section(text, "rotor", known);
        self.list(text, ("armature_kg_m2", known), |joint| joint.armature);
        let intervals = known && self.joints.iter().any(|joint| joint.armature_range.is_some());
        if intervals {
            let ends =
                |joint: &Joint| joint.armature_range.unwrap_or((joint.armature, joint.armature));
            self.list(text, ("armature_min_kg_m2", true), |joint| ends(joint).0);
            self.list(text, ("armature_max_kg_m2", true), |joint| ends(joint).1);
        }
        self.source(text, "rotor", known);
    }

    /// Springs of the joints, where all of them are known.
    fn write_transmission(&self, text: &mut String) {
        let known = self.joints.iter().all(|joint| joint.spring.is_some());
        if !known {
            return;
        }
        line(text, "\n# Spring between each rotor and its link: intervals.");
        Self::section(text, "transmission", known);
        let none = JointSpring { stiffness: (0.0, 0.0), damping: (0.0, 0.0) };
        let of = |joint: &Joint| joint.spring.unwrap_or(none);
        self.list(text, ("stiffness_min_nm_rad", known), |joint| of(joint).stiffness.0);
        self.list(text, ("stiffness_max_nm_rad", known), |joint| of(joint).stiffness.1);
        self.list(text, ("damping_min_nm_s_rad", known), |joint| of(joint).damping.0);
        self.list(text, ("damping_max_nm_s_rad", known), |joint| of(joint).damping.1);
        self.source(text, "transmission", known);
    }

    fn write_friction(&self, text: &mut String) {
        line(
            text,
            "\n# Friction of each joint: viscous [N·m·s/rad] and dry [N·m]. A simulated run has `coulomb_nm`; a tube \
                holds for every",
        );
        line(
            text,
            "# level from min to max. Measure: turn the joint slowly both ways; half the difference of the torques is \
                it.",
        );
        Self::section(text, "friction", true);
        self.list(text, ("viscous_nm_s_rad", true), |joint| joint.friction.viscous);
        self.list(text, ("coulomb_nm", true), |joint| joint.friction.coulomb);
        if self.joints.iter().all(|joint| joint.friction.coulomb_range.is_some()) {
            let ends = |joint: &Joint| joint.friction.coulomb_range.unwrap_or_default();
            self.list(text, ("coulomb_min_nm", true), |joint| ends(joint).0);
            self.list(text, ("coulomb_max_nm", true), |joint| ends(joint).1);
        }
        self.source(text, "friction", true);
    }

    fn write_limits(&self, text: &mut String) {
        let known = self.joints.iter().all(|joint| joint.torque_max.is_some());
        line(
            text,
            "\n# What the drives can: largest torque [N·m] and speed [rad/s]. Those of the description, which may be \
                placeholders: compare",
        );
        line(text, "# the data sheet. All estimates above come from them.");
        if !known {
            let without = self.without_torque_limit().join(", ");
            line(
                text,
                &format!(
                    "# STATE the torque limit of {without}: the description has none, and nothing can be estimated \
                        without it."
                ),
            );
        }
        Self::section(text, "limits", known);
        self.list(text, ("torque_max_nm", known), |joint| joint.torque_max.unwrap_or(0.0));
        let fast = known && self.joints.iter().all(|joint| joint.velocity_max.is_some());
        if !fast {
            line(
                text,
                &format!(
                    "# Not stated by the description for every joint; {SPEED_ASSUMED:.3} rad/s was assumed for the \
                        estimates."
                ),
            );
        }
        self.list(text, ("velocity_max_rad_s", fast), |joint| {
            joint.velocity_max.unwrap_or(SPEED_ASSUMED)
        });
        line(
            text,
            "# torque_rate_max_nm_s = 1000.0  # largest rate of a command, if the drives refuse more [N·m/s]",
        );
        self.source(text, "limits", known);
    }

    fn write_rest(&self, text: &mut String) {
        let known = self.joints.iter().all(|joint| joint.encoder_bits.is_some());
        line(
            text,
            "\n# Resolution of the position that the controller reads, in bits over one turn of the joint.",
        );
        Self::section(text, "encoder", known);
        let bits: Vec<String> = self
            .joints
            .iter()
            .map(|joint| joint.encoder_bits.unwrap_or(BITS.0).to_string())
            .collect();
        line(text, &format!("{}bits = [{}]", if known { "" } else { "# " }, bits.join(", ")));
        self.source(text, "encoder", known);
        line(
            text,
            "\n# Bandwidth of the drives' torque loop, if it is known [Hz]; without it, torque acts at once.",
        );
        line(text, "# [drive]\n# bandwidth_hz = 500.0");
        line(text, "\n# What its torque interface adds and refuses; \"ideal\" is a bare torque.");
        line(text, &format!("[profile]\nname = {:?}", self.profile));
        if !self.poses.is_empty() {
            line(text, "\n# Named postures [rad, m].\n[poses]");
        }
        for (name, pose) in &self.poses {
            let pose: Vec<String> = pose.iter().map(|x| format!("{x:?}")).collect();
            let name = toml::Value::String(name.clone());
            line(text, &format!("{name} = [{}]", pose.join(", ")));
        }
    }

    fn section(text: &mut String, name: &str, active: bool) {
        line(text, &format!("{}[{name}]", if active { "" } else { "# " }));
    }

    fn source(&self, text: &mut String, name: &str, active: bool) {
        let from = self.sources.get(name).map_or("the description", String::as_str);
        let from = toml::Value::String(from.to_owned());
        line(text, &format!("{}source = {from}", if active { "" } else { "# " }));
    }

    /// One number per joint, each on a line with the joint's name.
    fn list(&self, text: &mut String, (key, active): (&str, bool), of: impl Fn(&Joint) -> f64) {
        let lead = if active { "" } else { "# " };
        line(text, &format!("{lead}{key} = ["));
        for joint in &self.joints {
            let unit = if joint.kind == JointKind::Prismatic { " (slides)" } else { "" };
            let name: String = joint.name.chars().filter(|c| !c.is_control()).collect();
            line(text, &format!("{lead}  {:?}, # {name}{unit}", of(joint)));
        }
        line(text, &format!("{lead}]"));
    }
}

fn line(text: &mut String, words: &str) {
    let _ = writeln!(text, "{words}");
}

impl EstimatedInterval {
    /// With two digits, the ends outwards, and a value of three between them.
    fn rounded(self) -> Self {
        let unit = |x: f64, digits: f64| libm::pow(10.0, libm::log10(x).floor() - digits + 1.0);
        let low = tidy((self.low / unit(self.low, 2.0)).floor() * unit(self.low, 2.0));
        let high = tidy((self.high / unit(self.high, 2.0)).ceil() * unit(self.high, 2.0));
        let value = tidy((self.value / unit(self.value, 3.0)).round() * unit(self.value, 3.0));
        Self { low, value: value.clamp(low, high), high }
    }
}

/// The number that is written with few digits, in place of one beside it.
fn tidy(x: f64) -> f64 {
    format!("{x:.4e}").parse().unwrap_or(x)
}
