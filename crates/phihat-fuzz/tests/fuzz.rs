//! Every target against its seeds, and against documents made of them; see `.cargo/config.toml` for how many.
//!
//! `cargo xtask fuzz MINUTES` draws other recipes for longer. What breaks a target is kept in `corpus/`.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]
#![allow(clippy::disallowed_methods, reason = "a reader must not take long either")]

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

use phihat_fuzz::{kept, mutated, seeds};

/// Nothing that is this small may take longer.
const SLOWEST: Duration = Duration::from_secs(10);

fn tried(name: &str, target: fn(&[u8]), bytes: &[u8]) {
    let began = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| target(bytes)));
    let slow = began.elapsed() > SLOWEST;
    if outcome.is_err() || slow {
        let sum: u64 = bytes.iter().fold(14_695_981_039_346_656_037, |sum, byte| {
            (sum ^ u64::from(*byte)).wrapping_mul(1_099_511_628_211)
        });
        fs::create_dir_all(kept(name)).unwrap();
        fs::write(kept(name).join(format!("{sum:016x}")), bytes).unwrap();
    }
    if let Err(why) = outcome {
        resume_unwind(why);
    }
    assert!(!slow, "{name}: {} bytes take {:?}", bytes.len(), began.elapsed());
}

macro_rules! target {
    ($name:ident, $folder:literal, $ending:literal) => {
        #[test]
        fn $name() {
            let seeds = seeds(stringify!($name), $folder, $ending);
            for seed in &seeds {
                tried(stringify!($name), phihat_fuzz::$name, seed);
            }
            bolero::check!().with_max_len(96).for_each(|recipe: &[u8]| {
                tried(stringify!($name), phihat_fuzz::$name, &mutated(&seeds, recipe));
            });
        }
    };
    ($name:ident) => {
        #[test]
        fn $name() {
            for entry in fs::read_dir(kept(stringify!($name))).into_iter().flatten() {
                let bytes = fs::read(entry.unwrap().path()).unwrap();
                tried(stringify!($name), phihat_fuzz::$name, &bytes);
            }
            bolero::check!().with_max_len(512).for_each(|bytes: &[u8]| {
                tried(stringify!($name), phihat_fuzz::$name, bytes);
            });
        }
    };
}

target!(study, "studies", ".toml");
target!(robot_file, "robots", "r.toml");
target!(urdf, "robots", ".urdf");
target!(gains, "crates/phihat-certificate/tests/forged", ".json");
target!(trace, "crates/phihat-fuzz/corpus/trace", ".csv");
target!(journal, "crates/phihat-fuzz/corpus/journal", ".jsonl");
target!(reference_csv, "studies", ".csv");
target!(law);
target!(supervisor);
