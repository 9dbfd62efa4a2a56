//! Torque that is fed forward along the reference, from what is known of the arm.

use phihat_model::{Model, Workspace};
use phihat_study::{Known, Study};

use crate::error::SimError;
use crate::motion::Motion;
use crate::spline::Jet;

/// Velocity at which fed-forward dry friction reaches 1/√2 of its level \[rad/s\].
const COULOMB_VELOCITY: f64 = 1e-3;

/// Feed-forward of a study on top of `M̄ q̈_d`.
///
/// # Law
///
/// ```text
/// τ_ff = g(q_d)  or  ID(q_d, q̇_d, q̈_d) − M̄ q̈_d,   + f̂ q̇_d/√(q̇_d² + v_c²)
///        (g and ID of the description with its masses scaled)
/// ```
///
/// If the robot adds gravity by itself, that description has none. With preview, all terms are evaluated in
/// the middle of the interval in which the torque will act. The law receives `q̈_d + τ_ff/M̄`.
#[derive(Debug)]
pub struct FeedForwardTorque {
    known: Known,
    model: Model,
    workspace: Workspace<f64>,
    coulomb: Vec<f64>,
    /// From a sample to the instant that it is about \[s\].
    ahead: f64,
    jets: [Vec<f64>; 3],
    rest: Vec<f64>,
    /// Torque of the description, without dry friction \[N·m\].
    torque: Vec<f64>,
}

impl FeedForwardTorque {
    /// `None`: the study feeds nothing forward but `M̄ q̈_d`.
    ///
    /// # Errors
    ///
    /// [`SimError::FeedForward`]: masses of that scale make no arm.
    pub fn of(study: &Study) -> Result<Option<Self>, SimError> {
        let Some(own) = &study.feedforward else { return Ok(None) };
        // The robot's own part is nobody else's.
        let adds = study.interface.profile.adds_gravity;
        let gravity = if adds { [0.0; 3] } else { study.world.gravity };
        let model = study.robot.plant_model().with_gravity(gravity);
        let model = model.with_masses_times(own.mass_scale).map_err(SimError::FeedForward)?;
        let period = study.control.period_ns as f64 * 1e-9;
        let middle = (f64::from(study.control.delay_samples) + 0.5) * period;
        let zero = vec![0.0; study.robot.joints.len()];
        Ok(Some(Self {
            known: own.known,
            workspace: Workspace::new(&model),
            model,
            coulomb: own.coulomb.clone(),
            ahead: if study.control.preview { middle } else { 0.0 },
            jets: [zero.clone(), zero.clone(), zero.clone()],
            rest: zero.clone(),
            torque: zero,
        }))
    }

    /// Feed-forward of the sample at `t` \[s\], over `M̄` \[kg·m²\] per joint: to be added to the
    /// acceleration that the law receives \[rad/s²\].
    pub fn acceleration(&mut self, motion: &Motion, t: f64, inertia: &[f64], out: &mut [f64]) {
        let t = t + self.ahead;
        self.known_at(|i| motion.at(i, t));
        for (i, out) in out.iter_mut().enumerate() {
            let (torque, instead) = self.of_joint(i);
            *out = torque / inertia[i] - instead;
        }
    }

    /// `τ_ff` \[N·m\] where the reference is so at the instant that it is about, [`ahead`](Self::ahead) of the sample.
    pub(crate) fn torque(
        &mut self,
        reference: impl Fn(usize) -> Jet,
        inertia: &[f64],
        out: &mut [f64],
    ) {
        self.known_at(reference);
        for (i, out) in out.iter_mut().enumerate() {
            let (torque, instead) = self.of_joint(i);
            *out = torque - inertia[i] * instead;
        }
    }

    /// From a sample to the instant that what is fed with it is about \[s\].
    pub(crate) fn ahead(&self) -> f64 {
        self.ahead
    }

    /// Feed-forward torque of a joint \[N·m\], and the acceleration whose `M̄ q̈_d` it replaces.
    fn of_joint(&self, i: usize) -> (f64, f64) {
        let [_, dq, ddq] = &self.jets;
        let dry = self.coulomb[i] * dq[i] / libm::hypot(dq[i], COULOMB_VELOCITY);
        let instead = if self.known == Known::InverseDynamics { ddq[i] } else { 0.0 };
        (self.torque[i] + dry, instead)
    }

    /// The torque of the description along a reference \[N·m\], without dry friction, goes into `torque`.
    fn known_at(&mut self, reference: impl Fn(usize) -> Jet) {
        let [q, dq, ddq] = &mut self.jets;
        for i in 0..q.len() {
            [q[i], dq[i], ddq[i]] = reference(i);
        }
        self.torque.fill(0.0);
        match self.known {
            Known::Nothing => {}
            Known::Gravity => {
                self.model.bias(&mut self.workspace, q, &self.rest, &mut self.torque);
            }
            Known::InverseDynamics => {
                self.model.inverse_dynamics(&mut self.workspace, q, dq, ddq, &mut self.torque);
            }
        }
    }
}

/// Feed-forward of a study at each of `samples` samples, over `M̄`: rows of `n`; empty where it has none.
///
/// # Errors
///
/// As [`FeedForwardTorque::of`].
pub fn fed_along(
    study: &Study,
    motion: &Motion,
    inertia: &[f64],
    samples: usize,
) -> Result<Vec<Vec<f64>>, SimError> {
    let Some(mut own) = FeedForwardTorque::of(study)? else { return Ok(Vec::new()) };
    let row = |k: usize| {
        let mut row = vec![0.0; inertia.len()];
        let t = (k as u64 * study.control.period_ns) as f64 * 1e-9;
        own.acceleration(motion, t, inertia, &mut row);
        row
    };
    Ok((0..samples).map(row).collect())
}
