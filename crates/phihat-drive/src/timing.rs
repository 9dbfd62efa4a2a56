//! Wake-up delay and computation time of the loop, in memory of fixed size.

use serde::Serialize;

/// Width of a bin \[ns\] and number of bins: larger values count in the last bin, and the largest is stored.
const BIN_NS: u64 = 1_000;
const BINS: usize = 20_000;

/// Times of one kind.
#[derive(Debug, Clone)]
struct CycleTimes {
    bins: Vec<u64>,
    count: u64,
    most_ns: u64,
}

impl CycleTimes {
    fn new() -> Self {
        Self { bins: vec![0; BINS], count: 0, most_ns: 0 }
    }

    fn add(&mut self, ns: u64) {
        let bin = usize::try_from(ns / BIN_NS).unwrap_or(usize::MAX).min(BINS - 1);
        self.bins[bin] += 1;
        self.count += 1;
        self.most_ns = self.most_ns.max(ns);
    }

    /// The upper edge of the bin in which this share of all lies \[µs\], never above the greatest.
    fn percentile(&self, share: f64) -> f64 {
        let wanted = share * self.count as f64;
        let mut seen = 0;
        for (bin, count) in self.bins.iter().enumerate() {
            seen += count;
            if seen as f64 >= wanted {
                let edge = ((bin as u64 + 1) * BIN_NS).min(self.most_ns);
                let beyond = bin + 1 == BINS;
                return 1e-3 * (if beyond { self.most_ns } else { edge }) as f64;
            }
        }
        1e-3 * self.most_ns as f64
    }

    fn percentiles(&self) -> Option<Percentiles> {
        (self.count > 0).then(|| Percentiles {
            count: self.count,
            p50_us: self.percentile(0.5),
            p99_us: self.percentile(0.99),
            max_us: 1e-3 * self.most_ns as f64,
        })
    }
}

/// Percentiles of one kind of times \[µs\], up to the next whole microsecond.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Percentiles {
    /// Number of values.
    pub count: u64,
    /// Half of all are at most this.
    pub p50_us: f64,
    /// 99 % of all are at most this.
    pub p99_us: f64,
    /// The greatest.
    pub max_us: f64,
}

/// Times of a loop: wake-up delay, and computation time of the controller.
#[derive(Debug, Clone)]
pub struct Timing {
    late: CycleTimes,
    took: CycleTimes,
}

impl Default for Timing {
    fn default() -> Self {
        Self { late: CycleTimes::new(), took: CycleTimes::new() }
    }
}

impl Timing {
    /// Counts one cycle \[ns\]; `None`: not measured.
    pub fn add(&mut self, late_ns: Option<u64>, took_ns: Option<u64>) {
        if let Some(ns) = late_ns {
            self.late.add(ns);
        }
        if let Some(ns) = took_ns {
            self.took.add(ns);
        }
    }

    /// Wake-up delay of the loop \[µs\]; `None`: time was counted.
    pub fn late(&self) -> Option<Percentiles> {
        self.late.percentiles()
    }

    /// Computation time of the controller \[µs\], from a sample to its torque.
    pub fn took(&self) -> Option<Percentiles> {
        self.took.percentiles()
    }
}

#[cfg(test)]
mod tests {
    use super::Timing;

    /// Against the sorted list itself.
    #[test]
    fn percentiles_are_those_of_the_sorted_list() {
        let mut timing = Timing::default();
        let mut all: Vec<u64> = (0..5000_u64).map(|k| (k * k * 7919) % 3_000_000).collect();
        all.push(90_000_000);
        for ns in &all {
            timing.add(Some(*ns), None);
        }
        all.sort_unstable();
        let found = timing.late().unwrap();
        for (share, value) in [(0.5, found.p50_us), (0.99, found.p99_us)] {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
            let exact = all[(share * all.len() as f64).ceil() as usize - 1] as f64 * 1e-3;
            assert!(value >= exact && value <= exact + 1.0, "{share}: {value} and {exact} µs");
        }
        assert!((found.max_us - 90_000.0).abs() < 1e-9);
        assert_eq!(timing.took(), None);
    }
}
