//! `phihat verify`: every claim about a set of gains, checked again.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use phihat_certificate::tube::JointBeside;
use phihat_certificate::{
    CheckedBound, ClassAgain, ClassPair, JointOfClass, TubeAgain, Verdict, Verified,
    VerifiedStatement,
};
use phihat_report::kit::unit_of;
use phihat_session::{Checked, Verification, VerifyStage, WORLDS, read, read_gains, verify};
use phihat_sim::Metrics;
use serde_json::json;

use crate::audit;
use crate::check::warn_of_renamed;
use crate::failure::Failure;
use crate::numbers::positive;
use crate::proving::timed_proof;
use crate::shown::{second_derivation, spinner};
use crate::table;

/// Exit code where all that is claimed holds and the error has no bound that is proved or derived twice.
pub(crate) const NOT_PROVED: u8 = 3;

/// Check every claim of a certificate again, from the gains alone.
///
/// Needs nothing but the file: no solver's word. What the file cannot show of itself is listed as taken on
/// trust; with a study, that is derived again as far as it can be. With --run the gains and the study are
/// those of a run's record, whose files have to be those that the run left, and whose figures have to follow
/// from its trace.
///
/// Each claim is PROVED (exact arithmetic), DERIVED TWICE (two derivations that share no code, in double
/// precision; of two bounds the wider one is printed) or NOT PROVED. The last line has the weakest of the bounds
/// on the errors and of the specification.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 PROVED or DERIVED TWICE · 1 a claim does not hold; the inequality that fails is\n\
                        told · 3 NOT PROVED: what the file claims holds, but the bound on the error, or a clause of\n\
                        the specification, rests on one derivation or on none (with --run 0: the record is whole) · 4 \
                        with --run: the record breaks\n\
                        what the certificate assumes.\n\n\
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
    /// Seed of the worlds and postures that are drawn, beside the SHA-256 of the gains: a number of your own, which
    /// whoever made the file cannot know.
    #[arg(long, value_name = "N", default_value_t = 0, requires = "study")]
    seed: u64,
    /// Prove the range of the arm's inertia over all postures of the joints' travel and all payloads of the study, as
    /// far as it comes in so many seconds: within 50 % of what was searched, then within 19, 9, 4, 2 and 0.5 %.
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "60", value_parser = positive,
        requires = "study")]
    prove_range: Option<f64>,
    /// Check the record of a run: its files, its figures, and its gains against its study.
    #[arg(long, value_name = "FOLDER")]
    run: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let checked = match (&self.run, &self.gains) {
            (Some(folder), _) => Checked::Record(folder),
            (None, Some(gains)) => {
                Checked::Gains { gains, study: self.study.as_deref(), seed: self.seed }
            }
            (None, None) => return Err(Failure::plain("give a gains document, or --run FOLDER")),
        };
        warn_of_renamed(&self.study);
        let found = self.checked(checked)?;
        let record = found.record.as_ref().map(record_words);
        let audited = self.run.as_deref().and_then(audit::after);
        let conforms = audited.as_ref().is_none_or(|audited| audited.broken().next().is_none());
        let Some(claims) = &found.claims else {
            self.tell_bare_record(&record.unwrap_or_default());
            return Ok(ExitCode::SUCCESS);
        };
        if self.json {
            let holds = claims.is_ok();
            let document = match claims {
                Ok(verified) => {
                    json!({
                        "holds": holds, "refuted": null, "verified": verified, "runs": found.runs, "record": record,
                        "rigid_joints": found.rigid_joints, "audit": audited,
                    })
                }
                Err(why) => json!({ "holds": holds, "refuted": why, "record": record }),
            };
            println!("{document:#}");
        } else {
            if let Some(words) = &record {
                println!("RECORD\n  {words}");
            }
            match claims {
                Ok(verified) => println!("{}", blocks(verified, &found)),
                Err(why) => println!("REFUSED: {why}"),
            }
            if let Some(audited) = &audited {
                println!("THE RECORD AGAINST WHAT IS ASSUMED\n{}", audit::lines(audited, false));
            }
        }
        Ok(match claims {
            Err(_) => ExitCode::from(1),
            Ok(_) if !conforms => ExitCode::from(audit::BROKEN),
            // Of a record the question is whether its files and figures belong together.
            Ok(verified) if verified.verdict == Verdict::NotProved && self.run.is_none() => {
                ExitCode::from(NOT_PROVED)
            }
            Ok(_) => ExitCode::SUCCESS,
        })
    }

    /// Result of the check, with the proof of the range of inertia where one is wanted.
    fn checked(&self, checked: Checked<'_>) -> Result<Verification, Failure> {
        let bar = spinner();
        let found = verify(checked, &|stage| {
            bar.set_message(match stage {
                VerifyStage::Tube(share) => second_derivation(share),
                VerifyStage::Worlds(done) => format!("worlds of the study: {done} of {WORLDS} run"),
            });
            bar.tick();
        });
        bar.finish_and_clear();
        let mut found = found?;
        if let (Some(seconds), Some(gains), Some(study)) =
            (self.prove_range, &self.gains, &self.study)
        {
            prove_range(&mut found, (gains, study), seconds)?;
        }
        Ok(found)
    }

    /// A record whose gains carry no certificate.
    fn tell_bare_record(&self, words: &str) {
        if self.json {
            println!("{:#}", json!({ "holds": true, "refuted": null, "record": words }));
        } else {
            println!(
                "RECORD\n  {words}\nits gains carry no certificate: nothing is claimed about them"
            );
        }
    }
}

/// Proves the range of inertia of gains that hold, as far as it comes in a time.
fn prove_range(
    found: &mut Verification,
    (gains, study): (&Path, &Path),
    seconds: f64,
) -> Result<(), Failure> {
    let (gains, study) = (read_gains(gains)?, read(study)?);
    let (Some(certificate), Some(Ok(verified))) = (&gains.certificate, &found.claims) else {
        return Ok(());
    };
    match timed_proof(&study, &certificate.arm, seconds) {
        Ok(proof) => found.claims = Some(certificate.with_range(verified.clone(), proof)),
        Err(why) => eprintln!("range of inertia not proved: {why}"),
    }
    Ok(())
}

/// Result for a record.
fn record_words(metrics: &Metrics) -> String {
    format!(
        "every file is the one that the run left, and its figures follow from its trace: {}",
        table::verdict(metrics, None)
    )
}

/// All blocks, and the verdict as the last line.
fn blocks(verified: &Verified, found: &Verification) -> String {
    let line = |one: &VerifiedStatement| {
        let joint = one.joint.as_ref().map_or_else(String::new, |joint| format!("{joint}: "));
        format!("  {joint}{}: {}", one.what, one.value)
    };
    let block = |title: &str, lines: Vec<String>| {
        let lines = if lines.is_empty() { vec!["  nothing".to_owned()] } else { lines };
        format!("{title}\n{}", lines.join("\n"))
    };
    let mut blocks = vec![
        block("PROVED FROM THIS FILE", verified.proved.iter().map(line).collect()),
        block("DERIVED TWICE FROM THIS FILE", verified.derived_twice.iter().map(line).collect()),
        block("TAKEN ON TRUST", verified.trusted.iter().map(line).collect()),
    ];
    if !verified.derived.is_empty() {
        blocks
            .push(block("OF THAT, AGAINST THE STUDY", verified.derived.iter().map(line).collect()));
    }
    if let Some(tube) = &verified.tube {
        blocks.push(block("THE TUBE, BY A SECOND DERIVATION", again_lines(tube, found)));
    }
    if let Some(class) = &verified.class {
        blocks
            .push(block("THE CLASS OF MOTIONS, BY A SECOND DERIVATION", class_lines(class, found)));
    }
    if let Some(range) = &verified.range {
        let lines = range.lines().map(|line| format!("  {line}"));
        blocks.push(block("RANGE OF INERTIA, BY CELLS", lines.to_vec()));
    }
    let assumed = verified.assumptions.iter().map(|one| format!("  {}: {}", one.number, one.text));
    blocks.push(block("ASSUMED", assumed.collect()));
    let left = table::not_counted(&verified.not_counted);
    let left = left.into_iter().chain(found.rigid_joints.clone());
    let left = left.map(|one| format!("  {one}")).collect();
    blocks.push(block("NOT COUNTED", left));
    if !verified.error_bounds.is_empty() {
        let lines = verified.error_bounds.iter().map(|own| bound_line(own, found));
        blocks.push(block("BOUND ON THE ERROR", lines.collect()));
    }
    if !verified.not_proved.is_empty() {
        let lines = verified.not_proved.iter().map(|one| format!("  {one}"));
        blocks.push(block("NOT PROVED", lines.collect()));
    }
    blocks.push(format!("{}: {}", verified.verdict.words(), reason(verified)));
    blocks.join("\n")
}

fn bound_line(own: &CheckedBound, found: &Verification) -> String {
    let unit = unit_of("mrad", found.sliding.contains(&own.joint));
    let (bound, words) = (1e3 * own.error_bound_rad, own.verdict.words());
    format!("  {}: |e| ≤ {bound:.4} {unit}, {words}: {}", own.joint, own.basis)
}

/// Reason of the verdict, for its line.
fn reason(verified: &Verified) -> &'static str {
    match verified.verdict {
        Verdict::Proved => "every claim holds",
        Verdict::DerivedTwice => {
            "every claim holds, and two derivations bound the error of every joint"
        }
        Verdict::NotProved if !verified.bounded => {
            "the claims about the loop hold; the error has NO bound"
        }
        Verdict::NotProved if !verified.not_proved.is_empty() => {
            "the claims about the loop hold; the specification does not hold for certain"
        }
        Verdict::NotProved => {
            "the claims about the loop hold; a bound on the error rests on one derivation"
        }
    }
}

/// Results of the second derivation of the bound for a class.
fn class_lines(class: &ClassAgain, found: &Verification) -> Vec<String> {
    let joint = |own: &JointOfClass| {
        let slides = found.sliding.contains(&own.name);
        let pair = |what: &str, pair: ClassPair, scale: f64, unit: &str| {
            let [claimed, derived] = [pair.claimed, pair.derived].map(|x| scale * x);
            format!("{what} ≤ {claimed:.4} {} claimed, {derived:.4} derived", unit_of(unit, slides))
        };
        [
            pair("|e|", own.error_bound_rad, 1e3, "mrad"),
            pair("|ė|", own.velocity_error_bound_rad_s, 1e3, "mrad/s"),
            pair("|Δτ|", own.torque_step_nm, 1.0, "N·m"),
            pair("|τ|", own.torque_nm, 1.0, "N·m"),
        ]
        .map(|line| format!("  {}: {line}", own.name))
    };
    let mut lines: Vec<String> = class.joints.iter().flat_map(joint).collect();
    if let Some(why) = &class.on_trust {
        lines
            .push(format!("  the bound is on trust: it could not be derived a second time, {why}"));
    } else {
        lines.push(format!("  derived over claimed |e| is {:.3} at most", class.largest_ratio()));
    }
    lines.push(format!("  {}", class.assumption()));
    lines
}

/// Results of the second derivation and of the drawn worlds for the tube.
fn again_lines(tube: &TubeAgain, found: &Verification) -> Vec<String> {
    let joint = |own: &JointBeside| {
        let ends = [own.error_bound_rad, own.derived_error_bound_rad].map(|e| 1e3 * e);
        let rest = if own.confirmed() {
            String::new()
        } else {
            format!("; up to {:.1} times tighter in places", own.tighter)
        };
        let unit = unit_of("mrad", found.sliding.contains(&own.name));
        format!("  {}: |e| ≤ {:.4} {unit} claimed, {:.4} derived{rest}", own.name, ends[0], ends[1])
    };
    let mut lines: Vec<String> = tube.joints.iter().map(joint).collect();
    lines.extend(tube.on_trust.iter().map(|why| {
        format!("  the tube is on trust: it could not be derived a second time, {why}")
    }));
    lines.extend(found.runs.as_ref().map(|kept| {
        format!("  {} worlds drawn from the study's scope were run: none left the tube", kept.runs)
    }));
    lines
}
