//! Runs a study and writes its record and a log of it: `log STUDY FOLDER LOG`. The tests read such logs with
//! third-party readers.
#![forbid(unsafe_code)]

use std::path::PathBuf;

use phihat_session::{RunOptions, SessionError, TraceKind};

fn main() -> Result<(), SessionError> {
    let mut words = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(study), out, log) = (words.next(), words.next(), words.next()) else {
        return Err(SessionError::other("log STUDY FOLDER LOG"));
    };
    let options = RunOptions { study, out, log, trace: TraceKind::Csv, ..RunOptions::default() };
    let (session, folder) = options.open()?;
    session.simulate(&folder, None, &mut ()).map(drop)
}
