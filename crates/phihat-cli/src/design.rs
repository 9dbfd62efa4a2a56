//! `phihat design`: from a specification to gains with a certificate, or a "no" with its reason.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use phihat_certificate::{Proved, RangeProof};
use phihat_design::budget::Budget;
use phihat_design::{Arm, Gains, Infeasible, Outcome};
use phihat_study::{DesignMethod, Study};
use serde_json::json;

use phihat_session::{
    BudgetFiles, Watch, are_of_a_run, arm, beside_limits, budget, designed_in_steps, files, read,
    rigid_joints, write_budget,
};
use phihat_synthesis::{Advice, BudgetSearch, Steps};

use crate::check::warn_of_renamed;
use crate::failure::Failure;
use crate::numbers::positive;
use crate::proving::timed_proof;
use crate::shown::TerminalWatch;
use crate::table;
use crate::verify::NOT_PROVED;

/// Find gains that keep a study's specification, and prove what can be proved about them.
///
/// The study states the largest error under `spec`, and under `design` what is known of arm and load. Writes
/// gains.json, which `phihat verify` checks again and `phihat simulate --gains` runs.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 1 no gains keep every clause; the clauses in the way are told · 3 gains are written, \
                        and\nnot every clause is proved of them (NOT PROVED).\n\n\
                        Example:\n  phihat design studies/panda_design.toml"
)]
pub(crate) struct Design {
    /// The study file (TOML).
    study: PathBuf,
    /// Where to write the gains [default: out/STUDY/gains.json].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// How, in place of what the study says: proved to keep the specification, or the paper's own recipe, whose
    /// certificate says what holds.
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Prove the range of the arm's inertia over all postures and payloads, within 50 % of what was searched, then
    /// within 19, 9, 4, 2 and 0.5 %, as far as it comes in so many seconds; `phihat verify --prove-range` proves it
    /// again.
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "60", value_parser = positive)]
    prove_range: Option<f64>,
    /// Tell how far each joint's law is from what no linear law undercuts at a known inertia, and what not knowing the
    /// inertia costs: takes some seconds more, and is kept in gains.json, for the report. No claim: nothing checks it.
    #[arg(long)]
    limit: bool,
    #[command(flatten)]
    asked: DesignOutput,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

/// How much is told.
#[derive(Debug, Args)]
struct DesignOutput {
    /// Tell what the allowed error is spent on, joint by joint, and what other laws would do; written to
    /// budget.html and budget.json beside the gains. Where there are no gains this is done anyway, with what
    /// one change would buy.
    #[arg(long)]
    budget: bool,
    /// Say too what the search and its proofs looked at.
    #[arg(long)]
    verbose: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Method {
    Ours,
    Paper,
}

impl Design {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let mut study = read(&self.study)?;
        warn_of_renamed([&self.study]);
        if let Some(method) = self.method {
            study.design.method = match method {
                Method::Ours => DesignMethod::Ours,
                Method::Paper => DesignMethod::Paper,
            };
        }
        let arm = arm(&study, &self.study)?;
        let mut outcome = self.found(&study, &arm)?;
        // Where no law keeps a clause, no change of the loop does either.
        let searched = matches!(&outcome, Outcome::Infeasible(no) if !no.beyond_any_law);
        let asked = self.asked.budget || searched;
        let told = if asked { Some(self.told(&study, &arm, &outcome)?) } else { None };
        match &mut outcome {
            Outcome::Designed(gains) => {
                if let Some(seconds) = self.prove_range {
                    prove_range(gains, &study, seconds);
                }
                if self.limit {
                    let mut shown =
                        TerminalWatch::bar("{spinner} {msg} · {elapsed}", String::new());
                    beside_limits(&study, gains, &mut shown)?;
                }
                self.write(&study, gains, told.as_ref())
            }
            Outcome::Infeasible(no) => Ok(self.refuse(no, told.as_ref())),
        }
    }

    /// The outcome, its steps shown meanwhile.
    fn found(&self, study: &Study, arm: &Arm) -> Result<Outcome, Failure> {
        let shown = RefCell::new(TerminalWatch::steps());
        let begins = |what: &str| {
            shown.borrow_mut().step(what);
            ControlFlow::Continue(())
        };
        let steps = (Advice::Clauses, Steps::to(&begins));
        let outcome = designed_in_steps(study, arm, &self.study, steps);
        shown.borrow_mut().ended();
        Ok(outcome?)
    }

    /// The folder of the results.
    fn folder(&self, study: &Study) -> PathBuf {
        let default = || Path::new("out").join(&study.name);
        self.out.as_ref().and_then(|file| file.parent()).map_or_else(default, Path::to_owned)
    }

    /// The error budget, and where it was written.
    fn told(
        &self,
        study: &Study,
        arm: &Arm,
        outcome: &Outcome,
    ) -> Result<(Budget, BudgetFiles), Failure> {
        let mut shown = TerminalWatch::bar("{spinner} {msg} · {elapsed}", String::new());
        let asked = (outcome, BudgetSearch::Changes);
        let budget = budget(study, arm, &self.study, asked, &mut shown)?;
        let files = write_budget(&budget, &self.folder(study))?;
        Ok((budget, files))
    }

    fn write(
        &self,
        study: &Study,
        gains: &Gains,
        told: Option<&(Budget, BudgetFiles)>,
    ) -> Result<ExitCode, Failure> {
        let default = || Path::new("out").join(&study.name).join("gains.json");
        let path = self.out.clone().unwrap_or_else(default);
        let text = gains.to_json().map_err(Failure::plain)?;
        let others = are_of_a_run(&path, &text);
        files::write(&path, &text)?;
        if others {
            let file = path.display();
            eprintln!(
                "{file}: took the place of the gains of a run, whose record is whole no longer"
            );
        }
        if self.json {
            let mut document = json!({ "outcome": "designed", "file": path, "gains": gains });
            if let Some((budget, _)) = told {
                document["budget"] = json!(budget);
            }
            println!("{document:#}");
        } else {
            println!("{}", table::gains(gains));
            println!("{}", gains.method);
            if let Some(certificate) = &gains.certificate {
                println!("{}", table::certificate(certificate, gains));
            }
            if let Some(rigid) = rigid_joints(study, gains) {
                println!("{rigid}");
            }
            if let Some(class) = table::class(gains) {
                println!("{class}");
            }
            if let Some(stop) = table::stop(study, gains) {
                println!("{stop}");
            }
            if !gains.limit.is_empty() {
                println!("{}", table::limit(gains));
            }
            if let Some(coarser) = table::coarser(gains) {
                println!("{coarser}");
            }
            if let Some((budget, files)) = told {
                println!("{}", table::budget(budget));
                println!("budget: {}", files.page.display());
            }
            println!("gains: {}", path.display());
        }
        let whole = gains.certificate.as_ref().is_none_or(|own| own.unproved.is_empty());
        Ok(if whole { ExitCode::SUCCESS } else { ExitCode::from(NOT_PROVED) })
    }

    fn refuse(&self, no: &Infeasible, told: Option<&(Budget, BudgetFiles)>) -> ExitCode {
        let page = told.map(|(_, files)| &files.page);
        let budget = told.map(|(budget, _)| budget);
        if self.json {
            let document =
                json!({ "outcome": "infeasible", "reason": no, "budget": budget, "page": page });
            println!("{document:#}");
        } else {
            println!("{no}");
            if self.asked.verbose {
                println!("{}", no.searched());
            }
            if let Some(budget) = budget {
                println!("{}", table::budget(budget));
            }
            if let Some(page) = page {
                println!("budget: {}", page.display());
            }
        }
        ExitCode::from(1)
    }
}

/// Proves the range of the arm's inertia, as far as it comes in a time, and writes it into the certificate.
fn prove_range(gains: &mut Gains, study: &Study, seconds: f64) {
    let Some(certificate) = &mut gains.certificate else { return };
    let proof = timed_proof(study, &certificate.arm, seconds);
    let Some(searched) = &mut certificate.arm.searched else { return };
    match proof {
        Ok(RangeProof { outside: Some(outside), .. }) => eprintln!(
            "range of inertia not proved: the search missed an eigenvalue of {:.5} at q = {:?} rad",
            outside.eigenvalue, outside.q
        ),
        Ok(RangeProof { low, high, cells, .. }) if low > 0.0 && high.is_finite() => {
            searched.proved = Some(Proved { low, high, cells });
        }
        Ok(_) => eprintln!("range of inertia not proved in {seconds} s: no end is bounded yet"),
        Err(why) => eprintln!("range of inertia not proved: {why}"),
    }
}
