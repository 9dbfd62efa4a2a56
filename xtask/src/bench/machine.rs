//! Machine on which the figures were measured.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

/// The processor, the system, our compiler and our commit.
pub(super) struct BenchMachine {
    cpu: String,
    cores: usize,
    system: String,
    rustc: String,
    commit: String,
    /// The core that both sides run on, where `taskset` can pin them.
    core: Option<usize>,
}

impl BenchMachine {
    pub(super) fn inspect(root: &Path) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            cpu: cpu(),
            cores,
            system: first_line(Command::new("uname").arg("-srm")),
            rustc: first_line(Command::new("rustc").arg("--version")),
            commit: commit(root),
            core: if first_line(Command::new("taskset").arg("--version")) == UNKNOWN {
                None
            } else {
                last_allowed_core()
            },
        }
    }

    /// The same command on the chosen core.
    pub(super) fn pin(&self, command: Command) -> Command {
        let Some(core) = self.core else { return command };
        let mut pinned = Command::new("taskset");
        pinned.args(["-c", &core.to_string()]).arg(command.get_program()).args(command.get_args());
        if let Some(folder) = command.get_current_dir() {
            pinned.current_dir(folder);
        }
        pinned
    }

    pub(super) fn text(&self) -> String {
        let pinned = self.core.map_or("not pinned".into(), |core| format!("pinned to core {core}"));
        format!(
            "machine    {}, {} cores, {}, {pinned}\nours       commit {}, {}, bench profile\n",
            self.cpu, self.cores, self.system, self.commit, self.rustc
        )
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "cpu": self.cpu,
            "cores": self.cores,
            "system": self.system,
            "rustc": self.rustc,
            "commit": self.commit,
            "pinned_to_core": self.core,
        })
    }
}

const UNKNOWN: &str = "unknown";

/// First line of what a command prints.
pub(super) fn first_line(command: &mut Command) -> String {
    let text = command.output().ok().filter(|o| o.status.success()).map(|o| o.stdout);
    let text = text.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default();
    text.lines().next().unwrap_or(UNKNOWN).trim().to_owned()
}

/// Name, family and model: a virtual machine's name alone says little.
fn cpu() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |key: &str| {
        let line = text.lines().find(|l| l.split(':').next().is_some_and(|k| k.trim() == key));
        line.and_then(|l| l.split(':').nth(1)).unwrap_or(UNKNOWN).trim().to_owned()
    };
    format!("{} (family {}, model {})", field("model name"), field("cpu family"), field("model"))
}

/// The last core this process may use: the first one serves most interrupts.
fn last_allowed_core() -> Option<usize> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let list = text.lines().find_map(|l| l.strip_prefix("Cpus_allowed_list:"))?;
    list.trim().rsplit([',', '-']).next()?.parse().ok()
}

/// The day of the commit that is measured.
pub(super) fn date(root: &Path) -> String {
    first_line(Command::new("git").current_dir(root).args(["log", "-1", "--format=%cs"]))
}

fn commit(root: &Path) -> String {
    let hash =
        first_line(Command::new("git").current_dir(root).args(["rev-parse", "--short", "HEAD"]));
    let changes = ["status", "--porcelain", "--untracked-files=no"];
    let changed = first_line(Command::new("git").current_dir(root).args(changes)) != UNKNOWN;
    if changed { format!("{hash} with changes") } else { hash }
}
