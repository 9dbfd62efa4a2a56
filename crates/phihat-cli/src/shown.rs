//! Progress of a command on the terminal, and the message on Ctrl-C meanwhile.

use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use phihat_session::{Done, Watch};

use crate::interrupt::{self, StopRequest};
use crate::terminal::is_quiet;

/// A progress bar that looks on.
pub(crate) struct TerminalWatch {
    bar: ProgressBar,
    /// Message on Ctrl-C while results are being written.
    words: String,
    /// True if the command was started with `--fresh`.
    fresh: bool,
    /// Stop request by Ctrl-C, where it is possible.
    asked: Option<StopRequest>,
    /// Prints the result of a run.
    says: Option<fn(&Done)>,
}

impl TerminalWatch {
    /// A bar of this look; it is seen from the first progress on.
    pub(crate) fn bar(template: &str, words: String) -> Self {
        let bar = if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(0) };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar, words, fresh: false, asked: None, says: None }
    }

    /// A spinner that says which step is being done, with how long it has been at it.
    pub(crate) fn steps() -> Self {
        let bar = spinner();
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, words: String::new(), fresh: false, asked: None, says: None }
    }

    /// Prints the result of a run as soon as it is known, if `says` is given.
    pub(crate) fn saying(self, says: Option<fn(&Done)>) -> Self {
        Self { says, ..self }
    }

    /// A bar of this look over work that can be asked to stop.
    pub(crate) fn stoppable(template: &str, words: String, asked: StopRequest) -> Self {
        Self { asked: Some(asked), ..Self::bar(template, words) }
    }

    /// A bar of this look over work that goes on from its journal, unless it is told to begin again.
    pub(crate) fn resumable(template: &str, fresh: bool) -> Self {
        Self { fresh, ..Self::bar(template, String::new()) }
    }
}

impl Watch for TerminalWatch {
    fn progress(&mut self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
    }

    fn resumed(&mut self) {
        self.bar.reset_eta();
    }

    fn saved_in(&mut self, journal: &Path) {
        self.words = interrupt::resumable(journal, self.fresh);
    }

    fn step(&mut self, what: &str) {
        self.bar.set_message(what.to_owned());
    }

    fn warn(&mut self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }

    fn begun(&mut self, unfinished: &[PathBuf]) {
        let (words, unfinished) = (self.words.clone(), unfinished.to_owned());
        interrupt::removes(&self.bar, words, unfinished, self.asked);
    }

    fn ended(&mut self) {
        interrupt::done();
        self.bar.finish_and_clear();
    }

    fn came_to(&mut self, done: &Done) {
        if let Some(says) = self.says {
            says(done);
        }
    }
}

/// A spinner for work whose end is not known, with how long it has been at it.
pub(crate) fn spinner() -> ProgressBar {
    let bar = if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} · {elapsed}") {
        bar.set_style(style);
    }
    bar
}

/// Progress of the second derivation of a bound: its part that is done.
pub(crate) fn second_derivation(share: f64) -> String {
    format!("bound, second derivation: {:.0} %", 100.0 * share)
}
