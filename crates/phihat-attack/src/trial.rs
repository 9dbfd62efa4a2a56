//! One study attacked: designed, verified, run in the worlds of its scope, held against what is claimed.

use std::path::Path;
use std::time::Instant;

use phihat::Form;
use phihat_design::claims::Refutation;
use phihat_design::{Clause, Gains};
use phihat_session::Dice;

use crate::claim::{AttackClaim, derived_again};
use crate::derived::derived;
use crate::draft::Draft;
use crate::drawn::drawn;
use crate::frozen::at_rest;
use crate::held::{JointFound, Violation, held};
use crate::judged::{DesignVerdict, judged_by};
use crate::record::{AttackRecord, SecondDerivation, TrialEnded};
use crate::run::run;
use crate::second::opinion;
use crate::typed::Claims;
use crate::vary::worlds;

/// Draws until one is a study.
const DRAWS: usize = 8;
/// Designs of one study, each asking for what the one before said is possible.
const ROUNDS: usize = 3;
/// The world in which other simulators run a study besides its own.
const SECOND: usize = 2;

/// A trial, and its files where they are to be kept.
#[derive(Debug)]
pub struct Trial<'a> {
    /// Seed of the attack.
    pub seed: u64,
    /// Share of the studies that have laws from positions.
    pub positions: f64,
    /// Share of these whose laws come from a search.
    pub searched: f64,
    /// Runs per study.
    pub runs: usize,
    /// Folder in which broken studies are stored, each in a folder of its number.
    pub folder: &'a Path,
    /// Of every so many, the certified ones are kept, and other simulators asked; 0: none.
    pub keep_every: u64,
    /// Of every so many, those certified with laws from positions are verified against their study; 0: none.
    pub derive_every: u64,
    /// Of every so many studies with typed laws, all claims are found and verified, 0: of none; of the others
    /// the tube alone.
    pub whole_every: u64,
    /// The Python that asks them.
    pub python: Option<&'a Path>,
}

impl Trial<'_> {
    /// Attacks one study.
    pub fn attack(&self, index: u64) -> AttackRecord {
        let mut dice = Dice::new(self.seed, index);
        let folder = self.folder.join(format!("{index}"));
        let mut record = AttackRecord {
            index,
            tags: Vec::new(),
            joints: 0,
            ended: TrialEnded::NoStudy,
            reason: String::new(),
            redrawn: Vec::new(),
            runs: (0, 0),
            found: Vec::new(),
            violations: Vec::new(),
            second: None,
            at_rest: None,
            derived: None,
            second_derivation: None,
            seconds: (0.0, 0.0),
        };
        for _ in 0..DRAWS {
            match drawn(&mut dice, (self.positions, self.searched), &folder) {
                Ok(draft) => {
                    record.tags.clone_from(&draft.tags);
                    self.examine(draft, &mut dice, &folder, &mut record);
                    break;
                }
                Err(why) => record.redrawn.push(why.to_string()),
            }
        }
        let kept = record.ended != TrialEnded::NoStudy && self.asked(index)
            || !record.violations.is_empty();
        if !kept {
            // What cannot be removed is left behind, and overwritten next time.
            let _ = std::fs::remove_dir_all(&folder);
        }
        record
    }

    /// Returns true if other simulators are requested.
    fn asked(&self, index: u64) -> bool {
        one_of(self.keep_every, index)
    }

    fn examine(&self, mut draft: Draft, dice: &mut Dice, folder: &Path, record: &mut AttackRecord) {
        let began = Instant::now();
        let path = folder.join("study.toml");
        let mut verdict = None;
        // What is verified against its study has to be whole.
        let whole =
            one_of(self.whole_every, record.index) || one_of(self.derive_every, record.index);
        let claims = if whole { Claims::All } else { Claims::Tube };
        for _ in 0..ROUNDS {
            let study = match draft.study(&draft.nominal, folder) {
                Ok(study) => study,
                Err(why) => {
                    record.reason = format!("{why}");
                    return;
                }
            };
            record.joints = study.robot.joints.len();
            // What takes for ever can be looked at.
            write(folder, &[("study.toml".to_owned(), draft.text(&draft.nominal))], record);
            let judged = judged_by(&study, (&draft.laws, claims), &path);
            let worse = match &judged {
                DesignVerdict::Infeasible(clauses) => relief(clauses),
                _ => None,
            };
            verdict = Some(judged);
            let Some(factor) = worse else { break };
            let factor = factor * dice.between(1.0, 1.6);
            draft.error_bound.iter_mut().for_each(|error| *error *= factor);
        }
        record.seconds.0 = began.elapsed().as_secs_f64();
        match verdict {
            Some(DesignVerdict::Certified(gains, claim)) => {
                record.ended = TrialEnded::Certified;
                self.run_all(&draft, (&gains, &claim), dice, folder, record);
                record.seconds.1 = began.elapsed().as_secs_f64() - record.seconds.0;
            }
            Some(DesignVerdict::NotProved(why)) => {
                record.ended = TrialEnded::NotProved;
                record.reason = why;
            }
            Some(DesignVerdict::Refuted(gains, why)) => {
                record.ended = TrialEnded::NotProved;
                record.reason = format!("verify refutes: {why}");
                record.violations.push(refuted(&why));
                write(
                    folder,
                    &[("gains.json".to_owned(), gains.to_json().unwrap_or_default())],
                    record,
                );
            }
            Some(DesignVerdict::Infeasible(clauses)) => {
                record.ended = TrialEnded::Infeasible;
                let key = |clause: &Clause| clause.key.clone();
                record.reason = clauses.iter().map(key).collect::<Vec<_>>().join(", ");
            }
            None => {}
        }
    }

    fn run_all(
        &self,
        draft: &Draft,
        (gains, claim): (&Gains, &AttackClaim),
        dice: &mut Dice,
        folder: &Path,
        record: &mut AttackRecord,
    ) {
        let mut keep = Vec::new();
        let again =
            one_of(self.derive_every, record.index).then(|| draft.study(&draft.nominal, folder));
        let again = again.and_then(Result::ok).and_then(|study| derived_again(gains, &study));
        record.second_derivation =
            again.as_ref().map(|(_, wider)| SecondDerivation { runs: 0, wider: *wider });
        for (name, world) in worlds(&draft.nominal, &draft.scope, dice, self.runs) {
            let study = match draft.study(&world, folder) {
                Ok(study) => study,
                Err(why) => {
                    record.redrawn.push(format!("world {name}: {why}"));
                    continue;
                }
            };
            let outcome = match run(&study, gains, &world.phase) {
                Ok(outcome) => outcome,
                Err(why) => {
                    record.redrawn.push(format!("run {name}: {why}"));
                    continue;
                }
            };
            let found = held(claim, &outcome, &name);
            record.runs.0 += 1;
            record.runs.1 += usize::from(found.outside);
            if !found.outside {
                worst(&mut record.found, &found.joints);
            }
            if let (Some((claim, _)), Some(count)) = (&again, &mut record.second_derivation) {
                let name = format!("{name}, second derivation");
                record.violations.extend(held(claim, &outcome, &name).violations);
                count.runs += 1;
            }
            let place = record.runs.0 - 1;
            let second = place == SECOND && self.asked(record.index);
            if place > 0 && (second || !found.violations.is_empty()) {
                keep.push((format!("world{place}.toml"), draft.text(&world)));
            }
            record.violations.extend(found.violations);
        }
        keep.push(("gains.json".to_owned(), gains.to_json().unwrap_or_default()));
        keep.push(("claim.json".to_owned(), serde_json::to_string(claim).unwrap_or_default()));
        write(folder, &keep, record);
        self.beside((draft, gains), dice, folder, record);
        if let Some(python) = self.python.filter(|_| self.asked(record.index)) {
            match opinion(python, folder) {
                Ok((second, violations)) => {
                    record.second = Some(second);
                    record.violations.extend(violations);
                }
                Err(why) => record.redrawn.push(why.to_string()),
            }
        }
    }
}

impl Trial<'_> {
    /// Checks the claims about laws from positions that its runs do not cover.
    fn beside(
        &self,
        (draft, gains): (&Draft, &Gains),
        dice: &mut Dice,
        folder: &Path,
        record: &mut AttackRecord,
    ) {
        let Ok(study) = draft.study(&draft.nominal, folder) else { return };
        if study.control.form != Form::Positions {
            return;
        }
        let found = at_rest(&study, gains, dice);
        record.at_rest = (found.reached > 0.0).then_some(found.reached);
        record.violations.extend(found.violations);
        if one_of(self.derive_every, record.index) {
            match derived(folder) {
                Ok(told) => record.derived = Some(told),
                Err(left) => record.violations.push(left),
            }
        }
    }
}

/// Returns true for one in `every` studies; 0: for none.
fn one_of(every: u64, index: u64) -> bool {
    every > 0 && index.is_multiple_of(every)
}

/// Files of a trial.
fn write(folder: &Path, files: &[(String, String)], record: &mut AttackRecord) {
    for (name, text) in files {
        if let Err(why) = std::fs::write(folder.join(name), text) {
            record.redrawn.push(format!("{name}: {why}"));
        }
    }
}

/// Violation by a claim that was found and does not verify.
fn refuted(why: &Refutation) -> Violation {
    Violation {
        run: "verify".to_owned(),
        joint: String::new(),
        signal: format!("{}: {}", why.claim, why.inequality),
        t_s: 0.0,
        measured: why.left,
        claimed: (0.0, why.right),
        ratio: f64::MAX,
    }
}

/// By how much the error must be allowed to grow; `None` where that does not help.
fn relief(clauses: &[Clause]) -> Option<f64> {
    let clause = clauses.iter().find(|clause| clause.key == "spec.error_bound_rad")?;
    Some((clause.possible? / clause.wanted).max(1.02))
}

fn worst(all: &mut Vec<JointFound>, one: &[JointFound]) {
    if all.is_empty() {
        all.extend_from_slice(one);
        return;
    }
    for (all, one) in all.iter_mut().zip(one) {
        all.error_peak_rad = all.error_peak_rad.max(one.error_peak_rad);
        all.velocity_rad_s = all.velocity_rad_s.max(one.velocity_rad_s);
        all.step_nm = all.step_nm.max(one.step_nm);
    }
}
