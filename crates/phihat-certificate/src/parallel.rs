//! Work done side by side: the one place where a computation takes threads, its results in order.
//!
//! Where there is one thread, as in a browser, the same work is done in turn: results have the same bits.

use std::cell::Cell;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{ScopedJoinHandle, available_parallelism, scope};

thread_local! {
    /// True while this thread works by itself.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Number of threads that run in parallel; one where the platform has none, and within [`alone`].
pub fn threads() -> usize {
    if ALONE.get() { 1 } else { available_parallelism().map_or(1, usize::from) }
}

/// Result of some work that takes no thread but this one.
pub fn alone<T>(work: impl FnOnce() -> T) -> T {
    let before = ALONE.replace(true);
    let made = work();
    ALONE.set(before);
    made
}

/// Results of `make` for each index below `count`, in order, on as many threads as there are.
pub fn shared<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    parallel(&(0..count).collect::<Vec<_>>(), threads(), make)
}

/// Results of `make` for each entry of a list, in its order; a thread that is done takes the next one.
pub fn parallel<T: Send>(
    list: &[usize],
    threads: usize,
    make: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let threads = threads.min(list.len());
    if threads < 2 {
        return list.iter().map(|i| make(*i)).collect();
    }
    let next = AtomicUsize::new(0);
    let work = || {
        let mut own = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(i) = list.get(at) else { return own };
            own.push((at, make(*i)));
        }
    };
    let mut all: Vec<(usize, T)> = scope(|scope| {
        let parts: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        parts.into_iter().flat_map(joined).collect()
    });
    all.sort_by_key(|(at, _)| *at);
    all.into_iter().map(|(_, made)| made).collect()
}

/// Results of two functions, run in parallel where there is more than one thread.
pub fn both<A: Send, B>(
    threads: usize,
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B,
) -> (A, B) {
    if threads < 2 {
        let other = other();
        return (one(), other);
    }
    scope(|scope| {
        let one = scope.spawn(one);
        let other = other();
        (joined(one), other)
    })
}

fn joined<T>(part: ScopedJoinHandle<'_, T>) -> T {
    part.join().unwrap_or_else(|why| resume_unwind(why))
}

#[cfg(test)]
mod tests {
    use super::parallel;

    #[test]
    fn in_the_order_of_the_list_however_many_threads() {
        let list: Vec<usize> = (0..23).rev().collect();
        let square = |i: usize| i * i;
        let alone = parallel(&list, 1, square);
        for threads in [2, 3, 64] {
            assert_eq!(parallel(&list, threads, square), alone);
        }
    }
}
