//! An arm at one posture under the core's own laws from positions: `M q̈ = τ − φ` between samples, exactly.
//! Knows nothing of the checker.

use phihat::{
    InnovationSection, JointGains, JointState, Measurement, PositionDesign, Reference, TorqueSource,
};
use phihat_certificate::{JointRecord, LoopModel};
use std::collections::VecDeque;

/// A law in its loop.
pub(crate) type Joint = (JointRecord, LoopModel);

/// External torque, reading error and fed-forward acceleration of one joint in one sample.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Push {
    pub(crate) phi: f64,
    pub(crate) reading: f64,
    pub(crate) ddq: f64,
}

#[derive(Clone)]
struct Torques {
    law: JointGains<f64>,
    state: JointState<f64>,
    model: LoopModel,
    inertia: f64,
    line: VecDeque<f64>,
    mean: f64,
    end: f64,
}

/// The arm, with torques and inertia in units of `M̄`.
#[derive(Clone)]
pub(crate) struct Arm {
    joints: Vec<Torques>,
    /// The mean of `W⁻¹` over the sample to come.
    pub(crate) inverse: Vec<Vec<f64>>,
    /// The same with the weights `2(T − s)/T²`, as position sees it.
    pub(crate) kicked: Vec<Vec<f64>>,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) asked: Vec<f64>,
}

/// `None`: the core does not run these gains.
fn law(record: &JointRecord, period: f64) -> Option<JointGains<f64>> {
    let own = record.observer.as_ref()?;
    let design = PositionDesign {
        inertia: record.inertia_kg_m2,
        kp: record.kp_per_s2,
        kd: record.kd_per_s,
        correction: &own.correction,
        velocity_correction: &[],
        share: own.share,
        delay: own.delay_samples as usize,
        period,
    };
    let law = JointGains::from_positions(&design).ok()?;
    let sections: Vec<InnovationSection> = own.innovation_filter.iter().map(Into::into).collect();
    if sections.is_empty() { Some(law) } else { law.with_innovation_filter(&sections).ok() }
}

impl Arm {
    /// `None`: the core does not run these gains.
    pub(crate) fn new(joints: &[Joint], inverse: Vec<Vec<f64>>) -> Option<Self> {
        let of = |(record, model): &Joint| {
            let late = (model.delay_samples + model.sample_delay_samples) as usize;
            Some(Torques {
                law: law(record, model.period_s)?,
                state: JointState::new(),
                model: *model,
                inertia: record.inertia_kg_m2,
                line: VecDeque::from(vec![0.0; late]),
                mean: 0.0,
                end: 0.0,
            })
        };
        let joints: Option<Vec<_>> = joints.iter().map(of).collect();
        let n = inverse.len();
        let none = vec![0.0; n];
        let mut arm = Self {
            joints: joints?,
            kicked: inverse.clone(),
            inverse,
            q: none.clone(),
            v: none.clone(),
            asked: none,
        };
        // The first sample tells a law where it is.
        arm.step(&vec![Push::default(); n]);
        Some(arm)
    }

    /// One joint at one ratio.
    pub(crate) fn single(joint: &Joint, mu: f64) -> Option<Self> {
        Self::new(core::slice::from_ref(joint), vec![vec![1.0 / mu]])
    }

    pub(crate) fn step(&mut self, push: &[Push]) {
        let t = self.joints[0].model.period_s;
        let (mut means, mut doubles) = (Vec::new(), Vec::new());
        for (i, joint) in self.joints.iter_mut().enumerate() {
            let m = Measurement {
                q: self.q[i] + push[i].reading,
                dq: 0.0,
                tau_applied: joint.mean * joint.inertia,
            };
            let reference = Reference { q: 0.0, dq: 0.0, ddq: push[i].ddq };
            let u = joint.law.update(&mut joint.state, &m, &reference).tau / joint.inertia;
            self.asked[i] = u;
            joint.line.push_back(u);
            let told = joint.line.pop_front().unwrap_or(u);
            let (mean, double) = joint.driven(told, t);
            means.push(mean - push[i].phi);
            doubles.push(double - 0.5 * t * t * push[i].phi);
        }
        let by = |row: &[f64], of: &[f64]| row.iter().zip(of).map(|(a, b)| a * b).sum::<f64>();
        for (i, (row, kicked)) in self.inverse.iter().zip(&self.kicked).enumerate() {
            self.q[i] += t * self.v[i] + by(kicked, &doubles);
            self.v[i] += t * by(row, &means);
        }
    }

    /// The largest error within some samples.
    pub(crate) fn largest(&mut self, samples: usize) -> f64 {
        let nothing = vec![Push::default(); self.q.len()];
        let mut most = 0.0_f64;
        for _ in 0..samples {
            self.step(&nothing);
            most = self.q.iter().fold(most, |most, q| most.max(q.abs()));
        }
        most
    }
}

impl Torques {
    /// The drive over one interval: mean torque, double integral.
    fn driven(&mut self, told: f64, t: f64) -> (f64, f64) {
        let (mut mean, mut double) = (told, 0.5 * t * t * told);
        if let Some(hz) = self.model.drive_bandwidth_hz {
            let rate = core::f64::consts::TAU * hz;
            let (gap, left) = (self.end - told, (-rate * t).exp());
            mean += gap * (1.0 - left) / (rate * t);
            double += gap * (rate * t - (1.0 - left)) / (rate * rate);
            self.end = told + left * gap;
        }
        self.mean = if self.model.torque == TorqueSource::Demanded { told } else { mean };
        (mean, double)
    }
}

/// Growth from one block of samples to the next, the last of them a fifth of the run; infinite beyond all bounds.
pub(crate) fn growth(arm: &mut Arm, samples: usize) -> f64 {
    let block = samples / 5;
    let early = arm.largest(3 * block);
    let before = arm.largest(block);
    let after = arm.largest(block);
    if !after.is_finite() || after > 1e6 * early {
        return f64::INFINITY;
    }
    // What is left of rounding does not grow.
    if after < 1e-12 * early { 0.0 } else { after / before }
}

/// `ℓ` of an observer with its poles at `poles`, `m + 2` of them, by Ackermann's formula in time units of `T`.
pub(crate) fn correction(poles: &[f64], t: f64) -> Vec<f64> {
    let n = poles.len();
    let carried = |x: &[f64]| {
        let mut next = x.to_vec();
        next[0] += x[1] - 0.5 * x[2];
        next[1] -= x[2];
        for i in 2..n - 1 {
            next[i] += x[i + 1];
        }
        next
    };
    // Columns: F^k e_j; the innovation of the sample to come sees the first entry of F x.
    let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
    let mut rows = vec![vec![0.0; n + 1]; n];
    for j in 0..n {
        let mut x = unit(j);
        for row in &mut rows {
            x = carried(&x);
            row[j] = x[0];
        }
    }
    rows[n - 1][n] = 1.0;
    let mut x = solve(rows);
    for pole in poles {
        x = carried(&x).iter().zip(&x).map(|(next, own)| next - pole * own).collect();
    }
    let mut scale = 1.0;
    for value in &mut x {
        *value *= scale;
        scale /= t;
    }
    x
}

/// Gauss and Jordan, the right side as the last column.
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for c in 0..n {
        let pivot = (c..n).max_by(|a, b| rows[*a][c].abs().total_cmp(&rows[*b][c].abs()));
        rows.swap(c, pivot.unwrap_or(c));
        let own = rows[c].clone();
        for (r, row) in rows.iter_mut().enumerate() {
            let share = if r == c { 0.0 } else { row[c] / own[c] };
            row.iter_mut().zip(&own).for_each(|(value, other)| *value -= share * other);
        }
    }
    (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
}
