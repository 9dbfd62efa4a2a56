//! `xtask measured PROGRAM …`: runs one test and notes its processor time. The gate makes it cargo's runner
//! of test programs.

use std::ffi::OsString;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::process::{Command, ExitCode};

use super::times;

/// The variable with the file that a line is added to for each test.
pub(super) const LOG: &str = "PHIHAT_TEST_TIMES";

/// Runs a program to its end with its arguments; the exit code is the program's.
pub(crate) fn run(arguments: &[OsString]) -> Result<ExitCode, String> {
    let (program, arguments) = arguments.split_first().ok_or("measured PROGRAM [ARGUMENT …]")?;
    let status = Command::new(program)
        .args(arguments)
        .status()
        .map_err(|e| format!("{}: {e}", program.display()))?;
    let test =
        arguments.iter().position(|word| word == "--exact").and_then(|at| arguments.get(at + 1));
    if let (Some(test), Some(file)) = (test, std::env::var_os(LOG)) {
        let crate_name = std::env::var("NEXTEST_BINARY_ID").unwrap_or_default();
        let line =
            format!("{:.3} {crate_name} {}\n", times::processor_of_children(), test.display());
        // One write: lines of tests that end at the same time do not mix.
        let added = OpenOptions::new().append(true).create(true).open(&file);
        added.and_then(|mut file| file.write_all(line.as_bytes())).map_err(|e| e.to_string())?;
    }
    // A program that a signal ended has no exit code.
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}
