//! Largest answers to rows of lost commands, joints that answer side by side.

use phihat_certificate::extremes::larger;

use super::imperfect::LossSpan;
use super::joint_sums::{AnswerMatrices, RowSums, STEP};
use crate::coupled::abreast::{NONE, SampleResponses, WideKinds};
use crate::coupled::linear::LEFT;
use crate::lanes::Wide;

/// Sums over the answers to a deviation of the torque that acts from the command, up to the last sample.
pub(super) struct LossSums {
    rows: LossSpan,
    delay: usize,
    horizon: usize,
    /// Samples so far, and how many count.
    age: usize,
    samples: usize,
    /// Sizes at the last samples, as many as a row has, the last first.
    recent: Vec<Vec<WideKinds>>,
    largest: Vec<WideKinds>,
    /// Largest answer to a row in each of the spans from the start of a row to that of the next.
    spans: Vec<Vec<WideKinds>>,
    /// The same of the change of the command, over spans that begin a delay sooner.
    sooner: Vec<Vec<Wide>>,
    /// Size of the command so many samples after a deviation, and the largest so far.
    level: Vec<[Wide; 2]>,
    levels: Vec<Vec<Wide>>,
    /// Changes of the command by an error of one reading at the last samples, the last first; sums over `l` of them.
    misread: Vec<Vec<Wide>>,
    changes: Vec<Vec<Wide>>,
}

impl LossSums {
    pub(super) fn new(n: usize, rows: LossSpan, (delay, horizon): (usize, usize)) -> Self {
        let none = || vec![Wide::ZERO; n];
        Self {
            rows,
            delay,
            horizon,
            age: 0,
            samples: 2 * horizon,
            recent: vec![vec![NONE; n]; rows.most],
            largest: vec![NONE; n],
            spans: Vec::new(),
            sooner: Vec::new(),
            level: vec![[Wide::ZERO; 2]; n],
            levels: Vec::new(),
            misread: vec![none(); rows.most],
            changes: (2..=rows.most).map(|_| none()).collect(),
        }
    }

    /// One more sample.
    pub(super) fn take(&mut self, shown: &SampleResponses) {
        self.read(|j| shown.reading[j][STEP]);
        if self.age < self.samples {
            if self.age < self.rows.most {
                for (level, given) in self.level.iter_mut().zip(&shown.given) {
                    level[0].add_scaled(1.0, &given[STEP]);
                    level[1] = level[1].larger(&level[0].size());
                }
                if self.age > 0 {
                    self.levels.push(self.level.iter().map(|level| level[1]).collect());
                }
            }
            self.answer(|j| shown.given[j].map(|own| own.size()));
        }
    }

    /// Changes of the command by an error of a reading at one more sample.
    fn read(&mut self, change: impl Fn(usize) -> Wide) {
        self.misread.rotate_right(1);
        if let Some(first) = self.misread.first_mut() {
            first.iter_mut().enumerate().for_each(|(j, own)| *own = change(j));
        }
        for (own, l) in self.changes.iter_mut().zip(2..) {
            for (j, own) in own.iter_mut().enumerate() {
                let mut sum = Wide::ZERO;
                for list in self.misread.iter().take(l).rev() {
                    sum.add_scaled(1.0, &list[j]);
                }
                own.add_scaled(1.0, &sum.size());
            }
        }
    }

    /// Sizes of the answers at one more sample: of a row `Σ |c|` over its commands.
    fn answer(&mut self, sizes: impl Fn(usize) -> WideKinds) {
        for (j, largest) in self.largest.iter_mut().enumerate() {
            for (largest, size) in largest.iter_mut().zip(&sizes(j)) {
                *largest = largest.larger(size);
            }
        }
        self.recent.rotate_right(1);
        if let Some(first) = self.recent.first_mut() {
            first.iter_mut().enumerate().for_each(|(j, own)| *own = sizes(j));
        }
        let n = self.largest.len();
        let (span, sooner) =
            (self.age / self.rows.apart, (self.age + self.delay) / self.rows.apart);
        if self.spans.len() <= span {
            self.spans.push(vec![NONE; n]);
        }
        while self.sooner.len() <= sooner {
            self.sooner.push(vec![Wide::ZERO; n]);
        }
        for j in 0..n {
            let mut row = NONE;
            for sizes in &self.recent {
                for (sum, size) in row.iter_mut().zip(&sizes[j]) {
                    sum.add_scaled(1.0, size);
                }
            }
            for (most, row) in self.spans[span][j].iter_mut().zip(&row) {
                *most = most.larger(row);
            }
            self.sooner[sooner][j] = self.sooner[sooner][j].larger(&row[STEP]);
        }
        self.age += 1;
    }

    /// Answers of a row's later commands after the last sample that counts, and changes by misreadings then.
    pub(super) fn end(&mut self) {
        for _ in 0..self.rows.most {
            self.answer(|_| NONE);
            self.read(|_| Wide::ZERO);
        }
    }

    /// The sums of one of the joints that answer; changes of the command by misreadings after the last sample are at
    /// most `later`.
    ///
    /// Each row counts at its worst age or later. Beyond twice the horizon of `N` samples the rows of each block of `N`
    /// answer with at most [`LEFT`] of the largest answer, and less from block to block.
    pub(super) fn joint(&self, c: usize, later: &[f64]) -> (AnswerMatrices, RowSums) {
        let n = self.largest.len();
        let left = |o: usize, j: usize| {
            let rows = self.horizon as f64 / self.rows.apart as f64 + 1.0;
            2.0 * LEFT * self.largest[j][o][c] * self.rows.most as f64 * rows
        };
        // From the oldest span on.
        let total = |sizes: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut most) = (0.0, 0.0);
            for size in sizes {
                most = larger(most, size);
                sum += most;
            }
            sum
        };
        let lost = |o: usize, j: usize| {
            total(&mut self.spans.iter().rev().map(|span| span[j][o][c])) + left(o, j)
        };
        let earlier = |j: usize| {
            total(&mut self.sooner.iter().skip(1).rev().map(|span| span[j][c])) + left(STEP, j)
        };
        let list = |own: &Vec<Wide>| -> Vec<f64> { own.iter().map(|own| own[c]).collect() };
        let changes = self.changes.iter().zip(2_u32..).map(|(own, l)| {
            list(own).iter().zip(later).map(|(sum, later)| sum + f64::from(l) * later).collect()
        });
        let rows = RowSums {
            earlier: (0..n).map(earlier).collect(),
            levels: self.levels.iter().map(list).collect(),
            spans: changes.collect(),
        };
        (core::array::from_fn(|o| (0..n).map(|j| lost(o, j)).collect()), rows)
    }
}

#[cfg(test)]
mod tests {
    use super::LossSums;
    use crate::class::imperfect::LossSpan;
    use crate::class::sums::STEP;
    use crate::coupled::abreast::{NONE, SampleResponses};
    use crate::lanes::Lane;
    use phihat_certificate::extremes::Extremes as _;

    /// A response that swings.
    const RESPONSE: [f64; 8] = [0.2, 1.0, -0.8, 0.3, 0.5, -0.1, 0.0, 0.05];

    /// Sums of one joint, of all rows, of earlier ones, and the change over two samples.
    fn sums(rows: LossSpan, delay: usize) -> [f64; 3] {
        let mut all = LossSums::new(1, rows, (delay, RESPONSE.len() / 2));
        for x in RESPONSE {
            let mut own = NONE;
            own[STEP] = Lane::of(|c| if c == 1 { x } else { 7.0 });
            let given = vec![own];
            all.take(&SampleResponses {
                kick: vec![NONE],
                reading: given.clone(),
                start: vec![NONE],
                given,
            });
        }
        all.end();
        let (lost, rows) = all.joint(1, &[0.0]);
        // What comes after the last sample is added as a share of the largest answer.
        let left = 2.0 * super::LEFT * all.rows.most as f64 * (4.0 / all.rows.apart as f64 + 1.0);
        [lost[STEP][0] - left, rows.earlier[0] - left, rows.spans[0][0]]
    }

    #[test]
    fn rows_at_their_worst_are_those_of_a_search_over_all_of_them() {
        // Every triple of rows of two commands at least three samples apart.
        let at = |k: usize| RESPONSE.get(k).copied().unwrap_or(0.0);
        let row =
            |start: usize| at(start).abs() + start.checked_sub(1).map_or(0.0, |k| at(k).abs());
        let mut most = 0.0_f64;
        for a in 0..10 {
            for b in a + 3..13 {
                for c in b + 3..16 {
                    most = most.max(row(a) + row(b) + row(c));
                }
            }
        }
        let rows = LossSpan { most: 2, apart: 3 };
        let [bound, earlier, change] = sums(rows, 0);
        assert!(bound >= most - 1e-12 && bound < 1.6 * most, "{bound} {most}");
        // The row at its worst is the one that is left out; a delay lets the earlier ones be younger.
        let worst = (0..16).map(row).largest();
        assert!((bound - earlier - worst).abs() < 1e-12, "{bound} {earlier} {worst}");
        assert!(sums(rows, 1)[1] > earlier);
        let pairs = (0..9).map(|k| (at(k) + k.checked_sub(1).map_or(0.0, at)).abs()).sum::<f64>();
        assert!((change - pairs).abs() < 1e-12, "{change} {pairs}");
    }
}
