//! The `phihat` command: from a study to evidence.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    // A reader that has seen enough, such as `head`, ends the program as it ends others.
    sigpipe::reset();
    phihat_cli::run(std::env::args_os())
}
