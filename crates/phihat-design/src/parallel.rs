//! Work shared among threads, its results in order.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::ScopedJoinHandle;

/// Number of threads that run in parallel.
pub(crate) fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Results of `make` for each entry of a list, in its order; a thread that is done takes the next one.
pub(crate) fn parallel<T: Send>(
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
    let mut all: Vec<(usize, T)> = std::thread::scope(|scope| {
        let parts: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        parts.into_iter().flat_map(joined).collect()
    });
    all.sort_by_key(|(at, _)| *at);
    all.into_iter().map(|(_, made)| made).collect()
}

/// Results of two functions, run in parallel where there is more than one thread.
pub(crate) fn both<A: Send, B>(
    threads: usize,
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B,
) -> (A, B) {
    if threads < 2 {
        let other = other();
        return (one(), other);
    }
    std::thread::scope(|scope| {
        let one = scope.spawn(one);
        let other = other();
        (joined(one), other)
    })
}

fn joined<T>(part: ScopedJoinHandle<'_, T>) -> T {
    part.join().unwrap_or_else(|why| std::panic::resume_unwind(why))
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
