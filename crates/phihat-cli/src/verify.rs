//! `phihat verify`: every claim about a set of gains, checked again.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use phihat_certificate::tube::{JointBeside, Reference};
use phihat_certificate::{Certificate, Refutation, TubeAgain};
use phihat_design::{Gains, Statement, Verified};
use phihat_sim::Motion;
use phihat_study::Study;
use serde_json::json;

use crate::failure::Failure;
use crate::kept::{Kept, TRACE};
use crate::worlds::Kept as Runs;
use crate::{files, knowledge, table, worlds};

/// Check every claim of a certificate again, from the gains alone.
///
/// Needs nothing but the file: no solver's word. What the file cannot show of itself is listed as taken on trust; with a
/// study, that is derived again as far as it can be. With --run the gains and the study are those of a run's record, whose
/// files have to be those that the run left, and whose figures have to follow from its trace.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 1: a claim does not hold; the inequality that fails is told.\n\n\
                        Example (after `phihat design studies/panda_design.toml`):\n  \
                        phihat verify out/panda_design/gains.json\n\n\
                        Example (after `phihat run studies/first.toml`):\n  \
                        phihat verify --run out/first"
)]
pub(crate) struct Verify {
    /// The gains document (JSON).
    #[arg(required_unless_present = "run", conflicts_with = "run")]
    gains: Option<PathBuf>,
    /// Derive again from this study what the file alone has to be trusted for.
    #[arg(long, value_name = "STUDY", conflicts_with = "run")]
    study: Option<PathBuf>,
    /// Check the record of a run: its files, its figures, and its gains against its study.
    #[arg(long, value_name = "FOLDER")]
    run: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let Subject { gains, study, record } = self.subject()?;
        let Some(certificate) = &gains.certificate else {
            let Some(words) = record else {
                let path = self.gains.as_deref().unwrap_or(Path::new(""));
                return Err(Failure::at(path, "these gains carry no certificate"));
            };
            if self.json {
                println!("{:#}", json!({ "holds": true, "refuted": null, "record": words }));
            } else {
                println!(
                    "RECORD\n  {words}\nits gains carry no certificate: nothing is claimed about them"
                );
            }
            return Ok(ExitCode::SUCCESS);
        };
        let mut runs = None;
        let answer = match (certificate.verified(&gains), &study) {
            (Ok(verified), Some(study)) => {
                again(verified, &gains, certificate, study)?.map(|(verified, kept)| {
                    runs = kept;
                    verified
                })
            }
            (answer, _) => answer,
        };
        if self.json {
            let holds = answer.is_ok();
            let document = match &answer {
                Ok(verified) => {
                    json!({ "holds": holds, "refuted": null, "verified": verified, "runs": runs, "record": record })
                }
                Err(why) => json!({ "holds": holds, "refuted": why, "record": record }),
            };
            println!("{document:#}");
        } else {
            if let Some(words) = &record {
                println!("RECORD\n  {words}");
            }
            match &answer {
                Ok(verified) => println!("{}", blocks(verified, runs.as_ref())),
                Err(why) => println!("REFUSED: {why}"),
            }
        }
        Ok(if answer.is_ok() { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}

/// What is to be checked.
struct Subject {
    gains: Gains,
    study: Option<Box<Study>>,
    /// What was found of the record that they are from.
    record: Option<String>,
}

impl Verify {
    fn subject(&self) -> Result<Subject, Failure> {
        if let Some(folder) = &self.run {
            let kept = Kept::read(&folder.join(TRACE))?;
            kept.figures_hold(folder)?;
            if let Some(tube) = kept.seen.tube.as_ref().filter(|tube| tube.broken().is_some()) {
                return Err(Failure::at(&folder.join(TRACE), tube.sentence()).infeasible());
            }
            let own = kept.gains.study_sha256 == kept.study.sha256;
            let words = format!(
                "every file is the one that the run left, and its figures follow from its trace: {}",
                table::verdict(&kept.seen.metrics, None)
            );
            let study = own.then_some(kept.study);
            return Ok(Subject { gains: kept.gains, study, record: Some(words) });
        }
        let path = self.gains.as_deref().unwrap_or(Path::new(""));
        let gains = Gains::from_json(&files::read(path)?).map_err(|e| Failure::at(path, e))?;
        let study = self.study.as_deref().map(knowledge::read).transpose()?;
        Ok(Subject { gains, study, record: None })
    }
}

/// Derives again from the study what the file has to be trusted for, and runs a few worlds of it.
fn again(
    mut verified: Verified,
    gains: &Gains,
    certificate: &Certificate,
    study: &Study,
) -> Result<Result<(Verified, Option<Runs>), Refutation>, Failure> {
    let checked = certificate.derive(gains, study).and_then(|derived| {
        verified.derived = derived;
        verified.tube = derived_tube(gains, certificate, study)?;
        Ok(verified)
    });
    let verified = match checked {
        Ok(verified) => verified,
        Err(why) => return Ok(Err(why)),
    };
    let Some(tube) = &certificate.tube else { return Ok(Ok((verified, None))) };
    let bar = spinner();
    let runs = worlds::runs(study, gains, tube, &|done| {
        bar.set_message(format!("worlds of the study: {done} of {} run", worlds::WORLDS));
        bar.tick();
    });
    bar.finish_and_clear();
    Ok(runs?.map(|kept| (verified, Some(kept))))
}

fn derived_tube(
    gains: &Gains,
    certificate: &Certificate,
    study: &Study,
) -> Result<Option<TubeAgain>, Refutation> {
    let Ok(motion) = Motion::new(&study.reference, &study.robot, study.duration) else {
        return Ok(None);
    };
    let n = study.robot.joints.len();
    let reference = Reference::of(study, |t| (0..n).map(|i| motion.at(i, t)).collect());
    let bar = spinner();
    let told = certificate.derive_tube(gains, (study, &reference), &|share| {
        bar.set_message(format!("tube, second derivation: {:.0} %", 100.0 * share));
        bar.tick();
    });
    bar.finish_and_clear();
    told
}

fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} · {elapsed}") {
        bar.set_style(style);
    }
    bar
}

/// The three blocks, and what a study says of the second.
fn blocks(verified: &Verified, runs: Option<&Runs>) -> String {
    let line = |one: &Statement| {
        let joint = one.joint.as_ref().map_or_else(String::new, |joint| format!("{joint}: "));
        format!("  {joint}{}: {}", one.what, one.value)
    };
    let block = |title: &str, lines: Vec<String>| {
        let lines = if lines.is_empty() { vec!["  nothing".to_owned()] } else { lines };
        format!("{title}\n{}", lines.join("\n"))
    };
    let mut blocks = vec![
        block("PROVED FROM THIS FILE", verified.proved.iter().map(line).collect()),
        block("TAKEN ON TRUST", verified.trusted.iter().map(line).collect()),
    ];
    if !verified.derived.is_empty() {
        blocks
            .push(block("OF THAT, AGAINST THE STUDY", verified.derived.iter().map(line).collect()));
    }
    if let Some(tube) = &verified.tube {
        blocks.push(block("THE TUBE, BY A SECOND DERIVATION", again_lines(tube, runs)));
    }
    let left = table::not_counted(&verified.not_counted);
    let left = left.into_iter().map(|one| format!("  {one}")).collect();
    blocks.push(block("NOT COUNTED", left));
    blocks.push("every claim holds".to_owned());
    blocks.join("\n")
}

/// What the second derivation and the drawn worlds say of the tube.
fn again_lines(tube: &TubeAgain, runs: Option<&Runs>) -> Vec<String> {
    let joint = |own: &JointBeside| {
        let ends = [own.error_max_rad, own.derived_error_max_rad].map(|e| 1e3 * e);
        let rest = if own.confirmed() {
            String::new()
        } else {
            format!(
                "; up to {:.1} times tighter: there it rests on the first derivation only",
                own.tighter
            )
        };
        format!("  {}: |e| ≤ {:.4} mrad claimed, {:.4} derived{rest}", own.name, ends[0], ends[1])
    };
    let mut lines: Vec<String> = tube.joints.iter().map(joint).collect();
    lines.extend(tube.on_trust.iter().map(|why| {
        format!("  the tube is on trust: it could not be derived a second time, {why}")
    }));
    lines.extend(
        tube.first_only.iter().map(|clause| {
            format!("  {clause}; that it is kept rests on the first derivation only")
        }),
    );
    lines.extend(runs.map(|kept| {
        format!("  {} worlds drawn from the study's scope were run: none left the tube", kept.runs)
    }));
    lines
}
