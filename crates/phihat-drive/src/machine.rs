//! Real-time capability of this machine: its settings, and how late it wakes a thread.

use std::thread;

use serde::Serialize;

use crate::finding::{Finding, SystemError};
use crate::system::{HostClock, enter, look};
use crate::timing::{Percentiles, Timing};

/// Options of a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachineOptions {
    /// Rate of the loop \[Hz\].
    pub rate_hz: f64,
    /// Duration of the measurement \[s\].
    pub seconds: f64,
    /// The processor to measure on; `None`: as the system likes.
    pub processor: Option<usize>,
}

impl Default for MachineOptions {
    fn default() -> Self {
        Self { rate_hz: 1000.0, seconds: 5.0, processor: None }
    }
}

/// Settings and wake-up delays of this machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    /// Findings about its settings and wake-ups.
    pub findings: Vec<Finding>,
    /// Rate at which it was measured \[Hz\].
    pub rate_hz: f64,
    /// Number of wake-ups.
    pub samples: u64,
    /// Delay of the wake-ups \[µs\], with the settings that were granted; `None`: nothing was measured.
    pub late: Option<Percentiles>,
    /// Delay \[µs\] above which a wake-up counts as late.
    pub allowed_us: f64,
}

/// Share of a period by which a control thread may wake late: the rest is for the law, the network and the robot.
const SHARE: f64 = 0.2;

impl Machine {
    /// Reads the settings alone.
    ///
    /// # Errors
    ///
    /// [`SystemError`]: this is not Linux.
    pub fn look() -> Result<Vec<Finding>, SystemError> {
        look()
    }

    /// Reads the settings, and measures how late an absolute sleep wakes a thread with all settings that the
    /// system grants.
    ///
    /// # Errors
    ///
    /// [`SystemError`]: this is not Linux.
    pub fn measure(options: &MachineOptions) -> Result<Self, SystemError> {
        let mut findings = look()?;
        let period_us = 1e6 / options.rate_hz;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the caller bounds rate and duration"
        )]
        let (period_ns, samples) =
            ((1e3 * period_us).round() as u64, (options.seconds * options.rate_hz).ceil() as u64);
        let mut clock = HostClock::new(period_ns)?;
        let measure = || {
            let given = enter(options.processor);
            let mut timing = Timing::default();
            clock.start();
            for _ in 0..samples {
                clock.wait();
                timing.add(Some(clock.late_ns()), None);
            }
            (given, timing.late())
        };
        let measured = thread::scope(|scope| scope.spawn(measure).join());
        let (given, late) = measured.unwrap_or_default();
        findings.extend(given.into_iter().filter(|finding| finding.what == "processor"));
        let allowed_us = SHARE * period_us;
        if let Some(late) = late {
            findings.push(jitter(late, allowed_us));
        }
        Ok(Self { findings, rate_hz: options.rate_hz, samples, late, allowed_us })
    }

    /// Returns true if every finding is good.
    pub fn is_good(&self) -> bool {
        self.findings.iter().all(|finding| finding.good)
    }
}

fn jitter(late: Percentiles, allowed_us: f64) -> Finding {
    let Percentiles { p50_us, p99_us, max_us, .. } = late;
    let found = format!("median {p50_us:.0} µs, 99 % {p99_us:.0} µs, largest {max_us:.0} µs late");
    if max_us <= allowed_us {
        return Finding::good("wake-up", found);
    }
    let change = format!(
        "at most {allowed_us:.0} µs is sound at this rate: what is above, then a processor of its own (`isolcpus`, \
            --processor), and no other work on this machine"
    );
    Finding::bad("wake-up", found, change)
}
