//! Pinocchio: its wheel, a compiler, and the timing program built from the wheel's headers. MuJoCo: its wheel
//! and a script.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use super::machine::first_line;
use super::places::{ARMS, BenchPlaces, output, write};

/// Flags of Pinocchio's own build, and the optimisation that users of it would choose.
const FLAGS: [&str; 8] = [
    "-O3",
    "-DNDEBUG",
    "-std=c++17",
    "-march=native",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
];

/// Installed when no clang is there. Measured on one machine (AMD family 25, model 1): g++ 12 makes
/// Pinocchio's RNEA and ABA 1.6 times slower, its joint Jacobians 1.2 times faster; clang 19 and 22
/// are within 5 % of each other on the panda. So clang is the bar, and `--cxx g++` shows the rest.
const CLANG_PACKAGE: &str = "clang-19";

/// The timing programs, ready to run.
pub(super) struct Peer {
    program: PathBuf,
    arms: PathBuf,
    python: PathBuf,
    script: PathBuf,
    /// The arm that MuJoCo rolls out.
    arm: PathBuf,
    compiler: String,
    packages: Vec<String>,
}

impl Peer {
    pub(super) fn build(places: &BenchPlaces, cxx: Option<&str>) -> Result<Self, String> {
        let cxx = cxx.map_or_else(find_compiler, |name| Ok(name.to_owned()))?;
        let compiler = first_line(Command::new(&cxx).arg("--version"));
        if !compiler.contains("clang") {
            println!("note: {compiler} builds a slower Pinocchio than clang does: a softer bar");
        }
        let python = environment(places)?;
        let arms = export_arms(places, &python)?;
        let program = compile(places, &python, &cxx, &compiler)?;
        let text = read(&places.sources().join("requirements.txt"))?;
        let packages = text.lines().filter(|l| l.contains("==")).map(str::to_owned).collect();
        let script = places.sources().join("mujoco_rollout.py");
        let arm = places.root.join("crates/phihat-model/robots/panda.urdf");
        Ok(Self { program, arms, python, script, arm, compiler, packages })
    }

    pub(super) fn command(&self, quick: bool) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(&self.arms).arg(if quick { "31" } else { "301" });
        command
    }

    /// MuJoCo's rollouts of many arms, on one thread.
    pub(super) fn rollouts(&self, quick: bool) -> Command {
        let mut command = Command::new(&self.python);
        command.arg(&self.script).arg(&self.arm).arg(if quick { "0" } else { "3" });
        command
    }

    pub(super) fn text(&self) -> String {
        let flags = FLAGS[..4].join(" ");
        format!("peers      {}; {}, {flags}\n", self.packages.join(", "), self.compiler)
    }

    pub(super) fn json(&self) -> Value {
        json!({ "packages": self.packages, "compiler": self.compiler, "flags": FLAGS })
    }
}

/// The newest clang there is, else a freshly installed one, else g++.
fn find_compiler() -> Result<String, String> {
    let runs = |name: &String| Command::new(name).arg("--version").output().is_ok();
    let clangs = (15..40).rev().map(|n| format!("clang++-{n}")).chain(["clang++".to_owned()]);
    if let Some(found) = clangs.clone().find(runs) {
        return Ok(found);
    }
    println!("no clang here: trying `apt-get install {CLANG_PACKAGE}`");
    let install = ["install", "--yes", "--no-install-recommends", CLANG_PACKAGE];
    if let Err(why) = output(Command::new("apt-get").args(install)) {
        println!("that failed ({why})");
    }
    clangs.chain(["g++".to_owned()]).find(runs).ok_or("no C++ compiler: install clang".into())
}

/// A virtual environment with the pinned wheels; its Python.
fn environment(places: &BenchPlaces) -> Result<PathBuf, String> {
    let folder = places.output.join("venv");
    let python = folder.join("bin/python");
    let wanted = places.sources().join("requirements.txt");
    let stamp = folder.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|text| Ok(text) == read(&wanted)) {
        return Ok(python);
    }
    println!("making {} with the wheels of {}", folder.display(), wanted.display());
    output(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder))?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"];
    output(Command::new(&python).args(install).arg(&wanted))?;
    write(&stamp, &read(&wanted)?)?;
    Ok(python)
}

fn export_arms(places: &BenchPlaces, python: &Path) -> Result<PathBuf, String> {
    let text = output(
        Command::new(python)
            .arg(places.sources().join("export_arms.py"))
            .arg(places.root.join("crates/phihat-model/robots"))
            .arg(places.root.join("crates/phihat-model/tests/oracle"))
            .args(ARMS),
    )?;
    let file = places.output.join("arms.txt");
    write(&file, &text)?;
    Ok(file)
}

/// Compiles, unless the same text, headers, flags and compiler were compiled before.
fn compile(
    places: &BenchPlaces,
    python: &Path,
    cxx: &str,
    compiler: &str,
) -> Result<PathBuf, String> {
    let (program, stamp) = (places.output.join("pinocchio"), places.output.join("pinocchio.txt"));
    let source = places.sources().join("pinocchio.cpp");
    let headers = read(&places.sources().join("requirements.txt"))?;
    let key = format!("{compiler}\n{FLAGS:?}\n{headers}\n{}", read(&source)?);
    if program.exists() && fs::read_to_string(&stamp).is_ok_and(|text| text == key) {
        return Ok(program);
    }
    println!("compiling {} with {compiler}: takes minutes", source.display());
    let site = "import sysconfig; print(sysconfig.get_paths()['purelib'])";
    let site = output(Command::new(python).args(["-c", site]))?;
    let include = Path::new(site.trim()).join("cmeel.prefix/include");
    let mut command = Command::new(cxx);
    command.args(FLAGS).arg(source).arg("-o").arg(&program);
    command.arg("-isystem").arg(&include).arg("-isystem").arg(include.join("eigen3"));
    output(&mut command)?;
    write(&stamp, &key)?;
    Ok(program)
}

fn read(file: &Path) -> Result<String, String> {
    fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))
}
