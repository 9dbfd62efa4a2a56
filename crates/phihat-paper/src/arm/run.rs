//! One run of the arm, and what is read off it.

use phihat_campaign::statistics::rms;
use phihat_design::requested_gains;
use phihat_model::Workspace;
use phihat_sim::{JointTrace, Simulation, SimulationOutcome};
use phihat_study::Study;

use crate::part::PartError;

/// |e| below which the arm counts as settled, the bound of (48) and (49) \[rad\].
pub(crate) const SETTLED_RAD: f64 = 1e-2;

/// A study and what came of it.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) study: Box<Study>,
    pub(crate) outcome: SimulationOutcome,
}

impl Run {
    /// Runs the gains that the study states, in its form.
    pub(crate) fn of(study: Study) -> Result<Self, PartError> {
        let study = Box::new(study);
        let gains =
            requested_gains(&study).ok_or(PartError::Missing("the study states no gains"))?;
        let names = study.robot.joint_names();
        let form = study.control.form;
        let law = gains.joint_gains(&names, study.control.period_ns, form);
        let law = law.map_err(|why| PartError::UnitLaw { study: study.name.clone(), why })?;
        let simulation = Simulation::new(&study, &law)
            .map_err(|why| PartError::Run { study: study.name.clone(), why })?;
        Ok(Self { outcome: simulation.run(|_| ()), study })
    }

    pub(crate) fn joints(&self) -> &[JointTrace] {
        &self.outcome.trace.joints
    }

    pub(crate) fn diverged(&self) -> bool {
        self.outcome.divergence.is_some()
    }

    /// Sample period \[s\].
    pub(crate) fn period(&self) -> f64 {
        self.outcome.trace.period_ns as f64 * 1e-9
    }

    /// Time of every sample \[s\].
    pub(crate) fn times(&self) -> impl Iterator<Item = f64> {
        self.outcome.trace.t_ns.iter().map(|t| *t as f64 * 1e-9)
    }

    /// First sample of the steady part.
    pub(crate) fn steady_from(&self) -> usize {
        self.outcome.trace.index_at(self.study.spec.settle)
    }

    /// Largest |∬e| \[rad·s²\], |∫e| \[rad·s\], |e| \[rad\], |ė| \[rad/s\] of any joint over the steady part, its
    /// integrals counted from where that begins, in either form alike; `None` where the run diverged.
    pub(crate) fn steady(&self) -> Option<[f64; 4]> {
        self.ladder(self.steady_from())
    }

    /// The largest errors of [`Run::steady`], with integrals counted from the first sample on: in the printed form
    /// they are its state.
    pub(crate) fn since_start(&self) -> Option<[f64; 4]> {
        self.ladder(0)
    }

    /// The integrals are those of the measured error, the law's own sums: the first sample is not integrated over.
    fn ladder(&self, begin: usize) -> Option<[f64; 4]> {
        let from = self.steady_from();
        let mut ladder = [0.0_f64; 4];
        for joint in self.joints() {
            let (mut once, mut twice) = (0.0, 0.0);
            for k in begin..joint.e.len() {
                if k > begin {
                    once += self.period() * (joint.q_measured[k] - joint.q_desired[k]);
                    twice += self.period() * once;
                }
                if k >= from {
                    let now = [twice, once, joint.e[k], joint.de[k]];
                    ladder = core::array::from_fn(|i| ladder[i].max(now[i].abs()));
                }
            }
        }
        (!self.diverged()).then_some(ladder)
    }

    /// Error of the steady part, root mean square, of the worst joint \[rad\]: by (7) it is what the mismatch leaves.
    pub(crate) fn steady_rms(&self) -> f64 {
        let from = self.steady_from();
        let of = |joint: &JointTrace| rms(&joint.e[from..]);
        self.joints().iter().map(of).fold(0.0, f64::max)
    }

    /// When every |e| has come below [`SETTLED_RAD`] for good \[s\]; `None`: not by the end of the run.
    pub(crate) fn settled_at(&self) -> Option<f64> {
        let last = |joint: &JointTrace| joint.e.iter().rposition(|e| e.abs() > SETTLED_RAD);
        let last = self.joints().iter().filter_map(last).max();
        let settled = last.map_or(0, |k| k + 1);
        let inside = settled < self.outcome.trace.len() && !self.diverged();
        inside.then_some(settled as f64 * self.period())
    }

    /// Overshoot of a joint's error beyond zero, as a share of its initial error.
    pub(crate) fn overshoot(&self, joint: usize) -> f64 {
        let e = &self.joints()[joint].e;
        let Some(first) = e.first().filter(|e| **e != 0.0) else { return 0.0 };
        e.iter().fold(0.0, |most: f64, e| most.max(-e / first))
    }

    /// Largest `|φ̂(0)|` of any joint \[N·m\].
    pub(crate) fn phi_hat_at_start(&self) -> f64 {
        let first = self.joints().iter().filter_map(|joint| joint.phi_hat.first());
        first.fold(0.0, |most: f64, phi| most.max(phi.abs()))
    }

    /// Tip and desired tip in the plane of the arm \[m\], at every `stride`-th sample.
    pub(crate) fn tips(&self, stride: usize) -> Result<Vec<[[f64; 2]; 2]>, PartError> {
        let model = &self.study.robot.model;
        let frame =
            model.frame(&self.study.robot.tip).ok_or(PartError::Missing("the robot has no tip"))?;
        let mut workspace = Workspace::new(model);
        let mut at = |q: &[f64]| {
            model.forward_kinematics(&mut workspace, q);
            let p = model.pose(&workspace, frame).p;
            [p[0], p[2]]
        };
        let of = |column: fn(&JointTrace) -> &Vec<f64>, k: usize| -> Vec<f64> {
            self.joints().iter().map(|joint| column(joint)[k]).collect()
        };
        let samples = (0..self.outcome.trace.len()).step_by(stride.max(1));
        Ok(samples.map(|k| [at(&of(|j| &j.q, k)), at(&of(|j| &j.q_desired, k))]).collect())
    }

    /// Overshoot of the tip beyond its desired position, along the line of its initial error \[m\].
    pub(crate) fn tip_overshoot(&self) -> Result<f64, PartError> {
        let tips = self.tips(1)?;
        let away = |[tip, wanted]: &[[f64; 2]; 2]| [tip[0] - wanted[0], tip[1] - wanted[1]];
        let Some([x, y]) = tips.first().map(away) else { return Ok(0.0) };
        let length = x.hypot(y);
        let along = |pair: &[[f64; 2]; 2]| {
            let [dx, dy] = away(pair);
            -(dx * x + dy * y) / length
        };
        Ok(if length > 0.0 { tips.iter().map(along).fold(0.0, f64::max) } else { 0.0 })
    }

    /// Largest |τ| that any drive was told \[N·m\].
    pub(crate) fn torque_max(&self) -> f64 {
        self.outcome.told_max.iter().copied().fold(0.0, f64::max)
    }

    /// Largest and root mean square of |φ̂ − φ| over the steady part, of the worst joint \[N·m\].
    pub(crate) fn mismatch(&self) -> [f64; 2] {
        let from = self.steady_from();
        let of = |joint: &JointTrace| {
            let gaps = joint.phi_hat.iter().zip(&joint.phi).skip(from).map(|(a, b)| a - b);
            let (mut most, mut squares, mut count) = (0.0_f64, 0.0, 0.0_f64);
            for gap in gaps {
                most = most.max(gap.abs());
                squares += gap * gap;
                count += 1.0;
            }
            [most, (squares / count.max(1.0)).sqrt()]
        };
        let joints = self.joints().iter().map(of);
        joints.fold([0.0; 2], |a: [f64; 2], b| [a[0].max(b[0]), a[1].max(b[1])])
    }

    /// Largest |φ| over the steady part \[N·m\].
    pub(crate) fn phi_max(&self) -> f64 {
        let from = self.steady_from();
        let values = self.joints().iter().flat_map(|joint| joint.phi.iter().skip(from));
        values.fold(0.0, |most: f64, phi| most.max(phi.abs()))
    }
}

/// An arm with links `links` times as heavy and rotors of `armature` \[kg·m²\]; friction and torque limits
/// grow with the links.
///
/// Divided by `links`, the equation of motion is that of the arm as it is with the rotors and `M̄` divided by it.
pub fn resized(mut study: Study, links: f64, armature: f64) -> Study {
    for joint in &mut study.robot.joints {
        joint.armature = armature / links;
    }
    if let Some(gains) = &mut study.gains {
        gains.inertia.iter_mut().for_each(|inertia| *inertia /= links);
    }
    study
}
