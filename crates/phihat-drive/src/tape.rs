//! The way of the record from the control thread to the one that writes: records of fixed size in a ring.

use std::thread;

use phihat::Report;
use phihat_sim::Row;
use rtrb::{Consumer, Producer, RingBuffer};

/// What came at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Arrival {
    /// A message.
    #[default]
    Fresh,
    /// Nothing.
    Lost,
    /// The controller did not run.
    Skipped,
}

/// One sample of a whole arm, beside its joints' rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cycle {
    /// Time since the start \[ns\].
    pub t_ns: u64,
    /// What came.
    pub arrival: Arrival,
    /// What the supervisor did, where there is one.
    pub report: Option<Report>,
    /// Whether its rows say what truly acted.
    pub known: bool,
    /// How late the loop woke \[ns\].
    pub late_ns: Option<u64>,
    /// How long the controller took \[ns\].
    pub took_ns: Option<u64>,
}

/// The end of the ring that the control thread has. Neither allocates nor locks.
#[derive(Debug)]
pub struct Tape {
    cycles: Producer<Cycle>,
    rows: Producer<Row>,
    joints: usize,
    patient: bool,
    ahead: bool,
}

/// The end of the ring that is read.
#[derive(Debug)]
pub struct Reader {
    cycles: Consumer<Cycle>,
    rows: Consumer<Row>,
    joints: usize,
}

/// A ring for so many samples of so many joints. A `patient` tape waits for room, where time is counted; one that is not says
/// that there is none.
pub fn ring(joints: usize, samples: usize, patient: bool) -> (Tape, Reader) {
    let (cycles, read_cycles) = RingBuffer::new(samples);
    let (rows, read_rows) = RingBuffer::new(samples.saturating_mul(joints));
    let reader = Reader { cycles: read_cycles, rows: read_rows, joints };
    (Tape { cycles, rows, joints, patient, ahead: false }, reader)
}

impl Tape {
    /// Writes a sample; `false`: there is no room, or nobody reads any more.
    pub fn push(&mut self, cycle: Cycle, rows: impl Iterator<Item = Row>) -> bool {
        while self.cycles.slots() == 0 || self.rows.slots() < self.joints {
            if !(self.patient || self.ahead) || self.is_unread() {
                return false;
            }
            thread::yield_now();
        }
        // A cycle is there once its rows are.
        rows.take(self.joints).all(|row| self.rows.push(row).is_ok())
            && self.cycles.push(cycle).is_ok()
    }

    /// Whether the samples came sooner than any robot's clock would have them: then a wait for room holds nobody up.
    pub fn ahead(&mut self, ahead: bool) {
        self.ahead = ahead;
    }

    /// Whether nobody reads any more.
    pub fn is_unread(&self) -> bool {
        self.cycles.is_abandoned()
    }
}

impl Reader {
    /// Whether nobody writes any more.
    pub fn is_ended(&self) -> bool {
        self.cycles.is_abandoned()
    }

    /// The next sample, its rows into `rows`; `None`: there is none yet.
    pub fn next(&mut self, rows: &mut Vec<Row>) -> Option<Cycle> {
        let cycle = self.cycles.pop().ok()?;
        rows.clear();
        rows.extend(self.rows.read_chunk(self.joints).ok()?);
        Some(cycle)
    }
}
