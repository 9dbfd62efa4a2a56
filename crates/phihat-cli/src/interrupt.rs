//! Message on Ctrl-C during a command that takes long: the saved results, and how to go on.

use std::path::PathBuf;
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError};

use indicatif::ProgressBar;
use phihat_session::disk::discard;

/// Exit code that a shell expects of a program that the user stopped.
const STOPPED: i32 = 130;

/// The command at work.
struct CommandAtWork {
    bar: ProgressBar,
    /// Message on Ctrl-C.
    words: String,
    /// Files that are invalid unless they are finished.
    unfinished: Vec<PathBuf>,
    /// Request to come to an end by itself, if it is possible; then the next Ctrl-C ends the program, unless
    /// the request was taken back meanwhile.
    asked: Option<StopRequest>,
}

/// Request to come to an end: the flag that it sets, and the choice of its message.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StopRequest {
    pub(crate) stop: &'static AtomicBool,
    /// True if the first request parks an arm without a fault, and is taken back then: the next one stops it
    /// on the way.
    pub(crate) parks: bool,
}

const STOPS: &str = "interrupted: the arm is being stopped, then the record is written; once more ends at once, and \
    leaves what was driven";
const PARKS: &str = "interrupted: the arm is being parked, or stopped if something is wrong, then the record is \
                     written; once more stops it on the way, or ends at once, and leaves what was driven, where it is \
                     being stopped";

static AT_WORK: Mutex<Option<CommandAtWork>> = Mutex::new(None);
static ONCE: Once = Once::new();
/// True if this process is the command, and not another program that uses its library.
static COMMAND: AtomicBool = AtomicBool::new(false);

/// This process is the command: Ctrl-C is its own.
pub(crate) fn is_ours() {
    COMMAND.store(true, Ordering::Relaxed);
}

/// From here on Ctrl-C clears the bar, removes files that are invalid unless they are finished, prints this
/// message, and ends the program.
///
/// In another program, and where the system takes no handler, Ctrl-C does what it does there.
///
/// Work with a request (`asked`) receives it at the first Ctrl-C, and ends by itself.
pub(crate) fn removes(
    bar: &ProgressBar,
    words: String,
    unfinished: Vec<PathBuf>,
    asked: Option<StopRequest>,
) {
    if !COMMAND.load(Ordering::Relaxed) {
        return;
    }
    *AT_WORK.lock().unwrap_or_else(PoisonError::into_inner) =
        Some(CommandAtWork { bar: bar.clone(), words, unfinished, asked });
    ONCE.call_once(|| {
        let _ = ctrlc::set_handler(|| {
            match &mut *AT_WORK.lock().unwrap_or_else(PoisonError::into_inner) {
                Some(CommandAtWork { bar, asked: Some(asked), .. })
                    if !asked.stop.swap(true, Ordering::Relaxed) =>
                {
                    let parks = core::mem::take(&mut asked.parks);
                    bar.suspend(|| eprintln!("{}", if parks { PARKS } else { STOPS }));
                    return;
                }
                Some(CommandAtWork { bar, words, unfinished, .. }) => {
                    for path in unfinished {
                        discard(path);
                    }
                    bar.finish_and_clear();
                    eprintln!("interrupted: {words}");
                }
                None => eprintln!("interrupted"),
            }
            exit(STOPPED);
        });
    });
}

/// Withdraws the message: the results are being written.
pub(crate) fn done() {
    *AT_WORK.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

/// The words for a campaign with a journal.
pub(crate) fn resumable(journal: &std::path::Path, fresh: bool) -> String {
    let how = if fresh { "the same command without --fresh" } else { "the same command" };
    format!("what is done is saved in {}; {how} goes on from there", journal.display())
}
