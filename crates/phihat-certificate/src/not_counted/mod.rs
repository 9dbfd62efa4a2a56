//! Parts of a study that the claims leave out.
//!
//! Every structure of a study is taken apart here, field by field, so that none can be added to a study without a
//! decision: in the loop model, in what is known of arm and φ, or on the list.

mod around;
mod list;
mod world;

use phihat_model::{Robot, Rotor};
use phihat_study::{Control, Fault, JointSprings, PayloadSet, ReferenceRequest, Sensor, Study};

use crate::TubePayloadSet;

pub use list::{LeftOut, NotCounted};
use list::{List, text};

impl NotCounted {
    /// Everything in a study that claims about its gains leave out. Where this is empty and nothing is refused, the
    /// bounds are about the study as it runs.
    pub fn of(study: &Study) -> Vec<Self> {
        let Study {
            // Who and what it is.
            name: _,
            title: _,
            inputs: _,
            text: _,
            renamed: _,
            sha256: _,
            // Of what is random, each is listed by itself.
            seed: _,
            // The certificate says for how long a run its claims are.
            duration: _,
            // In the range of inertia and in φ; its limits are the loop's, the world's and the interface's.
            robot,
            // In a clause of their own, or assumed rigid.
            springs,
            // What is asked for.
            spec: _,
            gains: _,
            // But for where its payload is.
            design,
            control,
            sensor,
            world,
            interface,
            supervisor,
            // It looks on, or asks the supervisor to stop.
            contact: _,
            faults,
            // In φ, and in what its motion costs; a supervisor keeps a class of motions.
            reference,
            // In what the search takes for φ, and in the tube.
            feedforward: _,
        } = study;
        let mut list = List(Vec::new());
        control_counts(control);
        list.rotors(robot);
        list.springs(springs);
        list.payload_place(&design.payload);
        let class = matches!(reference, ReferenceRequest::Any { .. });
        list.sensor(sensor, class);
        list.world(world, class);
        list.interface(interface, class);
        if let Some(request) = supervisor {
            list.supervisor(request, class);
        }
        for fault in faults {
            list.fault(fault);
        }
        list.0
    }

    /// Returns true if there is no tube beside it; beside springs the tube is that of rigid joints.
    pub fn forbids_tube(&self) -> bool {
        !self.in_tube() && self.claims != LeftOut::AllButElastic
    }

    /// Returns true if a tube counts it, or is for an arm that is assumed to be without it.
    pub fn in_tube(&self) -> bool {
        matches!(self.claims, LeftOut::AllButTube | LeftOut::TubeBesideValue | LeftOut::Assumed)
    }

    /// Returns true if it changes nothing until it stops the arm: a run without a stop is as claimed.
    pub fn stops(&self) -> bool {
        around::STOPS.contains(&self.key.as_str())
    }
}

/// Nothing of `[loop]` is left out.
fn control_counts(control: &Control) {
    let Control {
        // In the loop model.
        period_ns: _,
        delay_samples: _,
        torque_filter_hz: _,
        form: _,
        // In the reference that bounds and tube are about.
        preview: _,
        // The gains tell what became of it.
        form_designed: _,
        preview_stated: _,
        // Claims hold while no limit acts. The rate limit is a clause of the design; a tube says whether any limit
        // can act along it, and a run says how often one did.
        torque_max: _,
        torque_rate_max: _,
        // Whether the motion was looked at before; not what acts.
        beyond_drives: _,
        // Behind the law: it acts only where the drives give more than a person allows.
        energy: _,
    } = control;
}

impl List {
    /// Rotor inertias that are known by intervals.
    fn rotors(&mut self, robot: &Robot) {
        if robot.has_rotor_interval() {
            let ends = |place: Rotor| {
                let all: Vec<f64> = robot.joints.iter().map(|j| j.armature_at(place)).collect();
                text(&all)
            };
            let value = format!("{} to {}", ends(Rotor::Least), ends(Rotor::Most));
            self.add("robot.armature_kg_m2", value, LeftOut::TubeBesideValue);
        }
    }

    /// A payload of which only the mass is stated.
    fn payload_place(&mut self, set: &PayloadSet) {
        if set.mass.1 > 0.0 && !set.place_stated {
            let value = format!("not stated: {}", TubePayloadSet::from(set));
            self.add("design.payload_com_m", value, LeftOut::Assumed);
        }
    }

    /// Springs between rotors and links: assumed rigid, or in one clause alone.
    fn springs(&mut self, springs: &JointSprings) {
        let (key, value) = match springs {
            JointSprings::Unstated => ("robot.transmission", "not stated: rigid joints"),
            JointSprings::Rigid => ("robot.transmission.stiffness", "rigid"),
            JointSprings::Stated(springs) => {
                let ends: Vec<f64> = springs.iter().map(|spring| spring.stiffness.0).collect();
                let others: Vec<f64> = springs.iter().map(|spring| spring.stiffness.1).collect();
                let value = format!("{} to {} N·m/rad", text(&ends), text(&others));
                return self.add("robot.transmission", value, LeftOut::AllButElastic);
            }
        };
        self.add(key, value, LeftOut::Assumed);
    }

    fn sensor(&mut self, sensor: &Sensor, class: bool) {
        let Sensor {
            // In the bounds.
            encoder_bits: _,
            // In the loop model.
            velocity: _,
            velocity_filter_hz: _,
            velocity_filter_designed: _,
            torque: _,
            delay_samples: _,
            position_noise,
            position_noise_max,
            position_bias,
            velocity_noise,
            torque_noise,
            // Forbids the loop model.
            jitter: _,
            stamps: _,
            // Another side only where the transmission is elastic, which forbids the loop model.
            at_motor: _,
            wrap,
        } = sensor;
        self.values("sensor.position_noise_rad", position_noise, 0.0);
        if !class {
            // The bound for a class counts it as an error of readings.
            self.values("sensor.position_noise_max_rad", position_noise_max, 0.0);
        }
        if !class && position_bias.iter().any(|bias| bias.is_nan() || bias.abs() > 0.0) {
            // A tube counts it as a misreading, like the encoder's, and so does the bound for a class.
            self.add("sensor.position_bias_rad", text(position_bias), LeftOut::AllButTube);
        }
        self.values("sensor.velocity_noise_rad_s", velocity_noise, 0.0);
        self.values("sensor.torque_noise_nm", torque_noise, 0.0);
        if *wrap {
            self.add("sensor.wrap", "true", LeftOut::Bounds);
        }
    }

    fn fault(&mut self, fault: &Fault) {
        let Fault { kind, start, duration, joint: _, size: _ } = fault;
        // Whatever kind: a payload changes the inertia, a weak drive the gain, a lost sample the loop.
        let value = format!("{} from {start} s for {duration} s", kind.word());
        self.add("fault.kind", value, LeftOut::BoundsAndStability);
    }
}
