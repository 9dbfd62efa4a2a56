//! Largest answers to a start off by an angle, beyond what later readings can add.

use phihat_certificate::extremes::larger;

use super::joint_sums::{AnswerMatrices, KINDS};
use crate::coupled::abreast::{NONE, SampleResponses, WideKinds};
use crate::coupled::linear::LEFT;
use crate::lanes::{Lane, WIDE};

/// Sizes of the answers since the start, over the last samples, joint by joint on which an input acts.
pub(super) struct StartSizes {
    /// Sums of sizes after an error of one reading, up to the last sample.
    readings: Vec<WideKinds>,
    /// Sizes after a start of the law with a reading off by an angle, at the last sample.
    laws: Vec<WideKinds>,
    /// The last intervals, the oldest first.
    near: [Vec<StartAnswers>; 3],
    intervals: usize,
    /// Largest sum of an answer to a start and of those to readings up to it; and the largest answer by itself.
    most: Vec<[WideKinds; 2]>,
}

/// Sizes at one interval.
#[derive(Clone)]
struct StartAnswers {
    /// After a start of the arm off by an angle, over the interval.
    arm: WideKinds,
    law: WideKinds,
    readings: WideKinds,
}

impl StartSizes {
    pub(super) fn new(n: usize) -> Self {
        let none = StartAnswers { arm: NONE, law: NONE, readings: NONE };
        Self {
            readings: vec![NONE; n],
            laws: vec![NONE; n],
            near: core::array::from_fn(|_| vec![none.clone(); n]),
            intervals: 0,
            most: vec![[NONE; 2]; n],
        }
    }

    /// One more interval, by the sizes of the answers to a start of the arm; before the readings at its end.
    pub(super) fn interval(&mut self, arm: impl Fn(usize, usize) -> Lane<WIDE>) {
        self.near.rotate_left(1);
        for (j, own) in self.near[2].iter_mut().enumerate() {
            let arm = core::array::from_fn(|o| arm(j, o));
            *own = StartAnswers { arm, law: self.laws[j], readings: self.readings[j] };
        }
        self.intervals += 1;
        if self.intervals > 1 {
            // The one before the last: times between samples see two neighbours, so each answer is the largest of
            // three.
            let [before, middle, last] = &self.near;
            let all = before.iter().zip(middle).zip(last);
            for (((before, middle), last), most) in all.zip(&mut self.most) {
                grow(most, &middle.readings, [before, middle, last]);
            }
        }
    }

    /// One more sample of readings and of a start of the law.
    pub(super) fn read(&mut self, shown: &SampleResponses) {
        for (j, (sum, reading)) in self.readings.iter_mut().zip(&shown.reading).enumerate() {
            for (o, (sum, reading)) in sum.iter_mut().zip(reading).enumerate() {
                sum.add_scaled(1.0, &reading.size());
                self.laws[j][o] = shown.start[j][o].size();
            }
        }
    }

    /// `max_k (|s_k| − Σ_{m>k+1} |n_m|)` of a joint that answers: of readings that have not come yet nothing is to be
    /// seen at sample `k + 1`. What comes after the last sample is counted as [`LEFT`] of the largest answer.
    pub(super) fn beyond_readings(&self, c: usize) -> AnswerMatrices {
        let [_, before, last] = &self.near;
        let beyond = |o: usize, j: usize| {
            let mut most = self.most[j];
            grow(&mut most, &last[j].readings, [&before[j], &last[j], &last[j]]);
            let [sum, largest] = most.map(|own| own[o][c]);
            larger(larger(0.0, sum - self.readings[j][o][c]), LEFT * largest)
        };
        core::array::from_fn(|o| (0..self.most.len()).map(|j| beyond(o, j)).collect())
    }
}

/// Counts the answers at one interval and its neighbours.
fn grow(most: &mut [WideKinds; 2], readings: &WideKinds, near: [&StartAnswers; 3]) {
    let [sums, largest] = most;
    for o in 0..KINDS {
        let [a, b, c] = near;
        let arm = a.arm[o].larger(&b.arm[o]).larger(&c.arm[o]);
        let law = a.law[o].larger(&b.law[o]).larger(&c.law[o]);
        let own = Lane::of(|k| arm[k] + law[k]);
        sums[o] = sums[o].larger(&Lane::of(|k| own[k] + readings[o][k]));
        largest[o] = largest[o].larger(&own);
    }
}
