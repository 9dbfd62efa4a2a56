//! Torque along a reference: the unknown dynamics `φ`, by inverse dynamics.

use phihat_model::{Model, Rotor, Workspace};
use phihat_study::Study;

use crate::error::SimError;
use crate::motion::Motion;
use crate::world::{frictions, loaded, loaded_model};

/// Bounds on one joint's `φ = τ − M̄ q̈` in the steady part of a reference or a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhiAlong {
    /// Largest |φ| \[N·m\], jumps included.
    pub size: f64,
    /// Largest |φ̇| of the smooth part \[N·m/s\].
    pub rate: f64,
    /// Largest size of the part that jumps \[N·m\]: dry friction and pushes.
    pub jump: f64,
}

/// The torque that a study's reference asks for, without and with the heaviest payloads.
///
/// # Method
///
/// ```text
/// τ(t) = M(q_d) q̈_d + C(q_d, q̇_d) q̇_d + g(q_d) + smooth friction(q̇_d),   φ = τ − M̄ q̈_d          (DM1)
/// ```
///
/// at every control sample after `spec.settle`, for the study's own payload, for none, and for the heaviest
/// ones the design must bear, at the corners of the box of their centres of mass, and at both ends of the
/// rotors' intervals; dry friction at its highest. Remark 11 of the paper.
///
/// # Not claimed
///
/// The arm follows its reference with an error; what that error adds to `φ` is not in here.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    period: f64,
    /// `torques[case][joint][sample]`.
    torques: Vec<Vec<Vec<f64>>>,
    /// `ddq[joint][sample]`.
    ddq: Vec<Vec<f64>>,
    /// Largest |q̇_d| per joint.
    speeds: Vec<f64>,
    jumps: Vec<f64>,
}

impl PhiAlong {
    /// Bounds that hold where either of two do: the larger of each.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            size: self.size.max(other.size),
            rate: self.rate.max(other.rate),
            jump: self.jump.max(other.jump),
        }
    }

    /// These bounds, every one times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { size: self.size * factor, rate: self.rate * factor, jump: self.jump * factor }
    }
}

impl Demand {
    /// Walks along a study's reference.
    ///
    /// # Errors
    ///
    /// [`SimError`] when the reference cannot be reached or the payload not attached.
    pub fn along(study: &Study) -> Result<Self, SimError> {
        let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
        let period = study.control.period_ns as f64 * 1e-9;
        let mut cases = vec![loaded_model(study)?];
        let set = &study.design.payload;
        // Each φ_i is affine in its joint's own rotor inertia, so that its bounds are convex and attained at
        // the ends of the interval.
        let rotors: &[Rotor] = if study.robot.has_rotor_interval() {
            &[Rotor::Least, Rotor::Most]
        } else {
            &[Rotor::Stated]
        };
        for rotor in rotors {
            let bare = study.robot.plant_model_at(*rotor).with_gravity(study.world.gravity);
            cases.push(bare.clone());
            if set.mass.1 > 0.0 {
                for body in set.heaviest() {
                    cases.push(loaded(bare.clone(), &set.frame, &body)?);
                }
            }
        }
        let times = times(study, period);
        let n = study.robot.joints.len();
        let mut ddq = vec![Vec::with_capacity(times.len()); n];
        let mut speeds = vec![0.0_f64; n];
        for t in &times {
            for (joint, row) in ddq.iter_mut().enumerate() {
                let [_, speed, acceleration] = motion.at(joint, *t);
                row.push(acceleration);
                speeds[joint] = speeds[joint].max(speed.abs());
            }
        }
        let torques = cases.iter().map(|model| torques(model, study, &motion, &times)).collect();
        Ok(Self { period, torques, ddq, speeds, jumps: jumps(study) })
    }

    /// Largest |q̇_d| \[rad/s\] of a joint's reference.
    pub fn velocity(&self, joint: usize) -> f64 {
        self.speeds[joint]
    }

    /// Largest |q̈_d| \[rad/s²\] and |q⃛_d| \[rad/s³\] of a joint's reference.
    pub fn motion(&self, joint: usize) -> (f64, f64) {
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0_f64, |most, value| value.abs().max(most))
        };
        let ddq = &self.ddq[joint];
        let mut steps = ddq.windows(2).map(|pair| pair[1] - pair[0]);
        (largest(&mut ddq.iter().copied()), largest(&mut steps) / self.period)
    }

    /// Bounds on a joint's `φ` along the reference, for a nominal inertia `M̄` \[kg·m²\].
    pub fn phi(&self, joint: usize, inertia: f64) -> PhiAlong {
        let jump = self.jumps[joint];
        let mut bounds = PhiAlong { size: 0.0, rate: 0.0, jump };
        for case in &self.torques {
            let mut before: Option<f64> = None;
            for (tau, ddq) in case[joint].iter().zip(&self.ddq[joint]) {
                let phi = tau - inertia * ddq;
                bounds.size = bounds.size.max(phi.abs() + jump);
                let rate = before.map_or(0.0, |before| (phi - before).abs() / self.period);
                bounds.rate = bounds.rate.max(rate);
                before = Some(phi);
            }
        }
        bounds
    }
}

fn times(study: &Study, period: f64) -> Vec<f64> {
    let samples = crate::simulation::samples(study.duration, study.control.period_ns);
    (0..samples).map(|k| k as f64 * period).filter(|t| *t >= study.spec.settle).collect()
}

/// `[joint][sample]`: rigid-body torque and smooth friction along the reference.
fn torques(model: &Model, study: &Study, motion: &Motion, times: &[f64]) -> Vec<Vec<f64>> {
    let n = study.robot.joints.len();
    let mut frictions = frictions(study);
    for friction in &mut frictions {
        friction.coulomb = 0.0;
    }
    let mut workspace = Workspace::new(model);
    let (mut q, mut dq, mut ddq, mut tau) =
        (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut rows = vec![Vec::with_capacity(times.len()); n];
    for t in times {
        for i in 0..n {
            [q[i], dq[i], ddq[i]] = motion.at(i, *t);
        }
        model.inverse_dynamics(&mut workspace, &q, &dq, &ddq, &mut tau);
        for i in 0..n {
            rows[i].push(tau[i] + frictions[i].torque(dq[i]));
        }
    }
    rows
}

fn jumps(study: &Study) -> Vec<f64> {
    let dry = frictions(study).into_iter().zip(&study.design.coulomb.1);
    let dry = dry.map(|(friction, most)| friction.coulomb.max(*most));
    dry.enumerate()
        .map(|(joint, coulomb)| {
            let pushes = study.world.pushes.iter().filter(|p| p.joint == joint);
            coulomb + pushes.map(|p| p.torque.abs()).sum::<f64>()
        })
        .collect()
}
