//! Every target against its seeds, and against documents made of them: the same in every run.
//!
//! `cargo xtask fuzz MINUTES` draws other recipes for longer. What breaks a target is kept in `corpus/`.

use std::fs;
use std::time::Duration;

use phihat_fuzz::{drawn, kept, mutated, overwritten, seeds};

/// Processor time that nothing of 128 kB may take, however long it waits for a processor: a hundred times
/// what the slowest takes. Work that is quadratic in its bytes takes more.
const SLOWEST: Duration = Duration::from_secs(2);

/// The same of a compressed file, which may unfold to much more than it is.
const SLOWEST_UNFOLDED: Duration = Duration::from_secs(10);

fn tried(name: &str, target: fn(&[u8]), bytes: &[u8]) {
    let began = processor_time();
    target(bytes);
    let took = processor_time().saturating_sub(began);
    let most = if name == "trace_parquet" { SLOWEST_UNFOLDED } else { SLOWEST };
    assert!(took < most, "{name}: {} bytes take {took:?}", bytes.len());
}

/// Processor time of this thread.
#[cfg(unix)]
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap())
}

/// Zero where the system gives no processor time: it is then not bounded.
#[cfg(not(unix))]
fn processor_time() -> Duration {
    Duration::ZERO
}

/// Draws bytes for a target, and keeps the shortest that breaks it.
fn many(name: &str, most: usize, target: fn(&[u8]), made: impl Fn(&[u8]) -> Vec<u8>) {
    let Err((why, bytes)) = drawn(most, |bytes| tried(name, target, &made(bytes))) else { return };
    let bytes = made(&bytes);
    let sum: u64 = bytes.iter().fold(14_695_981_039_346_656_037, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(1_099_511_628_211)
    });
    let path = kept(name).join(format!("{sum:016x}"));
    fs::create_dir_all(kept(name)).unwrap();
    fs::write(&path, bytes).unwrap();
    panic!("{}: {why}", path.display());
}

macro_rules! target {
    ($name:ident, $folder:literal, $ending:literal) => {
        #[test]
        fn $name() {
            let seeds = seeds(stringify!($name), $folder, $ending);
            for seed in &seeds {
                tried(stringify!($name), phihat_fuzz::$name, seed);
            }
            many(stringify!($name), 96, phihat_fuzz::$name, |recipe| mutated(&seeds, recipe));
        }
    };
    ($name:ident) => {
        #[test]
        fn $name() {
            for entry in fs::read_dir(kept(stringify!($name))).into_iter().flatten() {
                let bytes = fs::read(entry.unwrap().path()).unwrap();
                tried(stringify!($name), phihat_fuzz::$name, &bytes);
            }
            many(stringify!($name), 512, phihat_fuzz::$name, <[u8]>::to_vec);
        }
    };
}

/// A file that says where things are is soon refused once they have moved: bytes are changed in their places too.
#[test]
fn trace_parquet() {
    let (name, target) = ("trace_parquet", phihat_fuzz::trace_parquet);
    let seeds = seeds(name, "crates/phihat-fuzz/corpus/trace_parquet", ".parquet");
    for seed in &seeds {
        tried(name, target, seed);
    }
    many(name, 96, target, |recipe| mutated(&seeds, recipe));
    many(name, 24, target, |recipe| overwritten(&seeds, recipe));
}

target!(study, "studies", ".toml");
target!(robot_file, "robots", "r.toml");
target!(urdf, "robots", ".urdf");
target!(mjcf, "crates/phihat-model/tests/mjcf", ".xml");
target!(gains, "crates/phihat-certificate/tests/forged", ".json");
target!(trace, "crates/phihat-fuzz/corpus/trace", ".csv");
target!(journal, "crates/phihat-fuzz/corpus/journal", ".jsonl");
target!(reference_csv, "studies", ".csv");
target!(law);
target!(supervisor);
target!(fci);
