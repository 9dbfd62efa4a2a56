//! Transfer of the record from the control thread to the writing thread: entries of fixed size in a ring.

use std::thread;

use phihat::Report;
use phihat_sim::Row;
use rtrb::{Consumer, Producer, RingBuffer};

/// Arrival of a message at a sample.
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

/// One sample of a whole arm, without the rows of its joints.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cycle {
    /// Time since the start \[ns\].
    pub t_ns: u64,
    /// Arrival of its message.
    pub arrival: Arrival,
    /// Report of the supervisor, where there is one.
    pub report: Option<Report>,
    /// True if `acted` of its rows is the true state: the arm is simulated.
    pub known: bool,
    /// Delay of the wake-up of the loop \[ns\].
    pub late_ns: Option<u64>,
    /// Computation time of the controller \[ns\].
    pub took_ns: Option<u64>,
}

/// Writing end of the ring, for the control thread. Neither allocates nor locks.
#[derive(Debug)]
pub struct Tape {
    cycles: Producer<Cycle>,
    rows: Producer<Row>,
    joints: usize,
    patient: bool,
    ahead: bool,
}

/// Reading end of the ring.
#[derive(Debug)]
pub struct Reader {
    cycles: Consumer<Cycle>,
    rows: Consumer<Row>,
    joints: usize,
}

/// A ring for `samples` samples of `joints` joints. A `patient` tape (lock-step) waits for room; else
/// [`Tape::push`] returns false where there is none.
pub fn ring(joints: usize, samples: usize, patient: bool) -> (Tape, Reader) {
    let (cycles, read_cycles) = RingBuffer::new(samples);
    let (rows, read_rows) = RingBuffer::new(samples.saturating_mul(joints));
    let reader = Reader { cycles: read_cycles, rows: read_rows, joints };
    (Tape { cycles, rows, joints, patient, ahead: false }, reader)
}

impl Tape {
    /// Writes a sample; `false`: there is no room, or the reader is gone.
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

    /// Sets whether the samples come sooner than by any robot's clock: then `push` waits for room, which
    /// delays nobody.
    pub fn ahead(&mut self, ahead: bool) {
        self.ahead = ahead;
    }

    /// Returns true if the reader is gone.
    pub fn is_unread(&self) -> bool {
        self.cycles.is_abandoned()
    }
}

impl Reader {
    /// Returns true if the writer is gone.
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
