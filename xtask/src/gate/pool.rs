//! Steps of one stage, side by side.

use std::collections::VecDeque;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

use super::steps::GateStage;
use super::times::{self, Cost};
use crate::shell::{gate_folder, read};

/// Steps that run at the same time: one more than cores, so that the tests, which use all of them, end last.
const WORKERS: usize = 3;

/// A step that has ended.
#[derive(Debug)]
pub(super) struct Finished {
    pub(super) name: &'static str,
    pub(super) ok: bool,
    pub(super) cost: Cost,
}

/// Runs the steps of a stage in their order, and adds the result of each; an error where one failed. A step
/// that runs alongside one that fails goes on to its end; none is begun after that.
pub(super) fn run(
    root: &Path,
    program: &Path,
    stage: &GateStage,
    done: &mut Vec<Finished>,
) -> Result<(), String> {
    let alone = stage.len() == 1;
    let todo: Mutex<VecDeque<&'static str>> = Mutex::new(stage.iter().map(|s| s.name).collect());
    let finished = Mutex::new(Vec::new());
    let poisoned = "a thread of the gate panicked";
    let work = || -> Result<(), String> {
        loop {
            let failed = finished.lock().map_err(|_| poisoned)?.iter().any(|f: &Finished| !f.ok);
            let next = todo.lock().map_err(|_| poisoned)?.pop_front();
            let Some(name) = next.filter(|_| !failed) else { return Ok(()) };
            println!("── {name}");
            let (ok, printed) = process(root, program, name, alone)?;
            let cost = times::left(root, name)?;
            let mut finished = finished.lock().map_err(|_| poisoned)?;
            print!("{printed}");
            println!("── {name}: {}, {cost}", if ok { "ok" } else { "FAILED" });
            finished.push(Finished { name, ok, cost });
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..WORKERS).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().map_err(|_| poisoned)?)
    })?;
    let finished = finished.into_inner().map_err(|_| poisoned)?;
    let failed = finished.iter().find(|step| !step.ok).map(|step| step.name);
    done.extend(finished);
    failed.map_or(Ok(()), |name| Err(format!("FAILED: {name}")))
}

/// A copy of this program for the steps' processes: one of the steps builds the workspace, and this program with it.
pub(super) fn copy_of_this(root: &Path) -> Result<PathBuf, String> {
    let copy = gate_folder(root)?.join("xtask");
    let failed = |e: std::io::Error| format!("{}: {e}", copy.display());
    // A copy that still runs in another process stays what it is.
    let _ = std::fs::remove_file(&copy);
    std::fs::copy(std::env::current_exe().map_err(failed)?, &copy).map_err(failed)?;
    Ok(copy)
}

/// Runs a step in a process of its own: whether it passed, and what it printed. Alone, it prints to the terminal.
fn process(root: &Path, program: &Path, name: &str, alone: bool) -> Result<(bool, String), String> {
    let path = gate_folder(root)?.join(format!("{name}.log"));
    let failed = |e: std::io::Error| format!("{}: {e}", path.display());
    let mut command = Command::new(program);
    command.args(["test", "--step", name]).current_dir(root).stdin(Stdio::null());
    if !alone {
        let log = File::create(&path).map_err(failed)?;
        command.stdout(log.try_clone().map_err(failed)?).stderr(log);
    }
    let status = command.status().map_err(failed)?;
    let printed = if alone { String::new() } else { read(&path)? };
    Ok((status.success(), printed))
}
