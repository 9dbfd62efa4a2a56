//! From the ring to the record: rows in their order, timing and faults.

use std::thread;
use std::time::Duration;

use phihat_session::{SessionError, Take};
use phihat_sim::{Acted, BLOCK, ErrorShares, Row, Rows};

use crate::hooks::Tap;
use crate::tape::{Cycle, Reader};
use crate::timing::Timing;

/// Sleep of the reader where there is nothing to read.
const REST: Duration = Duration::from_millis(1);

/// Duration of one part of the record \[ns\]: a part that was handed over outlives the process.
const PART_NS: u64 = 250_000_000;

/// Samples between two calls of the progress callback: where it polls for signals, an arm at 1 kHz is stopped
/// within 64 ms instead of a part of the record.
const SEEN: u64 = 64;

/// Conversion of the samples of a drive to its record.
///
/// A robot knows its torque after the fact, and its acceleration not at all. For one that is not simulated
///
/// ```text
/// q, q̇ as measured,   τ_k = τ told by sample k + 1,   q̈_k = (q̇_{k+1} − q̇_k)/T,   φ_k = τ_k − M̄ q̈_k
/// ```
///
/// so the record is one sample behind; at the last sample the command replaces the torque, and the
/// acceleration before it is repeated.
pub struct Evidence {
    rows: Rows,
    /// Nominal inertia per joint \[kg·m²\].
    inertia: Vec<f64>,
    period: f64,
    /// Samples that are handed over at a time.
    part: usize,
    /// A sample whose torque and acceleration are not known yet.
    held: Option<(Cycle, Vec<Row>)>,
    /// Timing of the loop.
    pub timing: Timing,
    /// Faults that the supervisor reported, without repetitions in a row, with their time \[s\].
    pub faults: Vec<(f64, &'static str)>,
    /// Shares of the certified bound that the measured errors take up; `None`: there is no such bound.
    pub shares: Option<ErrorShares>,
    /// Hook that gets each sample.
    pub tap: Option<Box<dyn Tap>>,
}

impl core::fmt::Debug for Evidence {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Evidence").field("rows", &self.rows).finish_non_exhaustive()
    }
}

impl Evidence {
    /// Of joints with these names and nominal inertias \[kg·m²\], at this period \[ns\].
    pub fn new(names: &[String], inertia: Vec<f64>, period_ns: u64) -> Self {
        Self {
            rows: Rows::new(names, period_ns, BLOCK as u64),
            inertia,
            period: period_ns as f64 * 1e-9,
            part: usize::try_from(PART_NS / period_ns.max(1)).unwrap_or(BLOCK).clamp(1, BLOCK),
            held: None,
            timing: Timing::default(),
            faults: Vec::new(),
            shares: None,
            tap: None,
        }
    }

    /// Reads until the writer is gone; hands the record over in parts of a quarter of a second. `seen` gets
    /// the number of samples read.
    ///
    /// # Errors
    ///
    /// The error of `take`; the reader is dropped then, and the loop ends.
    pub fn read(
        &mut self,
        mut reader: Reader,
        take: &mut Take<'_>,
        mut seen: impl FnMut(u64),
    ) -> Result<(), SessionError> {
        let (mut rows, mut count) = (Vec::new(), 0_u64);
        loop {
            // Asked before the last look: what is written afterwards would be missed else.
            let ended = reader.is_ended();
            let before = count;
            while let Some(cycle) = reader.next(&mut rows) {
                count += 1;
                if let Some(tap) = &mut self.tap {
                    tap.sample(&cycle, &rows);
                }
                self.push(cycle, &rows);
                if count.is_multiple_of(SEEN) {
                    seen(count);
                }
                if self.rows.trace().len() >= self.part {
                    self.hand_over(take)?;
                }
            }
            if count == before {
                if ended {
                    break;
                }
                thread::sleep(REST);
                // Whoever looks on is asked to while an arm is parked or stopped, too.
                seen(count);
            }
        }
        self.close();
        seen(count);
        if self.rows.trace().is_empty() { Ok(()) } else { self.hand_over(take) }
    }

    fn hand_over(&mut self, take: &mut Take<'_>) -> Result<(), SessionError> {
        let trace = self.rows.trace();
        if let Some(shares) = &mut self.shares {
            shares.fill(trace);
        }
        take(trace)?;
        self.rows.clear();
        Ok(())
    }

    /// Takes the next sample.
    pub fn push(&mut self, cycle: Cycle, rows: &[Row]) {
        self.timing.add(cycle.late_ns, cycle.took_ns);
        if let Some((fault, _)) = cycle.report.and_then(|report| report.fault) {
            let last = self.faults.last().map(|(_, name)| *name);
            if last != Some(fault.name()) {
                self.faults.push((cycle.t_ns as f64 * 1e-9, fault.name()));
            }
        }
        if cycle.known {
            self.rows.push(cycle.t_ns, rows, cycle.report.as_ref());
            return;
        }
        let (before, mut held) = self.held.take().unzip();
        if let (Some(before), Some(held)) = (before, &mut held) {
            for ((row, next), inertia) in held.iter_mut().zip(rows).zip(&self.inertia) {
                let ddq = (next.measurement.dq - row.measurement.dq) / self.period;
                row.acted = as_measured(row, next.measurement.tau_applied, ddq, *inertia);
            }
            self.rows.push(before.t_ns, held, before.report.as_ref());
        }
        // What the last acceleration was, should there be no next sample.
        let mut room = held.unwrap_or_default();
        let ddq = |i: usize| room.get(i).map_or(0.0, |row: &Row| row.acted.ddq);
        let with = |(i, row): (usize, &Row)| Row {
            acted: Acted { ddq: ddq(i), ..Acted::default() },
            ..*row
        };
        let next: Vec<Row> = rows.iter().enumerate().map(with).collect();
        room = next;
        self.held = Some((cycle, room));
    }

    /// Writes the last sample, whose torque no later sample reports.
    fn close(&mut self) {
        let Some((cycle, mut rows)) = self.held.take() else { return };
        for (row, inertia) in rows.iter_mut().zip(&self.inertia) {
            row.acted = as_measured(row, row.command.tau, row.acted.ddq, *inertia);
        }
        self.rows.push(cycle.t_ns, &rows, cycle.report.as_ref());
    }
}

/// Motion, torque and φ of a joint, from its measurements.
fn as_measured(row: &Row, tau: f64, ddq: f64, inertia: f64) -> Acted {
    let (q, dq) = (row.measurement.q, row.measurement.dq);
    Acted { q, dq, ddq, tau, phi: tau - inertia * ddq }
}
