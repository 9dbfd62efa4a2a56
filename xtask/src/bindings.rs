//! The controller outside of Rust: C and C++ programs compiled, run, and watched by sanitizers and valgrind.

use std::path::Path;
use std::process::Command;

use crate::test::command;

/// What every C and C++ program here is compiled with.
const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-g"];

/// Programs: source, and whether it takes the test vectors.
const PROGRAMS: [(&str, bool); 2] =
    [("crates/phihat-c/tests/vectors.c", true), ("examples/c/01_controller.c", false)];

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
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("installing valgrind");
        command(root, "apt-get", &["update", "-qq"])?;
        command(root, "apt-get", &["install", "-y", "-qq", "valgrind"])?;
    }
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
    Ok(())
}
