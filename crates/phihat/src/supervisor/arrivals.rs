//! Is this sample new, and how long is it since the last one?

use crate::joint::SampleInterval;
use crate::{Events, Real};

/// The shortest time between two samples that is one is the period over this; less is a clock that jumped.
const SHORTEST_SHARE: u64 = 20;

/// The longest time between two samples that is integrated over, in periods: beyond, the sampled estimator would
/// leave the unit circle, and one step says nothing of what happened in between.
const LONGEST_PERIODS: u64 = 3;

/// Twice the periods up to which an interval is taken in one step, and in two; beyond, in three.
const ONE_STEP_HALVES: u64 = 3;
const TWO_STEPS_HALVES: u64 = 5;

/// Number and time of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stamp {
    /// Counts samples; where there is no such number, the time stamp does.
    pub sequence: u64,
    /// When it was taken \[ns\], by a monotonic clock.
    pub t_ns: u64,
}

/// Conditions for a fresh sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ArrivalRules {
    pub(crate) period_ns: u64,
    pub(crate) age_max_ns: u64,
    pub(crate) window: u64,
}

/// State of the arrival check: the last stamp, and counts of missed samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Arrivals {
    pub(crate) last: Option<Stamp>,
    /// Missed in a row.
    pub(crate) misses: u32,
    /// Of these, the ones that came but could not be believed, in a row.
    pub(crate) bad: u32,
    /// One bit per sample, the latest lowest: 1 = missed.
    pub(crate) history: u64,
    /// One bit per fresh sample, the latest lowest: 1 = at a time that cannot be.
    pub(crate) times: u64,
}

/// A sample's stamp, judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SampleArrival {
    pub(crate) fresh: bool,
    /// Time since the last fresh sample, where it can be integrated over.
    pub(crate) elapsed_ns: Option<u64>,
    pub(crate) events: Events,
}

impl Arrivals {
    /// Judges a stamp. `resync`: nothing depends on the order of samples now, any number is a new start.
    pub(crate) fn judge(
        &self,
        rules: &ArrivalRules,
        now_ns: u64,
        stamp: Stamp,
        resync: bool,
    ) -> SampleArrival {
        let refuse = |events| SampleArrival { fresh: false, elapsed_ns: None, events };
        if now_ns.saturating_sub(stamp.t_ns) > rules.age_max_ns {
            return refuse(Events::AGED);
        }
        let Some(last) = self.last else {
            return SampleArrival { fresh: true, elapsed_ns: None, events: Events::NONE };
        };
        let advance = stamp.sequence.wrapping_sub(last.sequence);
        if advance == 0 {
            return refuse(Events::DUPLICATE);
        }
        if advance > rules.window && !resync {
            return refuse(Events::REORDERED);
        }
        let elapsed = stamp.t_ns.checked_sub(last.t_ns).filter(|elapsed| {
            advance <= rules.window
                && elapsed.saturating_mul(SHORTEST_SHARE) >= rules.period_ns
                && *elapsed <= rules.period_ns.saturating_mul(LONGEST_PERIODS)
        });
        let events = Events::TIME_JUMP.when(elapsed.is_none());
        SampleArrival { fresh: true, elapsed_ns: elapsed, events }
    }

    /// Samples missed of the last 64.
    pub(crate) fn lost(&self) -> u32 {
        self.history.count_ones()
    }

    /// Fresh samples of the last 64 at a time that cannot be.
    pub(crate) fn wrong_times(&self) -> u32 {
        self.times.count_ones()
    }

    pub(crate) fn took(&mut self, stamp: Stamp, wrong: bool) {
        self.times = (self.times << 1) | u64::from(wrong);
        self.last = Some(stamp);
        self.misses = 0;
        self.bad = 0;
        self.history <<= 1;
    }

    pub(crate) fn missed(&mut self, bad: bool) {
        self.misses = self.misses.saturating_add(1);
        self.bad = if bad { self.bad.saturating_add(1) } else { self.bad };
        self.history = (self.history << 1) | 1;
    }
}

/// The interval for the estimator: one step up to 1.5 periods, two up to 2.5, three up to 3. With the
/// coefficients of the nominal period that keeps its sampled poles inside the unit circle.
pub(crate) fn interval<R: Real>(
    elapsed_ns: Option<u64>,
    period_ns: u64,
    nominal: SampleInterval<R>,
) -> SampleInterval<R> {
    let Some(elapsed) = elapsed_ns else { return SampleInterval { parts: 0, ..nominal } };
    if elapsed == period_ns {
        return nominal;
    }
    let (parts, share) = if elapsed * 2 <= period_ns * ONE_STEP_HALVES {
        (1, 1.0)
    } else if elapsed * 2 <= period_ns * TWO_STEPS_HALVES {
        (2, 0.5)
    } else {
        (3, 1.0 / 3.0)
    };
    SampleInterval {
        step: R::from_f64(elapsed as f64 * 1e-9 * share),
        parts,
        share: R::from_f64(share),
    }
}
