//! The attack on certificates: `cargo xtask attack [N]`.
#![forbid(unsafe_code)]
#![allow(clippy::print_stderr, clippy::print_stdout, reason = "a command speaks to a terminal")]

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use phihat_attack::{
    AttackRecord, AttackSummary, ClassRuns, Forger, ForgerySummary, NoRun, Trial, class_run,
    hostile_run,
};
use phihat_campaign::{Journal, RunEnded, run_all};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Draws studies and tries to break what is certified about them.
#[derive(Debug, Parser)]
#[command(
    name = "attack",
    after_help = "Exit code 1: a run left what was claimed of it. Its study, gains and claim are kept in \
                  OUT/seed-S/NUMBER."
)]
struct AttackArguments {
    /// Number of studies.
    #[arg(default_value_t = 300)]
    count: u64,
    /// Seed of the random draws.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of the first study.
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Threads [default: one per processor].
    #[arg(long)]
    jobs: Option<usize>,
    /// Runs per study: extreme and drawn payloads and friction.
    #[arg(long, default_value_t = 6)]
    runs: usize,
    /// Share of the studies whose joints have laws from positions.
    #[arg(long, default_value_t = 0.4)]
    positions: f64,
    /// Share of these whose laws come from a search, which takes up to minutes; the others are typed.
    #[arg(long, default_value_t = 0.05)]
    searched: f64,
    /// Keep one among every so many studies; 0: none.
    #[arg(long, default_value_t = 20)]
    keep_every: u64,
    /// Of every so many studies, verify those certified with laws from positions against their study; 0: none.
    #[arg(long, default_value_t = 10)]
    derive_every: u64,
    /// Of every so many studies with typed laws, find and verify all that is claimed, 0: of none; of the
    /// others find the tube alone, which takes half of the time. Those of `--derive-every` are whole too.
    #[arg(long, default_value_t = 1)]
    whole_every: u64,
    /// Ask Pinocchio and MuJoCo about those, by this Python, which has both.
    #[arg(long, value_name = "PYTHON")]
    python: Option<PathBuf>,
    /// Write figures and records to a file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder of journal and broken studies.
    #[arg(long, default_value = "out/attack")]
    out: PathBuf,
    /// Begin again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Attack one class of motions in place of drawn studies: so many motions of this study, with its gains.
    #[arg(long, value_name = "STUDY", requires = "gains")]
    class: Option<PathBuf>,
    /// The gains of the class, with their certificate.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Edit a gains file in place of drawing studies: so many edits, each of which has to be refused or to say no more
    /// than the file did. Of those that a second derivation alone can refuse, one in `--derive-every` is derived again.
    #[arg(long, value_name = "STUDY", requires = "gains", conflicts_with = "class")]
    forge: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = AttackArguments::parse();
    let done = match (&arguments.class, &arguments.gains, &arguments.forge) {
        (Some(study), Some(gains), _) => attack_class(&arguments, study, gains),
        (_, Some(gains), Some(study)) => forge(&arguments, study, gains),
        _ => attack(&arguments),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::from(2)
        }
    }
}

/// Attacks one class of motions; returns true if no run left its bound.
fn attack_class(
    arguments: &AttackArguments,
    study: &Path,
    gains: &Path,
) -> Result<bool, Box<dyn Error>> {
    let study = phihat_session::read(study)?;
    let text = fs::read_to_string(gains).map_err(|e| format!("{}: {e}", gains.display()))?;
    let gains = phihat_design::Gains::from_json(&text)?;
    let bound = gains.certificate.as_ref().and_then(|all| all.class.as_deref());
    let bound = bound.ok_or("these gains have no class bound")?;
    let bar = ProgressBar::new(arguments.count);
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = arguments.jobs.unwrap_or_else(processors) as u64;
    let first = arguments.seed.wrapping_mul(1_000_003).wrapping_add(arguments.from);
    let (bar, study, gains) = (&bar, &study, &gains);
    let all: Result<Vec<ClassRuns>, NoRun> = std::thread::scope(|scope| {
        let work = |job: u64| {
            let mut found = ClassRuns::default();
            for k in (job..arguments.count).step_by(usize::try_from(jobs).unwrap_or(1)) {
                let seed = first.wrapping_add(k);
                // Where no supervisor is asked, signals are at their worst in every second run.
                found.and(&if bound.is_supervised() || (bound.signals.is_some() && k % 2 == 1) {
                    hostile_run(study, gains, bound, seed)?
                } else {
                    class_run(study, gains, bound, seed)?
                });
                bar.inc(1);
            }
            Ok(found)
        };
        let threads: Vec<_> = (0..jobs).map(|job| scope.spawn(move || work(job))).collect();
        threads
            .into_iter()
            .map(|one| one.join().unwrap_or_else(|why| std::panic::resume_unwind(why)))
            .collect()
    });
    bar.finish_and_clear();
    let mut found = ClassRuns::default();
    for part in all? {
        found.and(&part);
    }
    let [error, velocity, step, torque] = found.least();
    println!(
        "{} runs, {} outside; bound over measured at least {error:.2} (|e|), {velocity:.2} (|ė|), {step:.2} (|Δτ|), \
         {torque:.2} (|τ|)",
        found.runs, found.outside
    );
    if !found.broken.is_empty() {
        println!("seeds of the runs outside: {:?}", found.broken);
    }
    if let Some(path) = &arguments.json {
        let all = serde_json::json!({ "seed": arguments.seed, "class": found });
        fs::write(path, format!("{all:#}\n")).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(found.outside == 0)
}

/// Edits a gains file; returns true if no edit passed and said more than the file did.
fn forge(arguments: &AttackArguments, study: &Path, gains: &Path) -> Result<bool, Box<dyn Error>> {
    let study = phihat_session::read(study)?;
    let text = fs::read_to_string(gains).map_err(|e| format!("{}: {e}", gains.display()))?;
    let forger = Forger::new(&text, *study, arguments.seed, arguments.derive_every)?;
    let folder = arguments.out.join(format!("forged-{}", arguments.seed));
    let (seed, every) = (arguments.seed, arguments.derive_every);
    let file = fingerprint(text.as_bytes());
    let id = |index: u64| format!("{index} of {seed}, file {file:016x}, every {every} derived");
    let (records, panics) = saved(arguments, (&folder, "edit"), id, |index| forger.forge(index))?;
    let summary = ForgerySummary::of(gains, &forger, records, panics);
    println!("{summary}");
    if let Some(path) = &arguments.json {
        let all = serde_json::json!({ "seed": seed, "derive_every": every, "forged": summary });
        fs::write(path, format!("{all:#}\n")).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(summary.is_clean())
}

/// Attacks the studies; returns true if no claim was broken.
fn attack(arguments: &AttackArguments) -> Result<bool, Box<dyn Error>> {
    let folder = arguments.out.join(format!("seed-{}", arguments.seed));
    let AttackArguments {
        seed,
        runs,
        keep_every,
        derive_every,
        whole_every,
        positions,
        searched,
        ..
    } = *arguments;
    let python = arguments.python.as_deref();
    let trial = Trial {
        seed,
        positions,
        searched,
        runs,
        folder: &folder,
        keep_every,
        derive_every,
        whole_every,
        python,
    };
    let id = |index: u64| {
        format!(
            "{index} of {seed}, {runs} runs, {positions} by positions, {searched} searched, every {keep_every} asked \
                {}, every {derive_every} derived, every {whole_every} whole",
            python.is_some()
        )
    };
    let (records, panics) = saved(arguments, (&folder, "study"), id, |index| trial.attack(index))?;
    report(arguments, &records, panics, &folder)
}

/// Results of some work for each index that was asked for, and those at which it panicked. Each result is saved in the
/// folder as it comes, under a text that says what it depends on; the same command goes on from there.
fn saved<R: Serialize + DeserializeOwned + Send>(
    arguments: &AttackArguments,
    (folder, what): (&Path, &str),
    id: impl Fn(u64) -> String,
    work: impl Fn(u64) -> R + Sync,
) -> Result<(Vec<R>, Vec<String>), Box<dyn Error>> {
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let path = folder.join("journal.jsonl");
    let journal = if arguments.fresh { Journal::afresh(&path) } else { Journal::open(&path) };
    let (mut journal, program) = (journal?, program()?);
    let places: Vec<u64> = (arguments.from..arguments.from + arguments.count).collect();
    let ids: Vec<String> =
        places.iter().map(|index| format!("{}, program {program:016x}", id(*index))).collect();
    let bar = ProgressBar::new(arguments.count);
    if let Ok(style) = ProgressStyle::with_template(
        "attacking {wide_bar} {pos} of {len} · {elapsed} of about {duration}",
    ) {
        bar.set_style(style);
    }
    says_what_is_saved(&bar, &path);
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = arguments.jobs.unwrap_or_else(processors);
    let done = run_all(&ids, &mut journal, jobs, &|place: usize| work(places[place]), |progress| {
        bar.set_position(progress.done as u64);
    });
    bar.finish_and_clear();
    let (mut records, mut panics) = (Vec::new(), Vec::new());
    for (index, ended) in places.iter().zip(done?) {
        match ended {
            RunEnded::With(record) => records.push(record),
            RunEnded::Panicked(why) => panics.push(format!("{what} {index}: {why}")),
        }
    }
    Ok((records, panics))
}

fn report(
    arguments: &AttackArguments,
    records: &[AttackRecord],
    panics: Vec<String>,
    folder: &Path,
) -> Result<bool, Box<dyn Error>> {
    let summary = AttackSummary::of(records, panics);
    println!("{summary}");
    for record in records.iter().filter(|record| !record.violations.is_empty()) {
        let worst = record.violations.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio));
        if let Some(v) = worst {
            println!(
                "{}: {} of {} at {:.3} s, {:.3e}, claimed {:.3e} to {:.3e} (run {}; {})",
                folder.join(record.index.to_string()).display(),
                v.signal,
                v.joint,
                v.t_s,
                v.measured,
                v.claimed.0,
                v.claimed.1,
                v.run,
                record.tags.join(", ")
            );
        }
    }
    if let Some(path) = &arguments.json {
        let all =
            serde_json::json!({ "seed": arguments.seed, "summary": summary, "records": records });
        fs::write(path, format!("{all:#}\n")).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(summary.broken.is_empty() && summary.panics.is_empty())
}

/// A number that stands for this program: another build attacks other code, so what it did counts for itself.
fn program() -> Result<u64, Box<dyn Error>> {
    let path = std::env::current_exe()?;
    let bytes = fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(fingerprint(&bytes))
}

/// FNV-1a.
fn fingerprint(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

fn says_what_is_saved(bar: &ProgressBar, journal: &Path) {
    let (bar, journal) = (bar.clone(), journal.display().to_string());
    // Where the system takes no handler, Ctrl-C ends the program as it always does: the journal is whole all the same.
    let _ = ctrlc::set_handler(move || {
        bar.finish_and_clear();
        eprintln!(
            "interrupted: what is done is saved in {journal}; the same command goes on from there"
        );
        std::process::exit(130);
    });
}
