//! Messages that get lost.

use phihat_study::{Fault, FaultKind, Loss as Share, LostRows, Study};

use super::noise::{Noise, NoiseEffect};

/// Loss of messages in a stream.
///
/// # Law
///
/// Gilbert's two states: from good to bad with probability `p/(b(1 − p))`, back with `1/b`, for a share `p`
/// of losses in runs of mean length `b`. Without `b`, losses are independent: `b = 1/(1 − p)`.
#[derive(Debug)]
pub(super) struct MessageLoss {
    /// Probability of loss after a message got through, and after one was lost.
    after_good: f64,
    after_bad: f64,
    noise: Noise,
    faults: Vec<(Fault, Noise)>,
    bad: bool,
}

impl MessageLoss {
    /// `None` where nothing is ever lost.
    pub(super) fn new(
        share: Share,
        faults: &[Fault],
        (kind, own, of_faults): (FaultKind, NoiseEffect, NoiseEffect),
        seed: u64,
    ) -> Option<Self> {
        let concerned = faults.iter().filter(|fault| fault.kind == kind).enumerate();
        let faults: Vec<_> =
            concerned.map(|(i, fault)| (fault.clone(), Noise::new(seed, of_faults, i))).collect();
        if share.share <= 0.0 && faults.is_empty() {
            return None;
        }
        let p = share.share;
        let burst = share.burst.unwrap_or(1.0 / (1.0 - p)).max(1.0);
        Some(Self {
            after_good: (p / (burst * (1.0 - p))).min(1.0),
            after_bad: 1.0 - 1.0 / burst,
            noise: Noise::new(seed, own, 0),
            faults,
            bad: false,
        })
    }

    /// Goes on where another one was.
    pub(super) fn after(self, before: Option<&Self>) -> Self {
        Self { bad: before.is_some_and(|before| before.bad), ..self }
    }

    /// Returns true if message `k`, at time `t` \[s\], is lost.
    pub(super) fn lost(&mut self, k: u64, t: f64) -> bool {
        let probability = if self.bad { self.after_bad } else { self.after_good };
        self.bad = self.noise.uniform(k) < probability;
        let faulty =
            |(fault, noise): &(Fault, Noise)| fault.active(t) && noise.uniform(k) < fault.size;
        self.bad || self.faults.iter().any(faulty)
    }
}

/// Rows of commands that are lost: at most so many in a row, starts of rows at least so far apart.
#[derive(Debug)]
pub(super) struct LossRows {
    most: f64,
    /// Samples from the start of a row to the next, at least.
    apart: f64,
    noise: Noise,
    /// First sample of the row that is to come, or going on, and the first after it.
    row: (u64, u64),
    number: u64,
}

impl LossRows {
    pub(super) fn new(rows: LostRows, study: &Study) -> Self {
        let samples = rows.apart * 1e9 / study.control.period_ns as f64;
        let noise = Noise::new(study.seed, NoiseEffect::CommandRows, 0);
        let mut own = Self {
            most: f64::from(rows.most),
            apart: samples.ceil(),
            noise,
            row: (0, 0),
            number: 0,
        };
        own.draw();
        own
    }

    /// The next row: half of them as soon as they may come, half of them of the largest length.
    fn draw(&mut self) {
        let uniform = |k: u64| self.noise.uniform(4 * self.number + k);
        let later = if uniform(0) < 0.5 { 0.0 } else { uniform(1) };
        let length = if uniform(2) < 0.5 { 1.0 } else { uniform(3) };
        let start = self.row.0.saturating_add(whole(self.apart * (1.0 + later)));
        self.row = (start, start.saturating_add(whole(self.most * length).max(1)));
        self.number += 1;
    }

    /// Returns true if command `k` is lost; asked of every command once, in their order.
    pub(super) fn lost(&mut self, k: u64) -> bool {
        if k >= self.row.1 {
            self.draw();
        }
        k >= self.row.0 && k < self.row.1
    }
}

/// A number of samples, rounded up.
fn whole(samples: f64) -> u64 {
    std::time::Duration::try_from_secs_f64(samples.ceil()).map_or(u64::MAX, |own| own.as_secs())
}

#[cfg(test)]
mod tests {
    use super::{FaultKind, LossRows, LostRows, MessageLoss, NoiseEffect, Share};
    use phihat_study::Study;

    /// Wrong if a row were longer than stated, or two of them closer, or if the limits were never reached.
    #[test]
    fn rows_are_no_longer_and_no_closer_than_stated() {
        let text = "duration_s = 1.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.5\n[design]\n\
                    [reference]\nkind = \"hold\"\npose = \"ready\"\n";
        let study = Study::from_text(text, "rows.toml", "".as_ref()).unwrap();
        let mut rows = LossRows::new(LostRows { most: 3, apart: 0.02 }, &study);
        let lost: Vec<bool> = (0..100_000).map(|k| rows.lost(k)).collect();
        let starts: Vec<usize> =
            (0..lost.len()).filter(|k| lost[*k] && (*k == 0 || !lost[*k - 1])).collect();
        let gaps = starts.windows(2).map(|pair| pair[1] - pair[0]);
        assert_eq!((starts[0] >= 20, gaps.clone().min()), (true, Some(20)));
        assert!(gaps.max().unwrap() > 35);
        let lengths = starts.iter().map(|k| lost[*k..].iter().take_while(|lost| **lost).count());
        assert_eq!((lengths.clone().min(), lengths.max()), (Some(1), Some(3)));
    }

    /// Wrong if the share of losses or the length of their runs were not what was asked for.
    #[test]
    fn share_and_runs_are_as_asked_for() {
        for (share, burst) in [(0.1, None), (0.3, Some(5.0)), (0.02, Some(3.0)), (0.5, None)] {
            let kinds =
                (FaultKind::CommandLoss, NoiseEffect::CommandLoss, NoiseEffect::FaultCommandLoss);
            let mut loss = MessageLoss::new(Share { share, burst }, &[], kinds, 7).unwrap();
            let n = 400_000;
            let lost: Vec<bool> = (0..n).map(|k| loss.lost(k, 0.0)).collect();
            let count = lost.iter().filter(|l| **l).count() as f64;
            let runs = lost.windows(2).filter(|w| !w[0] && w[1]).count() as f64;
            let expected = burst.unwrap_or(1.0 / (1.0 - share));
            assert!((count / n as f64 / share - 1.0).abs() < 0.05, "{share}: {count}");
            assert!(
                (count / runs / expected - 1.0).abs() < 0.05,
                "{share}: runs of {}",
                count / runs
            );
        }
    }
}
