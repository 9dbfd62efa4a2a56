//! Messages that get lost.

use phihat_study::{Fault, FaultKind, Loss as Share};

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

#[cfg(test)]
mod tests {
    use super::{FaultKind, MessageLoss, NoiseEffect, Share};

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
