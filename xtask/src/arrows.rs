//! The crates: which may use which, and why each is one. ARCHITECTURE.md's table is made from this, and CI
//! holds both against the manifests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// A crate: its name, the crates of ours that it may use, and why it is one.
type CrateRow = (&'static str, &'static [&'static str], &'static str);

const CRATES: [CrateRow; 25] = [
    (
        "phihat",
        &[],
        "the real-time core: `no_std`, no heap, no panic, no `unsafe`. It cannot see a model, so \"model-free\" is \
            proved by the dependency graph",
    ),
    (
        "phihat-model",
        &[],
        "robot description (URDF, xacro, MJCF, plus what they lack; what an arm looks like), the arms in `robots/`, \
            and rigid-body dynamics; useful alone",
    ),
    (
        "phihat-study",
        &["phihat", "phihat-model"],
        "the study file: text to checked plain data, with errors that name file, line and key. It computes nothing",
    ),
    (
        "phihat-kernel",
        &[],
        "the trusted base: stability and margins of sampled linear loops, proved in exact arithmetic; to be read in an \
            evening. It knows no law, no document and no arm",
    ),
    (
        "phihat-certificate",
        &["phihat", "phihat-kernel", "phihat-model", "phihat-study"],
        "the documents: gains and every claim about them, as data, and `verify`. It sees neither the finders nor a \
            package of linear algebra: whoever checks does not know how a claim was found",
    ),
    (
        "phihat-design",
        &["phihat", "phihat-certificate", "phihat-model", "phihat-study"],
        "specification to gains and certificate: `claims/` finds those about the continuous law, `sampled/` those \
            about the loop as it runs, `elastic/` joints that bend, `tube/` the envelope of a motion, `class/` the \
            bound for every motion of a class, `limit/` what no linear law undercuts; `export/` the gains for ROS 2, \
            C, tables",
    ),
    (
        "phihat-sim",
        &["phihat", "phihat-model", "phihat-study"],
        "plant, drives, sensors, references, the closed loop, the trace. It does not see `-design`: whoever judges did \
            not tune",
    ),
    (
        "phihat-rivals",
        &["phihat", "phihat-model"],
        "other laws, one file each. What a rival needs is in its types, and it is handed only that",
    ),
    (
        "phihat-fci",
        &[],
        "the Franka Control Interface for torque control: codec, client, and the robot's side as a state machine with \
            sockets around it. It knows no arm and no study",
    ),
    (
        "phihat-report",
        &["phihat-design", "phihat-sim"],
        "figures as data and the one drawer of them (`kit`), and the page of a run: a pure function of recorded data, \
            which runs nothing and does no I/O. It cannot see the paper or a rival",
    ),
    (
        "phihat-synthesis",
        &[
            "phihat",
            "phihat-certificate",
            "phihat-design",
            "phihat-model",
            "phihat-sim",
            "phihat-study",
        ],
        "from a study to gains: `synthesize.rs` is the algorithm (specification, candidates, tube, shares, \
            certificate). Only here a candidate of an arm meets the motion whose tube bounds its error",
    ),
    (
        "phihat-session",
        &[
            "phihat",
            "phihat-certificate",
            "phihat-design",
            "phihat-fci",
            "phihat-model",
            "phihat-report",
            "phihat-sim",
            "phihat-study",
            "phihat-synthesis",
        ],
        "a study taken through gains, closed loop and record, and a record read back and checked; `disk`, the one way \
            to the disk. Every shell is made of it",
    ),
    (
        "phihat-drive",
        &[
            "phihat",
            "phihat-design",
            "phihat-fci",
            "phihat-model",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
        ],
        "one loop for every robot behind a link, which it knows by its facts alone; the links, the simulated arm and a \
            Franka; the checks before it, and how well a machine keeps time",
    ),
    (
        "phihat-campaign",
        &[
            "phihat",
            "phihat-design",
            "phihat-model",
            "phihat-report",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
        ],
        "many runs with one answer: runner and resumable journal; the fault matrix, the sweep, their pages; rollouts, \
            which leave arrays; `statistics/`, the one place for them",
    ),
    (
        "phihat-compare",
        &[
            "phihat",
            "phihat-campaign",
            "phihat-design",
            "phihat-model",
            "phihat-report",
            "phihat-rivals",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
            "phihat-synthesis",
        ],
        "the rivals tuned alike, run in the same worlds and judged, and the page of it; `fronts/` the comparison at \
            equal noise, `protocol/` its parts",
    ),
    (
        "phihat-studio",
        &[
            "phihat",
            "phihat-compare",
            "phihat-design",
            "phihat-model",
            "phihat-report",
            "phihat-rivals",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
            "phihat-synthesis",
        ],
        "a run that goes on while faults come, another law beside it, or a record that is played; and the pages of \
            this machine that look on and give orders; the only crate with a web server",
    ),
    (
        "phihat-paper",
        &[
            "phihat",
            "phihat-campaign",
            "phihat-compare",
            "phihat-design",
            "phihat-model",
            "phihat-report",
            "phihat-rivals",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
        ],
        "the paper, computed again statement by statement, with its studies and its page",
    ),
    (
        "phihat-cli",
        &[
            "phihat",
            "phihat-campaign",
            "phihat-certificate",
            "phihat-compare",
            "phihat-design",
            "phihat-drive",
            "phihat-fci",
            "phihat-model",
            "phihat-paper",
            "phihat-report",
            "phihat-rivals",
            "phihat-session",
            "phihat-sim",
            "phihat-studio",
            "phihat-study",
            "phihat-synthesis",
        ],
        "the binary `phihat`, one file per verb: arguments, tables, progress, exit codes",
    ),
    ("phihat-c", &["phihat"], "the controller for C99 and C++17; the only crate with `unsafe`"),
    (
        "phihat-py",
        &[
            "phihat",
            "phihat-campaign",
            "phihat-compare",
            "phihat-design",
            "phihat-drive",
            "phihat-model",
            "phihat-paper",
            "phihat-report",
            "phihat-rivals",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
            "phihat-synthesis",
        ],
        "the Python package: a sibling of the command line, on the same options",
    ),
    (
        "phihat-web",
        &[
            "phihat-certificate",
            "phihat-compare",
            "phihat-design",
            "phihat-model",
            "phihat-report",
            "phihat-rivals",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
            "phihat-synthesis",
        ],
        "phihat in a browser: tasks and answers as documents, without disk and threads; `page/` the page, also in the \
         place of the book's pictures. Its part for \
         browsers is compiled for `wasm32` alone: `cargo xtask web`",
    ),
    (
        "phihat-attack",
        &[
            "phihat",
            "phihat-campaign",
            "phihat-certificate",
            "phihat-design",
            "phihat-model",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
            "phihat-synthesis",
        ],
        "random arms and studies that try to break a certificate: `cargo xtask attack`. Nothing uses it",
    ),
    (
        "phihat-fuzz",
        &[
            "phihat",
            "phihat-campaign",
            "phihat-certificate",
            "phihat-fci",
            "phihat-model",
            "phihat-sim",
            "phihat-study",
        ],
        "bytes that nobody would write, against every reader and the core: in the tests a few, `cargo xtask fuzz` for \
            longer. Only the tests of `phihat-c` use it",
    ),
    (
        "phihat-examples",
        &[
            "phihat",
            "phihat-certificate",
            "phihat-design",
            "phihat-model",
            "phihat-report",
            "phihat-session",
            "phihat-sim",
            "phihat-study",
        ],
        "`examples/rust`: numbered, one file each, run by the tests",
    ),
    ("xtask", &[], "the project's chores"),
];

/// The crates that go to a registry.
pub(crate) const PUBLISHED: [&str; 18] = [
    "phihat",
    "phihat-kernel",
    "phihat-model",
    "phihat-study",
    "phihat-certificate",
    "phihat-design",
    "phihat-sim",
    "phihat-rivals",
    "phihat-fci",
    "phihat-report",
    "phihat-synthesis",
    "phihat-session",
    "phihat-drive",
    "phihat-campaign",
    "phihat-compare",
    "phihat-paper",
    "phihat-studio",
    "phihat-cli",
];

/// Crates that a crate may not reach on any way, ours and others.
const NEVER: [(&str, &[&str]); 4] = [
    ("phihat-certificate", &["phihat-design", "nalgebra", "microlp"]),
    ("phihat-sim", &["phihat-design"]),
    ("phihat-report", &["phihat-rivals", "phihat-compare", "phihat-paper", "phihat-campaign"]),
    ("phihat-py", &["clap", "phihat-cli"]),
];

const DOCUMENT: &str = "ARCHITECTURE.md";
const BEGIN: &str = "<!-- crates, by cargo xtask arrows -->\n";
const END: &str = "<!-- end of crates -->";

/// ARCHITECTURE.md's table.
fn table() -> String {
    let rows = CRATES.iter().map(|(name, may, why)| {
        let short = |name: &&str| match name.strip_prefix("phihat") {
            Some("") | None => format!("`{name}`"),
            Some(rest) => format!("`{rest}`"),
        };
        let may: Vec<String> = may.iter().map(short).collect();
        let may = if may.is_empty() { "–".to_owned() } else { may.join(", ") };
        format!("| `{name}` | {may} | {why} |\n")
    });
    let head = "| crate | may use | why it is a crate |\n|---|---|---|\n".to_owned();
    std::iter::once(head).chain(rows).collect()
}

/// The document, cut at its table.
fn document(root: &Path) -> Result<(String, String, String), String> {
    let text = fs::read_to_string(root.join(DOCUMENT)).map_err(|e| format!("{DOCUMENT}: {e}"))?;
    let cut = || {
        let (before, rest) = text.split_once(BEGIN)?;
        let (table, after) = rest.split_once(END)?;
        Some((before.to_owned(), table.to_owned(), after.to_owned()))
    };
    cut().ok_or_else(|| format!("{DOCUMENT}: no place for the table of crates"))
}

/// Writes the table into ARCHITECTURE.md.
pub(crate) fn bless(root: &Path) -> Result<(), String> {
    let (before, _, after) = document(root)?;
    let text = format!("{before}{BEGIN}{}{END}{after}", table());
    fs::write(root.join(DOCUMENT), text).map_err(|e| format!("{DOCUMENT}: {e}"))
}

/// Every arrow that the table does not allow, a core that depends on anything, a way where there may be none,
/// and a document that says something else.
pub(crate) fn wrong(root: &Path) -> Result<Vec<String>, String> {
    let metadata = metadata(root)?;
    let allowed: BTreeMap<_, _> = CRATES.into_iter().map(|(name, may, _)| (name, may)).collect();
    let ours: BTreeSet<&str> = metadata["workspace_members"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    let mut wrong = Vec::new();
    if document(root)?.1 != table() {
        wrong.push(format!("{DOCUMENT}'s crates are not those of xtask: `cargo xtask arrows`"));
    }
    let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let name = package["name"].as_str().unwrap_or_default();
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            // Features may be off: what is optional elsewhere is no way of ours.
            let counts =
                dependency["kind"].is_null() && dependency["optional"] != Value::Bool(true);
            if counts {
                let on = dependency["name"].as_str().unwrap_or_default();
                uses.entry(name).or_default().insert(on);
            }
        }
        if !package["id"].as_str().is_some_and(|id| ours.contains(id)) {
            continue;
        }
        let Some(may) = allowed.get(name) else {
            wrong.push(format!("crate {name} is not in {DOCUMENT}'s table"));
            continue;
        };
        for on in uses.get(name).into_iter().flatten() {
            if name == "phihat" {
                wrong.push(format!("phihat depends on {on}; the core depends on nothing"));
            } else if allowed.contains_key(on) && !may.contains(on) {
                wrong.push(format!("{name} uses {on}; {DOCUMENT}'s table has no such arrow"));
            }
        }
    }
    for (from, never) in NEVER {
        let reached = reached(from, &uses);
        for to in never.iter().filter(|to| reached.contains(**to)) {
            wrong.push(format!("{from} reaches {to}, and may not on any way"));
        }
    }
    Ok(wrong)
}

/// A crate, and all of ours that it may use on any way.
pub(crate) fn may_reach(name: &'static str) -> BTreeSet<&'static str> {
    let uses =
        CRATES.into_iter().map(|(name, may, _)| (name, may.iter().copied().collect())).collect();
    let mut all = reached(name, &uses);
    all.insert(name);
    all
}

/// All that a package uses, and what that uses.
fn reached<'a>(from: &'a str, uses: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> BTreeSet<&'a str> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(name) = open.pop() {
        for on in uses.get(name).into_iter().flatten() {
            if reached.insert(*on) {
                open.push(on);
            }
        }
    }
    reached
}

fn metadata(root: &Path) -> Result<Value, String> {
    let output = Command::new("cargo")
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(root)
        .output()
        .map_err(|e| e.to_string())?;
    serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())
}
