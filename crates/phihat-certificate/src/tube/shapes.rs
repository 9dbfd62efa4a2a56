//! Known part of the deviation, up to constants of the run: forward runs of the reference system.

use super::dense::apply;
use super::frame::Frame;
use super::law::LawLoop;
use super::setting::TubeSetting;

/// One forward run.
#[derive(Debug, Clone)]
struct ForwardRun {
    /// `ε, P`.
    plant: Vec<f64>,
    loops: Vec<Vec<f64>>,
}

/// The runs: ten moments of the payload, each joint's level of dry friction, and the rest of the friction.
#[derive(Debug, Clone)]
pub(super) struct Shapes {
    load: usize,
    runs: Vec<ForwardRun>,
}

/// Lowest and highest sum of the runs, at the instants of a window, the first being the one before it.
#[derive(Debug, Clone, Default)]
pub(super) struct RunSpread {
    pub(super) position: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) velocity: Vec<(Vec<f64>, Vec<f64>)>,
    /// Command and change of command, by sample.
    pub(super) torque: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) step: Vec<(Vec<f64>, Vec<f64>)>,
    /// Largest twist of the hand over the window, `J ε'` over `J̇ ε'`.
    pub(super) twist: Vec<f64>,
    /// Largest that a drive's torque is off, per joint; empty without drives.
    pub(super) gap: Vec<f64>,
}

impl Shapes {
    pub(super) fn new(n: usize, loops: &[LawLoop], payload: bool) -> Self {
        let rest = ForwardRun {
            plant: vec![0.0; 2 * n],
            loops: loops.iter().map(|l| vec![0.0; l.size]).collect(),
        };
        let load = if payload { 10 } else { 0 };
        Self { load, runs: vec![rest; load + n + 1] }
    }

    /// Runs on through a window where the signs of the velocities are about `signs`, and the robot adds `added` more
    /// than in the nominal run.
    pub(super) fn advance(
        &self,
        setting: &TubeSetting<'_>,
        frame: &Frame,
        (signs, added): (&[Vec<f64>], &[Vec<f64>]),
    ) -> (Self, RunSpread) {
        let n = frame.bend.len();
        let mut after = self.clone();
        let mut spread = RunSpread {
            twist: vec![0.0; if self.load > 0 { 12 } else { 0 }],
            gap: vec![0.0; setting.arm.drives.len()],
            ..RunSpread::default()
        };
        after.look(setting, frame, &mut spread, true);
        for (at, signs) in signs.iter().enumerate() {
            let k = frame.first + at;
            for (c, run) in after.runs.iter_mut().enumerate() {
                let mut torque = vec![0.0; n];
                if c < self.load {
                    let middle = setting.load_torque(k);
                    torque.iter_mut().zip(&middle[c * n..]).for_each(|(t, y)| *t = -y);
                } else if c < self.load + n {
                    torque[c - self.load] = -signs[c - self.load];
                } else {
                    let levels = &setting.dry.middle;
                    for i in 0..n {
                        torque[i] = setting.run.dry[k][i] - levels[i] * signs[i];
                    }
                    torque.iter_mut().zip(&added[at]).for_each(|(t, added)| *t += added);
                }
                setting.step_shape(frame, k, &torque, (&mut run.plant, &mut run.loops));
            }
            after.look(setting, frame, &mut spread, false);
        }
        (after, spread)
    }

    fn look(
        &self,
        setting: &TubeSetting<'_>,
        frame: &Frame,
        spread: &mut RunSpread,
        entering: bool,
    ) {
        let n = frame.bend.len();
        let span = |values: &dyn Fn(&ForwardRun) -> f64| self.span(setting, values);
        let all = |of: &dyn Fn(&ForwardRun, usize) -> f64| -> (Vec<f64>, Vec<f64>) {
            (0..n).map(|i| span(&|shape| of(shape, i))).unzip()
        };
        spread.position.push(all(&|shape, i| shape.plant[i]));
        let rates: Vec<Vec<f64>> =
            self.runs.iter().map(|run| apply(&frame.m_inverse, &run.plant[n..])).collect();
        spread.velocity.push((0..n).map(|i| self.span_of(setting, &|c| rates[c][i])).unzip());
        for c in 0..spread.twist.len() {
            let row = &frame.outlook[c * n..(c + 1) * n];
            let (low, high) =
                self.span_of(setting, &|run| row.iter().zip(&rates[run]).map(|(j, v)| j * v).sum());
            spread.twist[c] = spread.twist[c].max(low.abs()).max(high.abs());
        }
        if entering {
            return;
        }
        for (i, gap) in spread.gap.iter_mut().enumerate() {
            let Some(at) = setting.joints[i].gap else { continue };
            let (low, high) = span(&|shape| shape.loops[i][at]);
            *gap = gap.max(low.abs()).max(high.abs());
        }
        let newest = |i: usize| setting.loops[i].newest();
        spread.torque.push(all(&|shape, i| shape.loops[i][newest(i)]));
        spread
            .step
            .push(all(&|shape, i| shape.loops[i][newest(i)] - shape.loops[i][newest(i) + 1]));
    }

    fn span(&self, setting: &TubeSetting<'_>, value: &dyn Fn(&ForwardRun) -> f64) -> (f64, f64) {
        self.span_of(setting, &|c| value(&self.runs[c]))
    }

    /// Over all payloads of the slice and all levels of friction.
    fn span_of(&self, setting: &TubeSetting<'_>, value: &dyn Fn(usize) -> f64) -> (f64, f64) {
        let n = self.runs.len() - self.load - 1;
        let rest = value(self.load + n);
        let (mut low, mut high) = (rest, rest);
        for i in 0..n {
            let dry = &setting.dry;
            let half = 0.5 * (dry.high[i] - dry.low[i]) * value(self.load + i).abs();
            low -= half;
            high += half;
        }
        if let Some(slice) = setting.arm.slice {
            let slopes = core::array::from_fn(value);
            let (a, b) = slice.range(&slopes);
            low += a;
            high += b;
        }
        (low, high)
    }
}

impl TubeSetting<'_> {
    /// Torques of the payload's moments in the middle of a sample.
    fn load_torque(&self, k: usize) -> &[f64] {
        &self.load[k][1]
    }

    /// One sample of the reference system under a held torque.
    fn step_shape(
        &self,
        frame: &Frame,
        k: usize,
        torque: &[f64],
        (plant, loops): (&mut Vec<f64>, &mut [Vec<f64>]),
    ) {
        let n = torque.len();
        let (position, momentum) = plant.split_at(n);
        let mut acting = torque.to_vec();
        let added = [(&frame.added.gravity, position), (&frame.added.damping_inverse, momentum)];
        for (matrix, x) in added {
            acting.iter_mut().zip(apply(matrix, x)).for_each(|(acting, added)| *acting += added);
        }
        let rates = if self.reads_rate { apply(&frame.m_inverse, momentum) } else { vec![0.0; n] };
        let mut off = Vec::new();
        for (i, own) in loops.iter_mut().enumerate() {
            let joint = &self.joints[i];
            joint.at(k).sample(own, (plant[i], rates[i]));
            acting[i] += own[joint.acting];
            off.extend(joint.gap.map(|at| own[at]));
        }
        let inputs: Vec<f64> = plant.iter().chain(&acting).chain(&off).copied().collect();
        *plant = apply(&frame.flow, &inputs);
    }
}
