//! The binary at work, and waits for what it comes to: for a state, never for a time.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::Answer;

/// From one look to the next.
const TICK: Duration = Duration::from_millis(5);

/// Looks, 5 ms or more apart, before a test gives up: ten minutes, which only what never comes takes.
const LOOKS: u32 = 120_000;

/// Waits until something is so.
pub(crate) fn wait_for(what: &str, is_it: impl Fn() -> bool) {
    for _ in 0..LOOKS {
        if is_it() {
            return;
        }
        thread::sleep(TICK);
    }
    panic!("waited for ten minutes, in vain: {what}");
}

/// `phihat` at work. A process that is left to itself is killed.
pub(crate) struct Running {
    pub(crate) child: Child,
    /// Command that was started.
    words: String,
    out: Option<JoinHandle<String>>,
    /// Lines of the standard error output: those that were waited for, and those to come.
    err: String,
    lines: Receiver<String>,
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Running {
    /// Starts it in a folder, with an operation on the disk struck: see `phihat_session::disk`.
    pub(crate) fn of(folder: &Path, arguments: &[&str], strike: Option<&str>) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_phihat"));
        command.args(arguments).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
        if let Some(how) = strike {
            command.env("PHIHAT_STRIKE", how);
        }
        let mut child = command.spawn().unwrap();
        let mut stdout = child.stdout.take().unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        let out = thread::spawn(move || {
            let mut text = String::new();
            stdout.read_to_string(&mut text).unwrap();
            text
        });
        let (sender, lines) = channel();
        thread::spawn(move || {
            stderr.lines().map_while(Result::ok).try_for_each(|line| sender.send(line))
        });
        let words = format!("{strike:?} {arguments:?}");
        Self { child, words, out: Some(out), err: String::new(), lines }
    }

    /// Waits for the operation that is struck; `false`: the process ended without it.
    pub(crate) fn is_struck(&mut self) -> bool {
        loop {
            match self.lines.recv_timeout(TICK * LOOKS) {
                Ok(line) => {
                    self.err += &line;
                    self.err.push('\n');
                    if line.contains("struck: ") {
                        return true;
                    }
                }
                Err(RecvTimeoutError::Disconnected) => return false,
                Err(RecvTimeoutError::Timeout) => {
                    panic!("waited for the operation that is struck: {}\n{}", self.words, self.err)
                }
            }
        }
    }

    /// Waits until something is so; `false`: the process ended before.
    pub(crate) fn until(&mut self, what: &str, is_it: impl Fn() -> bool) -> bool {
        for _ in 0..LOOKS {
            if is_it() {
                return true;
            }
            if self.child.try_wait().unwrap().is_some() {
                // It may have done it last.
                return is_it();
            }
            thread::sleep(TICK);
        }
        panic!("waited for ten minutes, in vain: {what}: {}", self.words);
    }

    /// Kills it; whether it was at work until then.
    pub(crate) fn kill(mut self) -> bool {
        self.child.kill().unwrap();
        self.child.wait().unwrap().code().is_none()
    }

    /// Waits for its end.
    pub(crate) fn answer(mut self) -> Answer {
        assert!(!self.until("its end", || false));
        let code = self.child.wait().unwrap().code().unwrap_or(-1);
        let out = self.out.take().unwrap().join().unwrap();
        for line in &self.lines {
            self.err += &line;
            self.err.push('\n');
        }
        Answer { code, out, err: std::mem::take(&mut self.err) }
    }
}
