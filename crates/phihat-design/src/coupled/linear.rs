//! Several joints' loops on one inertia matrix, as one linear step, and its impulse responses.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::Extremes as _;
use phihat_certificate::{JointRecord, LoopModel};

use crate::lanes::{Lane, WIDE};
use crate::portable;
use crate::sampled::mean_of_line;
use crate::sampled::sample::{Input, SampledLoop};

/// Outputs of a joint: `e`, `ė`, `ë` without the push itself, change of commanded torque, change of acting torque.
pub(crate) const OUTPUTS: usize = 5;

/// Outputs that are changes from sample to sample.
pub(super) const CHANGES: [usize; 2] = [3, 4];

/// Outputs after a torque impulse at an interval's start, at its end, and after an encoder's error; one left over.
pub(crate) type Lines = [f64; 16];

/// Sums over a response's whole future, per output: from torque (absolute integral), from the encoder (absolute sum).
pub(crate) type ResponseSums = [[f64; OUTPUTS]; 2];

/// Largest remainder of the state when a sum is cut; the remainder of a response is bounded and added.
pub(crate) const LEFT: f64 = 1e-4;

/// Longest horizon is `2^DOUBLINGS` samples.
const DOUBLINGS: u32 = 20;

impl GivenOther {
    /// On joint `j`, whose law is fed the torque that acted at a place of its state, in units of its inertia, if any.
    fn of(
        (period, j): (f64, usize),
        inverse: &DMatrix<f64>,
        (starts, scales): (&[usize], &[DVector<f64>]),
        place: Option<(usize, f64)>,
    ) -> Self {
        let n = starts.len();
        let length: usize = scales.iter().map(DVector::len).sum();
        let mut other = vec![0.0; length];
        let mut meanwhile = vec![[0.0; OUTPUTS]; n];
        for i in 0..n {
            other[starts[i]] = 0.5 * period * period * inverse[(i, j)] / scales[i][0];
            other[starts[i] + 1] = period * inverse[(i, j)] / scales[i][1];
            meanwhile[i][2] = inverse[(i, j)];
        }
        if let Some((place, inertia)) = place {
            other[starts[j] + place] = 1.0 / (inertia * scales[j][place]);
        }
        Self { after: sparse(other), meanwhile }
    }
}

/// After how many samples the loop has forgotten, and what is left then: `A^samples`, `‖A^samples‖_∞ < 1`.
#[derive(Debug, Clone)]
pub(crate) struct SumHorizon {
    pub(crate) samples: usize,
    pub(super) power: DMatrix<f64>,
}

/// The joints `i` with their laws and loops on one constant matrix `M`: `M q̈ = τ − d`.
pub(crate) struct Linear {
    a: DMatrix<f64>,
    /// Columns of `a`, sparse.
    pub(super) columns: Vec<Vec<(usize, f64)>>,
    /// Output rows of each joint on the state.
    pub(super) rows: Vec<Vec<[f64; OUTPUTS]>>,
    /// State after a unit torque impulse on each joint at an interval's start and at its end, sparse.
    pub(super) kicks: Vec<[Vec<(usize, f64)>; 2]>,
    /// State after a unit error of each encoder, sparse.
    pub(super) readings: Vec<Vec<(usize, f64)>>,
    /// Outputs of joint `i` at the very sample of encoder `j`'s error, `direct[j][i]`.
    pub(super) direct: Vec<Vec<[f64; OUTPUTS]>>,
    /// State at the sample after a start with a reading 1 rad off, of laws from positions, sparse.
    pub(super) starts: Vec<Vec<(usize, f64)>>,
    pub(super) given: Vec<GivenOther>,
    pub(super) period: f64,
}

/// An interval in which the drive of a joint is given 1 N·m more than was commanded.
pub(super) struct GivenOther {
    /// State after it, sparse.
    pub(super) after: Vec<(usize, f64)>,
    /// Outputs of each joint in it.
    pub(super) meanwhile: Vec<[f64; OUTPUTS]>,
}

impl Linear {
    /// A state of this length for `n` joints, without any input.
    fn empty(length: usize, n: usize, period: f64) -> Self {
        Self {
            a: DMatrix::zeros(length, length),
            columns: Vec::new(),
            rows: vec![vec![[0.0; OUTPUTS]; length]; n],
            kicks: Vec::new(),
            readings: Vec::new(),
            direct: Vec::new(),
            starts: Vec::new(),
            given: Vec::new(),
            period,
        }
    }

    /// Laws in their loops on the inverse of an inertia matrix \[1/(kg·m²)\].
    #[allow(clippy::too_many_lines, reason = "one input after the other")]
    pub(crate) fn new(loops: &[(&JointRecord, &LoopModel)], inverse: &DMatrix<f64>) -> Self {
        let samples: Vec<SampledLoop> =
            loops.iter().map(|(r, m)| SampledLoop::new(r, m, 1.0)).collect();
        let nominal: Vec<f64> = loops.iter().map(|(r, _)| r.inertia_kg_m2).collect();
        let n = loops.len();
        let starts: Vec<usize> = samples
            .iter()
            .scan(0, |at, s| Some(core::mem::replace(at, *at + s.length())))
            .collect();
        let length = samples.iter().map(SampledLoop::length).sum();
        let period = loops.first().map_or(0.0, |(_, model)| model.period_s);
        let scales: Vec<DVector<f64>> =
            samples.iter().zip(&nominal).map(|(s, m)| s.scale() / m.sqrt()).collect();
        let mut own = Self::empty(length, n, period);
        // The law, delay and drive are the joint's own; what acts moves every joint.
        for j in 0..n {
            let step = |x: &[f64], input: &Input| {
                let (mut next, u) = samples[j].step(x, input);
                let twice = next[0] - x[0] - period * x[1];
                let once = next[1] - x[1];
                (next[0], next[1]) = (x[0] + period * x[1], x[1]);
                let acting = samples[j].acting(x, u);
                let mut outputs = vec![[0.0; OUTPUTS]; n];
                (outputs[j][0], outputs[j][1]) = (x[0], x[1]);
                (outputs[j][3], outputs[j][4]) = (nominal[j] * u, nominal[j] * acting);
                let mut all = vec![0.0; length];
                for (k, value) in next.iter().enumerate() {
                    all[starts[j] + k] = value / scales[j][k];
                }
                for i in 0..n {
                    let share = inverse[(i, j)] * nominal[j];
                    outputs[i][2] = share * acting;
                    all[starts[i]] += share * twice / scales[i][0];
                    all[starts[i] + 1] += share * once / scales[i][1];
                }
                (all, outputs)
            };
            for k in 0..samples[j].length() {
                let mut x = vec![0.0; samples[j].length()];
                x[k] = scales[j][k];
                let (next, outputs) = step(&x, &Input::default());
                own.a.set_column(starts[j] + k, &DVector::from_vec(next));
                for i in 0..n {
                    own.rows[i][starts[j] + k] = outputs[i];
                }
            }
            let rest = vec![0.0; samples[j].length()];
            let (next, direct) = step(&rest, &Input { encoder: 1.0, ..Input::default() });
            own.readings.push(sparse(next));
            own.direct.push(direct);
            let kick = |lever: f64| {
                let mut x = vec![0.0; length];
                for i in 0..n {
                    x[starts[i]] = lever * inverse[(i, j)] / scales[i][0];
                    x[starts[i] + 1] = inverse[(i, j)] / scales[i][1];
                }
                sparse(x)
            };
            own.kicks.push([kick(period), kick(0.0)]);
            let place = samples[j].acted().map(|place| (place, nominal[j]));
            own.given.push(GivenOther::of((period, j), inverse, (&starts, &scales), place));
            own.starts.push(match started(loops[j].0, period) {
                Some([e, phi]) => {
                    let (at, scale) = (starts[j] + 2, &scales[j]);
                    vec![(at, e / scale[2]), (at + 2, phi / scale[4])]
                }
                None => Vec::new(),
            });
        }
        own.columns = own.a.column_iter().map(|c| sparse(c.iter().copied())).collect();
        own
    }

    /// `None` when the loop does not forget.
    pub(crate) fn horizon(&self) -> Option<SumHorizon> {
        let (mut power, mut half) = (self.a.clone(), self.a.clone());
        for doublings in 0..=DOUBLINGS {
            let left = norm_inf(&power);
            if !left.is_finite() {
                return None;
            }
            if left < LEFT {
                return Some(SumHorizon { samples: 1 << doublings, power });
            }
            let whole = portable::product(&power, &power);
            // Half way between two powers of two.
            if doublings > 0 {
                let between = portable::product(&power, &half);
                if norm_inf(&between) < LEFT {
                    return Some(SumHorizon { samples: 3 << (doublings - 1), power: between });
                }
            }
            half = core::mem::replace(&mut power, whole);
        }
        None
    }

    /// Number of joints.
    pub(crate) fn joints(&self) -> usize {
        self.given.len()
    }

    /// Shows joint `i`'s outputs after a unit of each input, for so many samples, at least those of the
    /// horizon; gives what the sums leave out, per input:
    /// `Σ_{k≥N} |c A^k b| ≤ Σ_{k<N} ‖c A^k‖₁ ‖A^N b‖_∞/(1 − ‖A^N‖_∞)`; for changes with `c (A − I)` for `c`,
    /// and the one change that leads to sample `N`.
    pub(crate) fn walk(
        &self,
        i: usize,
        (samples, horizon): (usize, &SumHorizon),
        mut visit: impl FnMut(usize, &Lines),
    ) -> Vec<ResponseSums> {
        let mut now: Vec<Outputs> = self.rows[i].iter().map(abreast).collect();
        let mut next = now.clone();
        let mut total = [0.0; OUTPUTS];
        let mut before: Vec<Lines> = self.direct.iter().map(|d| first(&d[i])).collect();
        for (j, lines) in before.iter().enumerate() {
            visit(j, lines);
        }
        for _ in 0..samples {
            for (j, before) in before.iter_mut().enumerate() {
                let mut lines = [0.0; 16];
                let [start, end] = &self.kicks[j];
                for (part, inputs) in [start, end, &self.readings[j]].into_iter().enumerate() {
                    let own = along(&now, inputs);
                    lines[part * OUTPUTS..(part + 1) * OUTPUTS].copy_from_slice(&own[..OUTPUTS]);
                }
                let raw = lines;
                for part in 0..3 {
                    for o in CHANGES {
                        lines[part * OUTPUTS + o] -= before[part * OUTPUTS + o];
                    }
                }
                *before = raw;
                visit(j, &lines);
            }
            for (next, column) in next.iter_mut().zip(&self.columns) {
                *next = along(&now, column);
            }
            for (now, next) in now.iter().zip(&next) {
                for o in 0..OUTPUTS {
                    let part = if CHANGES.contains(&o) { next[o] - now[o] } else { now[o] };
                    total[o] += part.abs();
                }
            }
            core::mem::swap(&mut now, &mut next);
        }
        let rest = 1.0 / (1.0 - norm_inf(&horizon.power));
        let size = |x: &[(usize, f64)]| {
            let later =
                |row: usize| x.iter().map(|(k, v)| horizon.power[(row, *k)] * v).sum::<f64>();
            (0..now.len()).map(|row| later(row).abs()).largest()
        };
        let last = |x: &[(usize, f64)], before: &[f64]| {
            let own = along(&now, x);
            CHANGES.map(|o| (own[o] - before[o]).abs())
        };
        let tail = |size: f64, last: [f64; 2]| {
            let mut tail = total.map(|total| total * size * rest);
            for (o, last) in CHANGES.into_iter().zip(last) {
                tail[o] += last;
            }
            tail
        };
        let tails = self.kicks.iter().zip(&self.readings).zip(&before);
        let tails = tails.map(|(([start, end], reading), before)| {
            let [a, b] = [last(start, &before[..OUTPUTS]), last(end, &before[OUTPUTS..])];
            let torque = core::array::from_fn(|k| self.period * a[k].max(b[k]));
            let encoder = last(reading, &before[2 * OUTPUTS..]);
            [tail(self.period * size(start).max(size(end)), torque), tail(size(reading), encoder)]
        });
        tails.collect()
    }
}

/// State of a law from positions after a start from rest with a reading 1 rad off: `ê`, and the `φ̂/M̄` with which
/// the torque stays that of before.
fn started(record: &JointRecord, period: f64) -> Option<[f64; 2]> {
    let ahead = period * f64::from(record.observer.as_ref()?.delay_samples);
    let share = ahead * (record.kd_per_s + 0.5 * ahead * record.kp_per_s2);
    Some([1.0, record.kp_per_s2 / (1.0 + share)])
}

/// Adds one sample's outputs to the sums.
pub(super) fn count(sums: &mut ResponseSums, lines: &Lines, period: f64) {
    for o in 0..OUTPUTS {
        sums[0][o] += period * mean_of_line(lines[o], lines[OUTPUTS + o]);
        sums[1][o] += lines[2 * OUTPUTS + o].abs();
    }
}

fn first(direct: &[f64; OUTPUTS]) -> Lines {
    let mut lines = [0.0; 16];
    lines[2 * OUTPUTS..3 * OUTPUTS].copy_from_slice(direct);
    lines
}

/// [`OUTPUTS`] side by side.
type Outputs = Lane<WIDE>;

fn abreast(outputs: &[f64; OUTPUTS]) -> Outputs {
    Lane::of(|o| outputs.get(o).copied().unwrap_or(0.0))
}

/// Outputs of a state.
fn along(rows: &[Outputs], x: &[(usize, f64)]) -> Outputs {
    let mut sum = Outputs::ZERO;
    for (k, value) in x {
        for o in 0..WIDE {
            sum[o] += value * rows[*k][o];
        }
    }
    sum
}

fn sparse(x: impl IntoIterator<Item = f64>) -> Vec<(usize, f64)> {
    x.into_iter().enumerate().filter(|(_, value)| *value != 0.0).collect()
}

pub(super) fn norm_inf(a: &DMatrix<f64>) -> f64 {
    a.row_iter().map(|row| row.iter().map(|v| v.abs()).sum()).largest()
}
