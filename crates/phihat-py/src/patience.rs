//! Work that nobody can end half-way, while Python still hears signals.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Interval at which Python is asked for signals.
const TICK: Duration = Duration::from_millis(50);

/// Result of some work, done on a thread of its own without the interpreter's lock. Ctrl-C raises its
/// exception within a twentieth of a second; the work is then left to its end, and nobody waits for it.
pub(crate) fn patiently<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = sync_channel(1);
    let begun = thread::Builder::new().name("phihat".to_owned());
    // Nobody may wait any more.
    begun.spawn(move || _ = sender.send(work()))?;
    py.detach(move || {
        loop {
            match receiver.recv_timeout(TICK) {
                Ok(done) => return Ok(done),
                Err(RecvTimeoutError::Timeout) => Python::attach(signals)?,
                Err(RecvTimeoutError::Disconnected) => {
                    let why = "phihat panicked; what it printed says where";
                    return Err(PyRuntimeError::new_err(why));
                }
            }
        }
    })
}

/// Raises the exception of a signal that came.
pub(crate) fn signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}
