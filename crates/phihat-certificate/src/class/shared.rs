//! Work shared among threads, its results in order.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Results of `make` for each index below `count`, in order; a thread that is done takes the next one.
pub(super) fn shared<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = thread::available_parallelism().map_or(1, usize::from).min(count);
    let next = AtomicUsize::new(0);
    let work = || {
        let indices = core::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        indices.take_while(|at| *at < count).map(|at| (at, make(at))).collect::<Vec<_>>()
    };
    let mut all: Vec<(usize, T)> = thread::scope(|scope| {
        let parts: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let made = parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|why| std::panic::resume_unwind(why)));
        made.collect()
    });
    all.sort_by_key(|(at, _)| *at);
    all.into_iter().map(|(_, made)| made).collect()
}
