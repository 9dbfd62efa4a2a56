//! Work shared among threads, its results in order.

/// How many run side by side.
pub(crate) fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// What is made of each entry of a list, in its order.
pub(crate) fn parallel<T: Send>(
    list: &[usize],
    threads: usize,
    make: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let share = list.len().div_ceil(threads).max(1);
    if share >= list.len() {
        return list.iter().map(|i| make(*i)).collect();
    }
    let make = &make;
    std::thread::scope(|scope| {
        let parts: Vec<_> = list
            .chunks(share)
            .map(|part| scope.spawn(move || part.iter().map(|i| make(*i)).collect::<Vec<T>>()))
            .collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|why| std::panic::resume_unwind(why)))
            .collect()
    })
}
