//! Hooks of a running drive: samples for others, and targets from others.

use std::sync::atomic::{AtomicU64, Ordering};

use phihat_sim::Row;

use crate::tape::Cycle;

/// Hook that gets each sample as it is recorded, on the writing thread: the control thread is not involved.
pub trait Tap: Send {
    /// The next sample, its joints in the study's order. Must not wait.
    fn sample(&mut self, cycle: &Cycle, rows: &[Row]);
}

/// The latest requested position: one thread writes, the control thread reads; neither waits, locks or allocates.
///
/// # Example
///
/// ```
/// use phihat_drive::Targets;
///
/// let targets = Targets::new(2);
/// let (mut seen, mut q) = (0, [0.0; 2]);
/// assert!(!targets.newer(&mut seen, &mut q)); // nobody asked yet
/// assert!(targets.ask(&[0.1, 0.2]));
/// assert!(targets.newer(&mut seen, &mut q) && q == [0.1, 0.2]);
/// assert!(!targets.newer(&mut seen, &mut q)); // it is known already
/// ```
#[derive(Debug)]
pub struct Targets {
    /// Odd while the positions are being written.
    version: AtomicU64,
    q: Vec<AtomicU64>,
}

impl Targets {
    /// For so many joints.
    pub fn new(joints: usize) -> Self {
        Self {
            version: AtomicU64::new(0),
            q: std::iter::repeat_with(AtomicU64::default).take(joints).collect(),
        }
    }

    /// Requests positions \[rad, m\] in the study's order; `false`: their number is not that of the joints.
    /// Only one thread may call this.
    pub fn ask(&self, q: &[f64]) -> bool {
        if q.len() != self.q.len() {
            return false;
        }
        self.version.fetch_add(1, Ordering::SeqCst);
        for (cell, q) in self.q.iter().zip(q) {
            cell.store(q.to_bits(), Ordering::SeqCst);
        }
        self.version.fetch_add(1, Ordering::SeqCst);
        true
    }

    /// Copies the requested positions if they are newer than `seen`, and returns true; while they are being
    /// written there is nothing new.
    pub fn newer(&self, seen: &mut u64, q: &mut [f64]) -> bool {
        let before = self.version.load(Ordering::SeqCst);
        if before == *seen || before % 2 == 1 || q.len() != self.q.len() {
            return false;
        }
        for (q, cell) in q.iter_mut().zip(&self.q) {
            *q = f64::from_bits(cell.load(Ordering::SeqCst));
        }
        if self.version.load(Ordering::SeqCst) != before {
            return false;
        }
        *seen = before;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::Targets;

    /// A position that is half of one target and half of another would be one that nobody asked for.
    #[test]
    fn no_target_is_torn() {
        let (targets, last) = (Targets::new(7), 299_999_u32);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for k in 0..=last {
                    assert!(targets.ask(&[f64::from(k); 7]));
                }
            });
            let (mut seen, mut q) = (0, [-1.0; 7]);
            while seen != 2 * u64::from(last + 1) {
                if targets.newer(&mut seen, &mut q) {
                    assert!(q.iter().all(|one| one.to_bits() == q[0].to_bits()), "{q:?}");
                }
            }
        });
    }
}
