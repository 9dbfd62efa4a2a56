//! `cargo xtask web`: the module and the page for a browser in `target/web/page`, and the book with them in
//! `target/web/book`, tried in headless Chromium.
//!
//! The module is built for `wasm32-unknown-unknown`. Where the toolchain at hand has that target, it is used; else, on
//! Debian, a compiler with the source of its standard library is unpacked into `target/web/root`, and nothing is
//! installed.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{command, read, run as run_command, write};
use crate::{book, browser, live_book, programs};

const TARGET: &str = "wasm32-unknown-unknown";

/// Packages of Debian: a compiler that knows the target, what it is linked to, and the source of the standard library.
const PACKAGES: [&str; 3] = ["rustc-web", "libstd-rust-web-dev", "rust-web-src"];

/// Studies that the page begins with and those of the book's pictures, their gains designed beside them.
const STUDIES: [&str; 5] = ["panda", "first", "franka_any", "panda_design", "estop_restart"];

/// Largest size of all that a visitor loads before the first run, with brotli \[bytes\].
const SIZE_MAX: u64 = 2_000_000;

/// Builds module and page, prints their sizes, and tries them; `--only-build` stops before that, and `--every-study`
/// compares the studies whose design takes minutes in a browser too.
pub(crate) fn run(root: &Path, words: &[String]) -> Result<(), String> {
    let word = match words {
        [] => "",
        [word] if ["--only-build", "--every-study"].contains(&word.as_str()) => word,
        _ => return Err("cargo xtask web [--only-build | --every-study]".to_owned()),
    };
    let folder = root.join("target/web");
    let page = folder.join("page");
    fs::create_dir_all(page.join("studies")).map_err(|e| format!("{}: {e}", page.display()))?;
    let module = module(root, &folder)?;
    bindings(root, &folder, &module, &page)?;
    parts(root, &page)?;
    studies(root, &page)?;
    sizes(root, &page)?;
    let together = live_book::put_together(root, &page, &STUDIES)?;
    if word == "--only-build" {
        return Ok(());
    }
    tried(root, (&page, &together), word == "--every-study")
}

/// The module, built with the target that the toolchain has, else with Debian's compiler.
fn module(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let build = folder.join("build");
    let mut cargo = Command::new("cargo");
    cargo.args(["rustc", "--profile", "web", "--target", TARGET, "--package", "phihat-web"]);
    cargo.args(["--lib", "--crate-type", "cdylib", "--target-dir"]).arg(&build);
    // Flags of `.cargo/config.toml` are for the processor at hand.
    cargo
        .current_dir(root)
        .env("RUSTFLAGS", "-C target-feature=+simd128")
        .env_remove("RUSTC_WORKSPACE_WRAPPER");
    if !has_target()? {
        with_debians_compiler(root, folder, &mut cargo)?;
    }
    run_command(&mut cargo)?;
    Ok(build.join(TARGET).join("web/phihat_web.wasm"))
}

/// Checks that the crate compiles for a browser, where a compiler that knows this target is at hand.
pub(crate) fn checked(root: &Path) -> Result<(), String> {
    let folder = root.join("target/web");
    let unpacked = folder.join("root").exists();
    if !has_target()? && !unpacked {
        println!("no {TARGET} here (`rustup target add {TARGET}` adds it): left out");
        return Ok(());
    }
    let mut cargo = Command::new("cargo");
    cargo.args(["check", "--target", TARGET, "--package", "phihat-web", "--lib", "--quiet"]);
    cargo.arg("--target-dir").arg(folder.join("check"));
    cargo.current_dir(root).env("RUSTFLAGS", "-Dwarnings").env_remove("RUSTC_WORKSPACE_WRAPPER");
    if !has_target()? {
        with_debians_compiler(root, &folder, &mut cargo)?;
    }
    run_command(&mut cargo)
}

/// True where the toolchain at hand has the browser's target.
fn has_target() -> Result<bool, String> {
    Ok(sysroot()?.join("lib/rustlib").join(TARGET).is_dir())
}

/// The folder of the toolchain at hand.
fn sysroot() -> Result<PathBuf, String> {
    let output = Command::new("rustc").args(["--print", "sysroot"]).output();
    let output = output.map_err(|e| format!("rustc: {e}"))?;
    Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

/// Makes a build use a compiler in `target/web/root`, which builds the standard library too.
fn with_debians_compiler(root: &Path, folder: &Path, cargo: &mut Command) -> Result<(), String> {
    let own = folder.join("root");
    let compiler = own.join("usr/bin/rustc");
    if !own.exists() {
        // Whole or absent: unpacked beside its place.
        let partial = folder.join("root.partial");
        if partial.exists() {
            fs::remove_dir_all(&partial).map_err(|e| format!("{}: {e}", partial.display()))?;
        }
        unpack(root, folder, &partial)?;
        fs::rename(&partial, &own).map_err(|e| format!("{}: {e}", own.display()))?;
    }
    let host = host()?;
    let lld = sysroot()?.join("lib/rustlib").join(&host).join("bin/rust-lld");
    let libraries = own.join("usr/lib").join(host.replace("-unknown", ""));
    cargo
        .args(["-Zbuild-std=std,panic_abort"])
        .env("RUSTC", compiler)
        .env("RUSTC_BOOTSTRAP", "1")
        .env("LD_LIBRARY_PATH", libraries)
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", lld);
    Ok(())
}

/// The machine of the toolchain at hand.
fn host() -> Result<String, String> {
    let output = Command::new("rustc").arg("-vV").output().map_err(|e| format!("rustc: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or("rustc names no host".to_owned())
}

/// Debian's packages, unpacked into a folder of their own.
fn unpack(root: &Path, folder: &Path, own: &Path) -> Result<(), String> {
    println!(
        "no {TARGET} here (`rustup target add {TARGET}` adds it): unpacking Debian's compiler into target/web/root"
    );
    let packed = folder.join("deb");
    fs::create_dir_all(&packed).map_err(|e| format!("{}: {e}", packed.display()))?;
    command(root, "apt-get", &["update", "-qq"])?;
    let needs = |package: &str| -> Result<Vec<String>, String> {
        let output = Command::new("apt-cache").args(["depends", "-i", package]).output();
        let output = output.map_err(|e| format!("apt-cache: {e}"))?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let names = text.lines().filter_map(|line| line.trim().strip_prefix("Depends: "));
        let own = ["libstd-rust-web", "libllvm"];
        Ok(names
            .filter(|name| own.iter().any(|o| name.starts_with(o)))
            .map(str::to_owned)
            .collect())
    };
    let mut all: Vec<String> = PACKAGES.iter().map(|&name| name.to_owned()).collect();
    let mut next = 0;
    while next < all.len() {
        let more = needs(&all[next])?;
        for name in more {
            if !all.contains(&name) {
                all.push(name);
            }
        }
        next += 1;
    }
    let words: Vec<&str> =
        ["download", "-qq"].into_iter().chain(all.iter().map(|s| &**s)).collect();
    command(&packed, "apt-get", &words)?;
    for entry in fs::read_dir(&packed).map_err(|e| e.to_string())?.flatten() {
        let (package, to) = (entry.path().display().to_string(), own.display().to_string());
        command(root, "dpkg-deb", &["-x", &package, &to])?;
    }
    fs::remove_dir_all(&packed).map_err(|e| format!("{}: {e}", packed.display()))?;
    // Where cargo looks for the source of the standard library; newer packages bring the link themselves.
    let place = own.join("usr/lib/rustlib/src/rust");
    if place.join("library").exists() {
        return Ok(());
    }
    fs::create_dir_all(&place).map_err(|e| format!("{}: {e}", place.display()))?;
    let source = fs::read_dir(own.join("usr/src")).map_err(|e| e.to_string())?.flatten().next();
    let source = source.ok_or("rust-web-src holds no source")?.path().join("library");
    let inside = source.strip_prefix(own).unwrap_or(&source);
    std::os::unix::fs::symlink(Path::new("../../../../..").join(inside), place.join("library"))
        .map_err(|e| e.to_string())
}

/// JavaScript for the module, by a program of the same version as the module's macros.
fn bindings(root: &Path, folder: &Path, module: &Path, page: &Path) -> Result<(), String> {
    let build = folder.join("bindgen");
    let mut cargo = Command::new("cargo");
    cargo.args(["build", "--release", "--quiet", "--manifest-path", "tools/bindgen/Cargo.toml"]);
    cargo.arg("--target-dir").arg(&build).current_dir(root).env_remove("RUSTC_WORKSPACE_WRAPPER");
    run_command(&mut cargo)?;
    let words: [OsString; 2] = [module.into(), page.into()];
    run_command(Command::new(build.join("release/bindgen")).args(words))
}

/// The page's own files, and those that it shares with all pages.
fn parts(root: &Path, page: &Path) -> Result<(), String> {
    let own = root.join("crates/phihat-web/page");
    let mut files: Vec<PathBuf> = fs::read_dir(&own)
        .map_err(|e| format!("{}: {e}", own.display()))?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .collect();
    let shared = root.join("crates/phihat-report/assets");
    files.extend(["page.css", "arm.js"].map(|name| shared.join(name)));
    for file in files {
        let to = page.join(file.file_name().unwrap_or_default());
        fs::copy(&file, to).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(())
}

/// The studies that the page begins with, and their gains.
fn studies(root: &Path, page: &Path) -> Result<(), String> {
    programs::note(root)?;
    let program = programs::program(root, "phihat-cli/phihat")?.display().to_string();
    for name in STUDIES {
        let study = format!("studies/{name}.toml");
        let out = page.join(format!("studies/{name}.gains.json")).display().to_string();
        let status = Command::new(&program)
            .args(["design", &study, "--out", &out, "--quiet"])
            .current_dir(root)
            .status()
            .map_err(|e| format!("{program}: {e}"))?;
        // 3: gains that are not proved to keep the specification, as those of a run with a stop.
        if !matches!(status.code(), Some(0 | 3)) {
            return Err(format!("{study}: design: {status}"));
        }
        write(&page.join(&study), &read(&root.join(&study))?)?;
    }
    Ok(())
}

/// Prints what a visitor loads, plain and with brotli.
fn sizes(root: &Path, page: &Path) -> Result<(), String> {
    let script = "const fs = require('fs'), { brotliCompressSync } = require('zlib');
        const files = fs.readdirSync('.').filter((file) => file.includes('.'));
        let sum = 0;
        for (const file of [...files, 'studies/panda.toml', 'studies/panda.gains.json']) {
          const bytes = fs.readFileSync(file), small = brotliCompressSync(bytes).length;
          sum += small;
          console.error(`${String(bytes.length).padStart(9)} ${String(small).padStart(8)}  ${file}`);
        }
        console.log(sum);";
    let output = Command::new("node").args(["-e", script]).current_dir(page).output();
    let output = output.map_err(|e| format!("node: {e}"))?;
    print!("    bytes   brotli  file\n{}", String::from_utf8_lossy(&output.stderr));
    let sum = String::from_utf8_lossy(&output.stdout).trim().parse::<u64>();
    let sum = sum.map_err(|_| format!("sizes of {}: {}", root.display(), output.status))?;
    println!("{sum} bytes with brotli until the first run");
    if sum > SIZE_MAX { Err(format!("more than {SIZE_MAX} bytes")) } else { Ok(()) }
}

/// The page in Chromium, its runs and gains beside those of the command line.
fn tried(root: &Path, (page, together): (&Path, &Path), every_study: bool) -> Result<(), String> {
    let folder = browser::tools(root)?;
    let native = programs::program(root, "phihat-web/answer")?.display().to_string();
    let [page, together, studies] = [page.to_owned(), together.to_owned(), root.join("studies")]
        .map(|p| p.display().to_string());
    command(&folder, "node", &["web.mjs", &page, &native, &studies])?;
    command(&folder, "node", &["careless.mjs", &page, &studies])?;
    let every: &[&str] = if every_study { &["--every"] } else { &[] };
    command(&folder, "node", &[&["same.mjs", &page, &native, &studies], every].concat())?;
    let plain = root.join(book::HTML).display().to_string();
    command(&folder, "node", &["live.mjs", &together, &plain])
}
