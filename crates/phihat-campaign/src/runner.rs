//! Many runs on several threads, each recorded as it ends.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::journal::{Journal, JournalError};

/// Result of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunEnded<E> {
    /// It ran to its end.
    With(E),
    /// It panicked, saying this. A panic is a fault of this program.
    Panicked(String),
}

/// Progress of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Runs that were in the journal already.
    pub resumed: usize,
    /// Runs recorded, those included.
    pub done: usize,
    /// All runs.
    pub all: usize,
}

/// Does what a journal does not hold yet, and gives every run's record in the order of `ids`.
///
/// An id stands for all that decides a run's outcome: two runs with one id are one run. `work` gets a place
/// in `ids` and must depend on nothing else, so that the answer is the same whatever the number of threads
/// and however often the campaign was interrupted. Every record, fresh or resumed, is read back from the
/// text in the journal.
///
/// # Errors
///
/// [`JournalError`] when the journal cannot be written: no further run is begun.
pub fn run_all<E>(
    ids: &[String],
    journal: &mut Journal,
    threads: usize,
    work: &(impl Fn(usize) -> E + Sync),
    mut progress: impl FnMut(Progress),
) -> Result<Vec<RunEnded<E>>, JournalError>
where
    E: Serialize + DeserializeOwned + Send,
{
    let mut asked: HashSet<&str> = HashSet::with_capacity(ids.len());
    let mut waiting: Vec<usize> = Vec::new();
    for (place, id) in ids.iter().enumerate() {
        if read::<E>(journal, id).is_none() && asked.insert(id) {
            waiting.push(place);
        }
    }
    let all = ids.len();
    let resumed = all - waiting.len();
    progress(Progress { resumed, done: resumed, all });
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, waiting.len().max(1)) {
            let (sender, waiting, next, stop) = (sender.clone(), &waiting, &next, &stop);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed)
                    && let Some(&place) = waiting.get(next.fetch_add(1, Ordering::Relaxed))
                    && sender.send((place, attempt(work, place))).is_ok()
                {}
            });
        }
        drop(sender);
        let mut done = resumed;
        while let Some(group) = group(&receiver) {
            let lines = group.iter().map(|(place, ended)| (ids[*place].as_str(), ended));
            journal.append_all(lines).inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
            for _ in group {
                done += 1;
                progress(Progress { resumed, done, all });
            }
        }
        Ok(())
    })?;
    Ok(ids.iter().filter_map(|id| read(journal, id)).collect())
}

/// Most results that are recorded at once.
const GROUP: usize = 4096;

/// Results that have arrived since the last call, at least one; `None` when all runs have ended. Results that
/// arrive while the disk is busy are written together, so that many short runs wait for the disk no more
/// often than few long ones.
pub(crate) fn group<T>(receiver: &mpsc::Receiver<T>) -> Option<Vec<T>> {
    let first = receiver.recv().ok()?;
    Some(std::iter::once(first).chain(receiver.try_iter().take(GROUP - 1)).collect())
}

/// A run's record; `None` when there is none, or it has another shape.
fn read<E: DeserializeOwned>(journal: &Journal, id: &str) -> Option<RunEnded<E>> {
    serde_json::from_str(journal.entry(id)?).ok()
}

pub(crate) fn attempt<E>(work: &(impl Fn(usize) -> E + Sync), place: usize) -> RunEnded<E> {
    // What a panicking run leaves half-done is its own and goes with it.
    match catch_unwind(AssertUnwindSafe(|| work(place))) {
        Ok(entry) => RunEnded::With(entry),
        Err(cause) => {
            let text = cause.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| cause.downcast_ref::<&str>().copied());
            RunEnded::Panicked(text.unwrap_or("a panic without words").to_owned())
        }
    }
}
