//! Setting of a sweep: the arm with one slice of the payloads, its nominal run, and the loops around its
//! joints.

use super::adjoint::AdjointRows;
use super::chain::TubeChain;
use super::dense::count;
use super::frame::ArmTerms;
use super::inputs::TubeInputs;
use super::law::{LawLoop, LinearLoop};
use super::nominal::CheckedNominal;
use super::scope::{AddedTorques, DryLevels, PayloadSlice, Smooth};

/// Data that stay the same from the first sample to the last.
pub(super) struct TubeSetting<'a> {
    pub(super) inputs: &'a TubeInputs<'a>,
    pub(super) arm: ArmTerms<'a>,
    pub(super) run: &'a CheckedNominal,
    pub(super) dry: &'a DryLevels,
    pub(super) loops: &'a [LawLoop],
    pub(super) n: usize,
    /// Entries of the hand's twist; 0 without a payload.
    pub(super) hand: usize,
    pub(super) period: f64,
    /// The loops, linear.
    pub(super) joints: Vec<LinearLoop>,
    /// True if velocity at a sample is read, by a sensor or by the robot.
    pub(super) reads_rate: bool,
    /// Most that a reading may be off \[rad\] per joint.
    pub(super) half_step: Vec<f64>,
    /// Torques of the payload's moments, by sample: at its start, in its middle, at its end; empty without a payload.
    pub(super) load: Vec<[Vec<f64>; 3]>,
    /// Pushes that begin or end within a sample: the sample, the joint, the size.
    pub(super) pushes: Vec<(usize, usize, f64)>,
}

impl<'a> TubeSetting<'a> {
    pub(super) fn new(
        inputs: &'a TubeInputs<'a>,
        (chain, slice, smooth): (&'a TubeChain, Option<&'a PayloadSlice>, &'a [Smooth]),
        (run, dry, adds): (&'a CheckedNominal, &'a DryLevels, &'a AddedTorques),
        (loops, drives): (&'a [LawLoop], &'a [f64]),
    ) -> Self {
        let period = inputs.study.control.period_ns as f64 * 1e-9;
        let n = loops.len();
        let joints = loops.iter().map(LawLoop::linear_loop).collect();
        let measured = loops.iter().any(|own| own.measured);
        let samples = run.command.len();
        let load = match slice {
            None => Vec::new(),
            Some(_) => (0..samples).map(|k| load_torques(chain, run, k)).collect(),
        };
        Self {
            inputs,
            arm: ArmTerms { chain, slice, smooth, adds, drives, period },
            run,
            dry,
            loops,
            n,
            hand: if slice.is_some() { 6 } else { 0 },
            period,
            joints,
            reads_rate: measured || adds.friction.is_some(),
            half_step: inputs.misread(),
            load,
            pushes: pushes(inputs, period, samples),
        }
    }

    /// The loop, as the rows see it.
    pub(super) fn rows(&self) -> AdjointRows<'_> {
        AdjointRows {
            n: self.n,
            period: self.period,
            joints: &self.joints,
            reads_rate: self.reads_rate,
            half_step: &self.half_step,
        }
    }
}

/// Pushes that begin or end within one of so many samples.
fn pushes(inputs: &TubeInputs<'_>, period: f64, samples: usize) -> Vec<(usize, usize, f64)> {
    let mut pushes = Vec::new();
    for push in &inputs.study.world.pushes {
        for edge in [push.start, push.start + push.duration] {
            let at = edge / period;
            if (at - at.round()).abs() > 1e-6 && at < samples as f64 {
                pushes.push((count(at.floor()), push.joint, push.torque.abs()));
            }
        }
    }
    pushes
}

fn load_torques(chain: &TubeChain, run: &CheckedNominal, k: usize) -> [Vec<f64>; 3] {
    let of = |q: &[f64], v: &[f64], a: &[f64]| chain.place::<f64>(q, None).load_torques(v, a);
    [
        of(&run.q[k], &run.v[k], &run.a[k][0]),
        of(&run.q_mid[k], &run.v_mid[k], &run.a[k][1]),
        of(&run.q[k + 1], &run.v[k + 1], &run.a[k][2]),
    ]
}
