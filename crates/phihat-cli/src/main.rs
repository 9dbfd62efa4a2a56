//! The `phihat` command: from a study to evidence.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    phihat_cli::run(std::env::args_os())
}
