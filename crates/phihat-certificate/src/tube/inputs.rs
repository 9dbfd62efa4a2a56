//! All that a tube is derived from: study, laws, motion, and what is uncertain.

use phihat_study::{PayloadSet, Study};

use super::dense::count;
use crate::JointRecord;

/// The motion that is wanted, at every sample and one more: `q`, `q̇`, `q̈` of all joints.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TubeReference {
    /// Position \[rad\].
    pub q: Vec<Vec<f64>>,
    /// Velocity \[rad/s\].
    pub dq: Vec<Vec<f64>>,
    /// Acceleration \[rad/s²\].
    pub ddq: Vec<Vec<f64>>,
}

impl TubeReference {
    /// The same with what is fed forward beside `q̈_d`, sample by sample \[rad/s²\].
    #[must_use]
    pub fn feeding(mut self, rows: &[Vec<f64>]) -> Self {
        for (own, row) in self.ddq.iter_mut().zip(rows) {
            own.iter_mut().zip(row).for_each(|(own, more)| *own += more);
        }
        self
    }

    /// Samples a motion, `t → q_d, q̇_d, q̈_d` of all joints, at every sample of a study's run and one more.
    pub fn of(study: &Study, at: impl Fn(f64) -> Vec<[f64; 3]>) -> Self {
        let period_ns = study.control.period_ns;
        let samples = count((study.duration * 1e9 / period_ns as f64).round().max(1.0));
        let mut out = Self::default();
        for k in 0..=samples {
            let jets = at((k as u64 * period_ns) as f64 * 1e-9);
            let row = |of: usize| jets.iter().map(|jet| jet[of]).collect();
            out.q.push(row(0));
            out.dq.push(row(1));
            out.ddq.push(row(2));
        }
        out
    }
}

/// All that a tube is derived from.
#[derive(Debug, Clone, Copy)]
pub struct TubeInputs<'a> {
    /// The study.
    pub study: &'a Study,
    /// One law per joint, in the robot's order.
    pub joints: &'a [JointRecord],
    /// The velocity filter in force \[Hz\].
    pub velocity_filter_hz: Option<f64>,
    /// The motion.
    pub reference: &'a TubeReference,
    /// Payloads that the arm may carry.
    pub payload: Option<&'a PayloadSet>,
    /// Into how many slices a claim divided it, for a hint of how finely to begin.
    pub slices: u32,
    /// Least and greatest level of dry friction \[N·m\] per joint.
    pub coulomb: (&'a [f64], &'a [f64]),
    /// Wanted length of a bin \[s\]: it becomes whole samples, one at least.
    pub bin_s: f64,
}

impl TubeInputs<'_> {
    /// Position \[rad\] and velocity \[rad/s\] at which the run begins.
    pub(super) fn start(&self) -> (Vec<f64>, Vec<f64>) {
        match &self.study.world.start {
            Some(start) => (start.q.clone(), start.dq.clone()),
            None => (self.reference.q[0].clone(), self.reference.dq[0].clone()),
        }
    }

    /// Torque that held the arm before the first sample \[N·m\] per joint.
    pub(super) fn held(&self) -> Vec<f64> {
        let held = self.study.held_torque(&self.start().0);
        held.unwrap_or_else(|| vec![0.0; self.joints.len()])
    }

    /// Half an encoder step \[rad\] per joint.
    pub(super) fn half_steps(&self) -> Vec<f64> {
        let n = self.joints.len();
        let bits = self.study.sensor.encoder_bits.as_ref();
        let of = |i: usize| {
            bits.map_or(0.0, |bits| core::f64::consts::PI / 2.0_f64.powi(bits[i].cast_signed()))
        };
        (0..n).map(of).collect()
    }

    /// Most that a reading may be off \[rad\] per joint: half a step, and the bias.
    pub(super) fn misread(&self) -> Vec<f64> {
        let bias = &self.study.sensor.position_bias;
        self.half_steps().iter().zip(bias).map(|(half, bias)| half + bias.abs()).collect()
    }
}
