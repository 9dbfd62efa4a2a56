//! Impulse responses of a coupled loop for all joints at once: one walk for every joint that answers and every input.

use phihat_certificate::extremes::Extremes as _;

use super::linear::{CHANGES, Linear, OUTPUTS, SumHorizon, norm_inf};
use crate::lanes::{Lane, WIDE, add_size};

/// Number of outputs.
pub(crate) const KINDS: usize = 5;

/// Place of each output among those of [`Linear`].
const PLACES: [usize; KINDS] = [0, 1, CHANGES[0], CHANGES[1], 2];

/// Place of the output that is a change from sample to sample.
const CHANGE: usize = 2;

/// Outputs of up to [`WIDE`] joints side by side: `e` \[rad\], `ė` \[rad/s\], change of the commanded torque
/// \[N·m\], commanded torque that acts \[N·m\], `ë` without the push itself \[rad/s²\].
pub(crate) type WideKinds = [Lane<WIDE>; KINDS];

/// Outputs of no joint.
pub(crate) const NONE: WideKinds = [Lane::ZERO; KINDS];

/// Responses at one sample: an entry for each joint on which an input acts.
pub(crate) struct SampleResponses {
    /// After an impulse of 1 N·m·s at the end of an interval.
    pub(crate) kick: Vec<WideKinds>,
    /// After an error of 1 rad of one reading.
    pub(crate) reading: Vec<WideKinds>,
    /// After a start of the law with a reading 1 rad off.
    pub(crate) start: Vec<WideKinds>,
    /// After an interval in which the drive is given 1 N·m more than was commanded; where it was requested.
    pub(crate) given: Vec<WideKinds>,
}

/// Remainder of the sums over responses to an impulse of torque and to an error of a reading.
pub(crate) type AbreastTails = [WideKinds; 2];

impl Linear {
    /// Shows the outputs of joints `first` to `first + WIDE − 1` after a unit of each input: at the input's own sample,
    /// at which neither kick nor start has acted, and at so many samples after it, at least those of the horizon. Gives
    /// what the sums leave out, per input, as [`Linear::walk`] does.
    pub(crate) fn walk_abreast(
        &self,
        first: usize,
        (samples, horizon): (usize, &SumHorizon),
        given: bool,
        mut visit: impl FnMut(&SampleResponses),
    ) -> Vec<AbreastTails> {
        let n = self.joints();
        let row = |k: usize| -> WideKinds { self.place(first, |joint, o| joint[k][PLACES[o]]) };
        let mut now: Vec<WideKinds> = (0..self.columns.len()).map(row).collect();
        let mut next = now.clone();
        let mut total = NONE;
        let mut shown = SampleResponses {
            kick: vec![NONE; n],
            reading: self.direct.iter().map(|direct| abreast(direct, first)).collect(),
            start: vec![NONE; n],
            given: self.given.iter().map(|given| abreast(&given.meanwhile, first)).collect(),
        };
        visit(&shown);
        let changes = |list: &[WideKinds]| list.iter().map(|own| own[CHANGE]).collect();
        let mut before: [Vec<Lane<WIDE>>; 4] = [
            changes(&shown.kick),
            changes(&shown.reading),
            changes(&shown.start),
            changes(&shown.given),
        ];
        for _ in 0..samples {
            for j in 0..n {
                let inputs =
                    [&self.kicks[j][1], &self.readings[j], &self.starts[j], &self.given[j].after];
                let lists =
                    [&mut shown.kick, &mut shown.reading, &mut shown.start, &mut shown.given];
                for (k, (input, list)) in inputs.into_iter().zip(lists).enumerate() {
                    if k < 3 || given {
                        let mut own = along(&now, input);
                        let raw = core::mem::replace(&mut before[k][j], own[CHANGE]);
                        own[CHANGE] = own[CHANGE].minus(&raw);
                        list[j] = own;
                    }
                }
            }
            visit(&shown);
            for (next, column) in next.iter_mut().zip(&self.columns) {
                *next = along(&now, column);
            }
            for (now, next) in now.iter().zip(&next) {
                for (o, total) in total.iter_mut().enumerate() {
                    let part = if o == CHANGE { next[o].minus(&now[o]) } else { now[o] };
                    add_size(total, &part);
                }
            }
            core::mem::swap(&mut now, &mut next);
        }
        self.left_out(horizon, &total, [&next, &now])
    }

    /// Remainder of sums, by the sums of sizes of the rows so far, and the rows at the last sample and after it.
    fn left_out(
        &self,
        horizon: &SumHorizon,
        total: &WideKinds,
        [before, now]: [&[WideKinds]; 2],
    ) -> Vec<AbreastTails> {
        let rest = 1.0 / (1.0 - norm_inf(&horizon.power));
        let size = |x: &[(usize, f64)]| {
            let later =
                |row: usize| x.iter().map(|(k, v)| horizon.power[(row, *k)] * v).sum::<f64>();
            (0..now.len()).map(|row| later(row).abs()).largest()
        };
        // The one change that leads to the sample after the last.
        let last =
            |x: &[(usize, f64)]| along(now, x)[CHANGE].minus(&along(before, x)[CHANGE]).size();
        let tail = |size: f64, last: Lane<WIDE>| -> WideKinds {
            let mut tail = total.map(|total| Lane::of(|c| total[c] * size * rest));
            tail[CHANGE].add_scaled(1.0, &last);
            tail
        };
        let each = self.kicks.iter().zip(&self.readings).map(|([start, end], reading)| {
            let (a, b) = (last(start), last(end));
            let torque = Lane::of(|c| self.period * a[c].max(b[c]));
            [
                tail(self.period * size(start).max(size(end)), torque),
                tail(size(reading), last(reading)),
            ]
        });
        each.collect()
    }

    /// Outputs of joints side by side, of their rows on the state.
    fn place(&self, first: usize, of: impl Fn(&[[f64; OUTPUTS]], usize) -> f64) -> WideKinds {
        let rows = self.rows.get(first..).unwrap_or_default();
        core::array::from_fn(|o| Lane::of(|c| rows.get(c).map_or(0.0, |row| of(row, o))))
    }
}

/// Outputs of joints side by side.
fn abreast(outputs: &[[f64; OUTPUTS]], first: usize) -> WideKinds {
    let all = outputs.get(first..).unwrap_or_default();
    core::array::from_fn(|o| Lane::of(|c| all.get(c).map_or(0.0, |own| own[PLACES[o]])))
}

/// Outputs of a state.
#[inline]
fn along(rows: &[WideKinds], x: &[(usize, f64)]) -> WideKinds {
    let mut sum = NONE;
    for (k, value) in x {
        for (sum, row) in sum.iter_mut().zip(&rows[*k]) {
            sum.add_scaled(*value, row);
        }
    }
    sum
}
