//! phihat outside of Rust: C and C++ programs compiled, run, and watched by sanitizers and valgrind; the Python
//! package built, installed, and tested, with the book's Python.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::command;
use crate::{book, programs, tools, venv};

/// Compiler flags of every C and C++ program here.
const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-g"];

/// Programs: source, and whether it takes the test vectors.
const PROGRAMS: [(&str, bool); 4] = [
    ("crates/phihat-c/tests/vectors.c", true),
    ("examples/c/01_controller.c", false),
    ("examples/c/02_supervisor.c", false),
    ("examples/c/03_positions.c", false),
];

/// Builds the library, then every program as C99, as C++17 and under sanitizers, and runs them.
pub(crate) fn c(root: &Path) -> Result<(), String> {
    let target = root.join("target/c");
    // For any processor: valgrind does not know the newest instructions. And so the vectors also show
    // that these do not change a bit.
    let status = Command::new("cargo")
        .args(["build", "--quiet", "--package", "phihat-c"])
        .env("CARGO_TARGET_DIR", &target)
        .env("RUSTFLAGS", "")
        .current_dir(root)
        .status()
        .map_err(|e| e.to_string())?;
    if !status.success() {
        return Err("the C library does not build".to_owned());
    }
    tools::from_debian(root, "valgrind", &["valgrind"])?;
    let library = target.join("debug/libphihat_c.a").display().to_string();
    for (source, with_vectors) in PROGRAMS {
        let vectors = ["crates/phihat/tests/vectors/controller.txt"];
        let arguments = if with_vectors { &vectors[..] } else { &[] };
        let build = |name: &str, compiler: &[&str]| {
            let program = target.join(name).display().to_string();
            let mut all = compiler.to_vec();
            all.extend(WARNINGS);
            all.extend(["-Icrates/phihat-c/include", source, "-x", "none", &library]);
            all.extend(["-lm", "-lpthread", "-ldl", "-o", &program]);
            command(root, all[0], &all[1..]).map(|()| program)
        };
        let plain = build("c99", &["cc", "-std=c99", "-x", "c"])?;
        let cpp = build("cpp17", &["c++", "-std=c++17", "-x", "c++"])?;
        let watched =
            build("watched", &["cc", "-std=c99", "-fsanitize=address,undefined", "-x", "c"])?;
        for program in [&plain, &cpp, &watched] {
            command(root, program, arguments)?;
        }
        let valgrind =
            ["--quiet", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all"];
        command(root, "valgrind", &[&valgrind[..], &[&plain], arguments].concat())?;
    }
    ros2(root, &library)
}

/// The ros2_control plugin, compiled against stand-ins for the headers of two releases, on records of the
/// Rust supervisor.
fn ros2(root: &Path, library: &str) -> Result<(), String> {
    let records = root.join("target/ros2").display().to_string();
    let status = Command::new("cargo")
        .args(["run", "--quiet", "--package", "phihat", "--example", "ros2_record", "--", &records])
        .env("CARGO_TARGET_DIR", root.join("target/c"))
        .env("RUSTFLAGS", "")
        .current_dir(root)
        .status()
        .map_err(|e| e.to_string())?;
    if !status.success() {
        return Err("what the plugin is held against cannot be made".to_owned());
    }
    let build = |release: &str| {
        let program = root.join("target/c").join(release).display().to_string();
        let (define, package) =
            (format!("-DPHIHAT_DOUBLE_{release}"), "examples/ros2/phihat_controller");
        let mut all = vec!["-std=c++17", &define, "-Iexamples/ros2/doubles"];
        all.extend(WARNINGS);
        let include = format!("-I{package}/include");
        all.extend(["-Icrates/phihat-c/include", &include, "examples/ros2/test/plugin.cpp"]);
        let sources = ["gains_file", "json", "phihat_controller"]
            .map(|name| format!("{package}/src/{name}.cpp"));
        all.extend(sources.iter().map(String::as_str));
        all.extend([library, "-lm", "-lpthread", "-ldl", "-o", &program]);
        command(root, "c++", &all).map(|()| program)
    };
    // Side by side: headers of the standard library are most of the time.
    let programs = std::thread::scope(|scope| {
        let both = ["HUMBLE", "JAZZY"].map(|release| scope.spawn(move || build(release)));
        both.map(|one| one.join().map_err(|_| "a compiler's thread ended".to_owned()))
    });
    for program in programs {
        command(root, &program??, &[&records])?;
    }
    Ok(())
}

/// Checks types, tests, examples and the book's Python on the package as the gate's build left it; the wheel
/// is tried by `--all`.
pub(crate) fn python(root: &Path) -> Result<(), String> {
    python_with(root, None)
}

/// An example that takes half a minute, which the gate leaves to `--all`: it has the same in Rust.
const LONG_EXAMPLE: &str = "04_design.py";

/// The same with every arm that the tests know, and every example.
pub(crate) fn python_all(root: &Path) -> Result<(), String> {
    python_with(root, Some(("PHIHAT_ALL", "1")))
}

fn python_with(root: &Path, more: Option<(&str, &str)>) -> Result<(), String> {
    let python = environment(root)?;
    let place = package(root)?;
    let folder = root.join("crates/phihat-py");
    let logs = logs(root)?;
    let arms = tools::folder()?.join("arms");
    let program = programs::program(root, "phihat-cli/phihat")?;
    let with_package = |arguments: &[&str], folder: &Path| {
        let status = Command::new(&python)
            .args(arguments)
            .env("PYTHONPATH", &place)
            .env("MYPYPATH", &place)
            .env("PHIHAT_LOGS", &logs)
            .env("PHIHAT_PROGRAM", &program)
            .env("PHIHAT_ARMS", &arms)
            .envs(more)
            .current_dir(folder)
            .status()
            .map_err(|e| format!("{python}: {e}"))?;
        if status.success() {
            Ok(())
        } else {
            Err(format!("python {}: {status}", arguments.join(" ")))
        }
    };
    with_package(&["-m", "mypy", "--strict", "--no-error-summary", "python", "tests"], &folder)?;
    with_package(&["-m", "mypy.stubtest", "phihat._phihat"], &folder)?;
    with_package(&["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "tests"], &folder)?;
    for example in files(&root.join("examples/python"), "py")? {
        if more.is_none() && example.ends_with(LONG_EXAMPLE) {
            continue;
        }
        println!("{example}");
        with_package(&[&example], root)?;
    }
    book::python(root, &python, &place)
}

/// The package in a folder of its own: its Python, and the library that the gate's build left.
fn package(root: &Path) -> Result<PathBuf, String> {
    let place = root.join("target/python-package");
    let inside = place.join("phihat");
    let failed = |e: std::io::Error| format!("{}: {e}", inside.display());
    if place.exists() {
        fs::remove_dir_all(&place).map_err(failed)?;
    }
    book::copy(&root.join("crates/phihat-py/python/phihat"), &inside)?;
    fs::copy(programs::program(root, "phihat-py/_phihat")?, inside.join("_phihat.abi3.so"))
        .map_err(failed)?;
    Ok(place)
}

/// Builds the wheel and puts it into an environment, which has maturin.
pub(crate) fn install(root: &Path, python: &str) -> Result<(), String> {
    let wheels = root.join("target/wheels");
    if wheels.exists() {
        fs::remove_dir_all(&wheels).map_err(|e| e.to_string())?;
    }
    // For this machine, as the command was just built: a wheel for others is built with `RUSTFLAGS=""`, which
    // changes no bit.
    let build = ["-m", "maturin", "build", "--release", "--quiet", "--out"];
    let status = Command::new(python)
        .args(build)
        .arg(&wheels)
        .args(["--interpreter", python])
        .current_dir(root.join("crates/phihat-py"))
        .status()
        .map_err(|e| e.to_string())?;
    if !status.success() {
        return Err("the wheel does not build".to_owned());
    }
    let found = files(&wheels, "whl")?;
    let wheel = found.first().ok_or("maturin left no wheel")?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    let over = ["--force-reinstall", "--no-deps", wheel];
    command(root, python, &[&install[..], &over].concat())
}

/// Studies whose logs other people's readers look at: one without a supervisor, and one with.
const LOGGED: [&str; 2] = ["first", "estop_restart"];

/// Runs of studies, with their logs, in a folder.
fn logs(root: &Path) -> Result<PathBuf, String> {
    let folder = root.join("target/logs");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|e| e.to_string())?;
    }
    for name in LOGGED {
        let study = format!("studies/{name}.toml");
        let out = folder.join(name).display().to_string();
        let log = folder.join(format!("{name}.mcap")).display().to_string();
        let program = programs::program(root, "phihat-session/log")?.display().to_string();
        command(root, &program, &[&study, &out, &log])?;
    }
    Ok(folder)
}

/// Python with all that the tests need, among the tools; made again when the list changes.
pub(crate) fn environment(root: &Path) -> Result<String, String> {
    let list = root.join("crates/phihat-py/tests/requirements.txt");
    venv::of_list(root, &tools::folder()?.join("python"), &list)
}

/// Files of a folder with an extension, sorted.
fn files(folder: &Path, extension: &str) -> Result<Vec<String>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths = entries.filter_map(|entry| entry.ok().map(|e| e.path()));
    let mut found: Vec<String> = paths
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| path.display().to_string())
        .collect();
    found.sort();
    Ok(found)
}
