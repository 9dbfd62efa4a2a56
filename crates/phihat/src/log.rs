//! A bounded record that a slow reader cannot hold up.

/// The last entries of a stream, at most `K`: when it is full, new entries are dropped and counted.
///
/// The tick pushes, never waits, and never allocates; whoever reads takes the entries out between ticks.
///
/// ```
/// use phihat::Log;
/// let mut log = Log::<u32, 2>::new();
/// for entry in 0..5 { log.push(entry); }
/// assert_eq!((log.pop(), log.pop(), log.pop(), log.dropped()), (Some(0), Some(1), None, 3));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Log<T, const K: usize> {
    entries: [Option<T>; K],
    first: usize,
    len: usize,
    dropped: u64,
}

impl<T: Copy, const K: usize> Default for Log<T, K> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Copy, const K: usize> Log<T, K> {
    /// A log without entries.
    #[must_use]
    pub fn new() -> Self {
        Self { entries: [None; K], first: 0, len: 0, dropped: 0 }
    }

    /// Appends an entry, or drops it when there is no room; `false` when it was dropped.
    pub fn push(&mut self, entry: T) -> bool {
        let tail = self.first + self.len;
        let tail = if tail >= K { tail - K } else { tail };
        if self.len < K {
            if let Some(slot) = self.entries.get_mut(tail) {
                *slot = Some(entry);
                self.len += 1;
                return true;
            }
        }
        self.dropped = self.dropped.saturating_add(1);
        false
    }

    /// Takes the oldest entry out.
    pub fn pop(&mut self) -> Option<T> {
        if self.len == 0 {
            return None;
        }
        let entry = self.entries.get_mut(self.first)?.take();
        self.first = if self.first + 1 < K { self.first + 1 } else { 0 };
        self.len -= 1;
        entry
    }

    /// Number of entries that wait.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true if no entry waits.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of entries dropped since the start.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}
