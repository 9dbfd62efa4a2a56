//! Boxes around all that acts on the samples of a window and that its frame does not contain.

use super::adjoint::Boxes;
use super::dense::{apply_sizes, transpose};
use super::frame::{Distance, Frame, arc};
use super::round::RoundGuess;
use super::scope::DryLevels;
use super::setting::TubeSetting;

impl TubeSetting<'_> {
    /// Boxes that are the same for all samples of a window.
    pub(super) fn smooth_boxes(
        &self,
        distance: &Distance,
        guess: &RoundGuess,
        sizes: &[f64],
    ) -> Boxes {
        let n = self.n;
        let mut out = Boxes::none(n, self.hand);
        let s = apply_sizes(&distance.s, sizes);
        let k = apply_sizes(&distance.k, &guess.reach);
        let posture = apply_sizes(&distance.m, sizes);
        for i in 0..n {
            let mut bend = 0.0;
            for j in 0..n {
                for l in 0..n {
                    bend += distance.slopes[(i * n + j) * n + l] * sizes[j] * sizes[l];
                }
            }
            out.u[i] = s[i] + k[i] + 0.5 * bend;
            out.x[i] = posture[i];
        }
        if let Some(slice) = self.arm.slice {
            let deviation = slice.deviation();
            for (mu, row) in out.mu.iter_mut().zip(&deviation) {
                *mu = row.iter().zip(&guess.twist).map(|(d, nu)| d * nu).sum();
            }
            let (twist, turning) = guess.twist.split_at(6);
            out.wrench = apply_sizes(&distance.wrench, twist);
            for (wrench, row) in out.wrench.iter_mut().zip(&deviation) {
                *wrench += row.iter().zip(turning).map(|(d, rate)| d * rate).sum::<f64>();
            }
            let add = |to: &mut [f64], by: &[f64], size: &[f64]| {
                let turned = apply_sizes(&transpose(by, (6, n)), size);
                to.iter_mut().zip(turned).for_each(|(x, t)| *x += t);
            };
            add(&mut out.x, &distance.hand_now, &out.mu);
            add(&mut out.u, &distance.rate, &out.mu);
            add(&mut out.u, &distance.hand, &out.wrench);
        }
        out
    }

    /// Boxes of one sample, and the middle of the sign of each joint's velocity in it.
    pub(super) fn sample_boxes(
        &self,
        frame: &Frame,
        (k, smooth): (usize, &Boxes),
        inside: &(Vec<f64>, Vec<f64>),
    ) -> (Boxes, Vec<f64>) {
        let n = self.n;
        let run = self.run;
        let mut out = smooth.clone();
        let mut middles = vec![0.0; n];
        let ends = |i: usize| {
            let (a, b, c) = (run.v[k][i], run.v_mid[k][i], run.v[k + 1][i]);
            let arc = arc(&run.v, &run.v_mid, k, i);
            (a.min(b).min(c) - arc + inside.0[i], a.max(b).max(c) + arc + inside.1[i])
        };
        // A stage of the simulator's integration may see another velocity than the run has.
        let jump: Vec<f64> = (0..n)
            .map(|i| {
                let (low, high) = ends(i);
                self.dry.high[i] * (DryLevels::sign(high) - DryLevels::sign(low)).abs()
            })
            .collect();
        let kick = apply_sizes(&frame.m_inverse, &jump);
        let step = self.period / f64::from(self.inputs.study.world.substeps.max(1));
        let drift: Vec<f64> = kick.iter().map(|a| step * a / 72.0).collect();
        let (defect_q, defect_v) = &run.defect[k];
        let rates: Vec<f64> =
            defect_q.iter().zip(&drift).map(|(q, d)| q / self.period + d).collect();
        let lost = apply_sizes(&frame.m, &rates);
        let dragged = apply_sizes(&frame.s, &rates);
        let pushed = apply_sizes(&frame.m, defect_v);
        for i in 0..n {
            let (mut low, mut high) = ends(i);
            let slip = step * kick[i];
            (low, high) = (low - slip, high + slip);
            let (a, b) = (DryLevels::sign(low), DryLevels::sign(high));
            middles[i] = 0.5 * (a + b);
            let (v_low, v_high) = ends(i);
            let v = inside.0[i].abs().max(inside.1[i].abs());
            // From the nominal velocity to the true one.
            let (below, above) = (inside.0[i].max(0.0), inside.1[i].min(0.0));
            let bend = self.arm.smooth[i].bend(v_low - below, v_high - above);
            out.u[i] += self.dry.high[i] * 0.5 * (b - a)
                + 0.5 * bend * v * v
                + dragged[i]
                + pushed[i] / self.period;
            out.x[i] += lost[i];
        }
        for (at, joint, size) in &self.pushes {
            if *at == k {
                out.u[*joint] += size;
            }
        }
        if let Some(slice) = self.arm.slice {
            let [start, middle, end] = &self.load[k];
            for i in 0..n {
                let off = |other: &[f64]| {
                    let slopes = core::array::from_fn(|c| other[c * n + i] - middle[c * n + i]);
                    let (low, high) = slice.range(&slopes);
                    low.abs().max(high.abs())
                };
                // Three instants of a sample; in between it may be half as much again.
                out.u[i] += 1.5 * off(start).max(off(end));
            }
        }
        (out, middles)
    }

    /// The robot's added torque at a sample, less that of the nominal run: its known part; the rest goes to
    /// the boxes.
    pub(super) fn added(
        &self,
        distance: &Distance,
        (k, reach): (usize, &[f64]),
        (low, high): &(Vec<f64>, Vec<f64>),
        boxes: &mut Boxes,
    ) -> Vec<f64> {
        let adds = self.arm.adds;
        let gravity = apply_sizes(&distance.added.gravity, reach);
        boxes.u.iter_mut().zip(gravity).for_each(|(u, off)| *u += off);
        let Some(friction) = &adds.friction else { return vec![0.0; self.n] };
        let of = |i: usize| {
            let v = self.run.v[k][i];
            let size = low[i].abs().max(high[i].abs());
            let (from, to) = (v + low[i].min(0.0), v + high[i].max(0.0));
            let bend = 0.5 * friction[i].bend(from, to) * size * size;
            let (a, b) = (DryLevels::sign(v + low[i]), DryLevels::sign(v + high[i]));
            boxes.u[i] +=
                distance.added.damping[i] * size + bend + adds.dry[i].abs() * 0.5 * (b - a);
            adds.dry[i] * (0.5 * (a + b) - self.dry.wide(v))
        };
        (0..self.n).map(of).collect()
    }
}
