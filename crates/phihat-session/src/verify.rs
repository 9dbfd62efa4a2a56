//! Every claim about a set of gains, checked again.

use std::path::{Path, PathBuf};

use phihat_certificate::extremes::Extremes as _;
use phihat_certificate::parallel::{both, threads};
use phihat_certificate::{Certificate, Refutation, Verdict, Verified};
use phihat_design::Gains;
use phihat_report::RecordedBound;
use phihat_sim::Metrics;
use phihat_study::Study;
use serde::Serialize;

use crate::design;
use crate::drawn_worlds::{DrawnRuns, runs};
use crate::error::SessionError;
use crate::files::read_gains;
use crate::hash::seed_of;
use crate::origin::trace_of;
use crate::rigid::rigid_joints;
use crate::run_record::RunRecord;
use crate::second_tube::derived_tube;

/// Subject of a check.
#[derive(Debug, Clone, Copy)]
pub enum Checked<'a> {
    /// A gains document alone, or derived again from a study as far as it can be.
    Gains {
        /// The document.
        gains: &'a Path,
        /// The study file.
        study: Option<&'a Path>,
        /// Seed of the reader for the drawn worlds, beside the file's own hash.
        seed: u64,
    },
    /// The same of documents at hand.
    Documents {
        /// The gains.
        gains: &'a Gains,
        /// The study.
        study: Option<&'a Study>,
        /// Seed of the reader.
        seed: u64,
    },
    /// The record of a run: its files, its figures, and its gains against its study.
    Record(&'a Path),
}

impl Checked<'_> {
    /// Seed of the reader.
    fn seed(self) -> u64 {
        match self {
            Self::Gains { seed, .. } | Self::Documents { seed, .. } => seed,
            Self::Record(_) => 0,
        }
    }
}

/// Progress of a check that takes long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VerifyStage {
    /// The tube is derived a second time; the share that is done.
    Tube(f64),
    /// So many of the drawn worlds were run.
    Worlds(usize),
}

/// Result of a check.
#[derive(Debug)]
pub struct Verification {
    /// The figures of the run whose record was checked.
    pub record: Option<Metrics>,
    /// The claims that hold, or the one that does not; `None`: the gains of a record carry no certificate.
    pub claims: Option<Result<Verified, Refutation>>,
    /// Runs in worlds drawn from the study's scope.
    pub runs: Option<DrawnRuns>,
    /// Names of the joints that slide.
    pub sliding: Vec<String>,
    /// One sentence on joints that are taken as rigid; `None`: no study was given, or it states their springs.
    pub rigid_joints: Option<String>,
}

/// Checks every claim about a set of gains; with a study, derives again what the file alone has to be trusted for.
///
/// # Errors
///
/// [`SessionError`]: a file cannot be used, or a record is not what its run left. That a claim does not hold
/// is an answer.
pub fn verify(
    checked: Checked<'_>,
    stage: &(dyn Fn(VerifyStage) + Sync),
) -> Result<Verification, SessionError> {
    let (gains, study, record, path) = match checked {
        Checked::Gains { gains, study, .. } => from_files(gains, study)?,
        Checked::Documents { gains, study, .. } => from_documents(gains, study)?,
        Checked::Record(folder) => {
            let (kept, path) = whole(folder)?;
            let (record, sum) = (Some(kept.seen.metrics), &kept.study.sha256);
            let Some(gains) = kept.gains else {
                let sliding = kept.study.robot.sliding();
                return Ok(Verification {
                    record,
                    claims: None,
                    runs: None,
                    sliding,
                    rigid_joints: None,
                });
            };
            let own = gains.study_sha256 == *sum;
            (gains, own.then_some(kept.study), record, path)
        }
    };
    let Some(certificate) = &gains.certificate else {
        if record.is_some() {
            let sliding = gains.sliding;
            return Ok(Verification {
                record,
                claims: None,
                runs: None,
                sliding,
                rigid_joints: None,
            });
        }
        return Err(SessionError::at(&path, "these gains carry no certificate"));
    };
    // Two that do not wait for each other.
    let rigid = || study.as_ref().and_then(|study| rigid_joints(study, &gains));
    let (rigid_joints, claims) = both(threads(), rigid, || -> Result<Again, SessionError> {
        match (certificate.verified(&gains), &study) {
            (Ok(verified), Some(study)) => {
                let about = (&gains, certificate);
                Ok(again(verified, about, (study, checked.seed()), stage)?)
            }
            (claims, _) => Ok(claims.map(|verified| (verified, None))),
        }
    });
    let mut runs = None;
    let claims = claims?.map(|(verified, kept)| {
        runs = kept;
        verified
    });
    let claims = claims.map(|mut verified| {
        in_own_units(&mut verified, &gains);
        verified
    });
    Ok(Verification { record, claims: Some(claims), runs, sliding: gains.sliding, rigid_joints })
}

/// Gains and their study, completed by them, without a record.
type Documents = (Gains, Option<Box<Study>>, Option<Metrics>, PathBuf);

#[inline(never)]
fn from_files(gains: &Path, study: Option<&Path>) -> Result<Documents, SessionError> {
    let study = study.map(design::read).transpose()?;
    completed(read_gains(gains)?, study, gains)
}

#[inline(never)]
fn from_documents(gains: &Gains, study: Option<&Study>) -> Result<Documents, SessionError> {
    let study = study.map(|study| Box::new(study.clone()));
    completed(gains.clone(), study, Path::new("gains.json"))
}

/// Gains of a path with the study that they complete.
#[inline(never)]
fn completed(
    gains: Gains,
    mut study: Option<Box<Study>>,
    path: &Path,
) -> Result<Documents, SessionError> {
    if let Some(study) = &mut study {
        gains.complete(study).map_err(|e| SessionError::at(path, e))?;
    }
    Ok((gains, study, None, path.to_owned()))
}

/// Says what is said of joints that slide in metres and newtons.
fn in_own_units(verified: &mut Verified, gains: &Gains) {
    let said = [
        &mut verified.proved,
        &mut verified.derived_twice,
        &mut verified.trusted,
        &mut verified.derived,
    ];
    for one in said.into_iter().flatten() {
        if one.joint.as_ref().is_some_and(|joint| gains.slides(joint)) {
            let pairs =
                [("rad/(rad/s²)", "m/(m/s²)"), (" rad", " m"), ("kg·m²", "kg"), ("N·m", "N")];
            let own = |value: String, (turns, slides)| value.replace(turns, slides);
            one.value = pairs.into_iter().fold(std::mem::take(&mut one.value), own);
        }
    }
}

/// A record whose files, figures and tube hold.
fn whole(folder: &Path) -> Result<(Box<RunRecord>, PathBuf), SessionError> {
    let trace = trace_of(folder);
    let kept = Box::new(RunRecord::read(&trace)?);
    kept.figures_hold(folder)?;
    match kept.seen.tube.as_ref().filter(|tube| tube.broken().is_some()) {
        Some(tube) => Err(SessionError::TubeLeft { path: trace, sentence: tube.sentence() }),
        None => Ok((kept, trace)),
    }
}

type Again = Result<(Verified, Option<DrawnRuns>), Refutation>;

/// Derives again from the study what the file has to be trusted for, and runs a few worlds of it.
fn again(
    verified: Verified,
    (gains, certificate): (&Gains, &Certificate),
    (study, seed): (&Study, u64),
    stage: &(dyn Fn(VerifyStage) + Sync),
) -> Result<Again, SessionError> {
    // What is drawn comes from the file and from the reader: nobody who wrote the file knows it.
    let text = gains.to_json().map_err(SessionError::other)?;
    let seed = seed_of(&text, seed);
    let share = |share| stage(VerifyStage::Tube(share));
    let checked = derived_again(verified, (gains, certificate), (study, seed), &share);
    let verified = match checked {
        Ok(verified) => verified,
        Err(why) => return Ok(Err(why)),
    };
    let Some(tube) = &certificate.tube else { return Ok(Ok((verified, None))) };
    let found = runs(study, (gains, tube), seed, &|done| stage(VerifyStage::Worlds(done)))?;
    Ok(found.map(|kept| (verified, Some(kept))))
}

/// Largest bound on the error of a joint, with its standing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundStanding {
    /// The bound \[rad\], the wider one where two derivations give it.
    pub error_bound_rad: f64,
    /// Standing of the bound.
    pub verdict: Verdict,
    /// Both in words: `DERIVED TWICE ≤ 0.264 mrad`.
    pub words: String,
    /// Bound of each joint \[rad\].
    #[serde(skip)]
    pub each_rad: Vec<f64>,
}

impl BoundStanding {
    fn of(bounds: &[(&str, f64)], verdict: Verdict, gains: &Gains) -> Option<Self> {
        let error_bound_rad = bounds.iter().map(|(_, bound)| *bound).largest();
        let (joint, _) = bounds.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let unit = if gains.slides(joint) { "mm" } else { "mrad" };
        let words = verdict.of_bound(&format!("{:.3} {unit}", 1e3 * error_bound_rad));
        let each_rad = bounds.iter().map(|(_, bound)| *bound).collect();
        Some(Self { error_bound_rad, verdict, words, each_rad })
    }
}

/// Largest bound of gains for a class of motions, after their check as [`verify`] does it with the study and without a
/// number of the reader's; `None`: they bound no error of a class. Takes seconds.
///
/// # Errors
///
/// [`SessionError`]: the gains are of another form than the study.
pub fn class_standing(
    gains: &Gains,
    study: &Study,
) -> Result<Result<Option<BoundStanding>, Refutation>, SessionError> {
    let Some(certificate) = gains.certificate.as_ref().filter(|own| own.class.is_some()) else {
        return Ok(Ok(None));
    };
    let checked = twice((gains, certificate), study, &|_| {})?;
    Ok(checked.map(|verified| {
        let bounds: Vec<(&str, f64)> =
            verified.error_bounds.iter().map(|own| (&*own.joint, own.error_bound_rad)).collect();
        BoundStanding::of(&bounds, weakest(&verified), gains)
    }))
}

/// Standing of the weakest bound.
fn weakest(verified: &Verified) -> Verdict {
    let verdict = verified.error_bounds.iter().map(|own| own.verdict).min();
    verdict.unwrap_or(Verdict::NotProved)
}

/// The claims of gains after their check with the study: what [`verify`] derives again, without its runs.
fn twice(
    (gains, certificate): (&Gains, &Certificate),
    study: &Study,
    share: &(dyn Fn(f64) + Sync),
) -> Result<Result<Verified, Refutation>, SessionError> {
    let mut study = study.clone();
    gains.complete(&mut study).map_err(SessionError::other)?;
    let text = gains.to_json().map_err(SessionError::other)?;
    let subject = (gains, certificate);
    Ok(certificate
        .verified(gains)
        .and_then(|verified| derived_again(verified, subject, (&study, seed_of(&text, 0)), share)))
}

/// The claims with all that is derived a second time from the study.
fn derived_again(
    mut verified: Verified,
    (gains, certificate): (&Gains, &Certificate),
    (study, seed): (&Study, u64),
    share: &(dyn Fn(f64) + Sync),
) -> Result<Verified, Refutation> {
    verified.derived = certificate.derive(gains, study)?;
    verified.unkept = certificate.clauses_of_joints(study);
    verified.tube = derived_tube((gains, certificate), study, share)?;
    verified.class = certificate.derive_class(gains, study, seed)?;
    Ok(certificate.concluded(verified, gains))
}

/// Bound on the error of gains for a study, derived a second time, for the record of a run; `None`: the gains carry no
/// certificate. Takes seconds; `share` is called with the part that is done.
pub(crate) fn recorded_bound(
    gains: &Gains,
    study: &Study,
    share: &(dyn Fn(f64) + Sync),
) -> Result<Option<RecordedBound>, SessionError> {
    let Some(certificate) = &gains.certificate else { return Ok(None) };
    let none =
        |words| RecordedBound { verdict: Verdict::NotProved, error_bound_rad: vec![], words };
    Ok(Some(match twice((gains, certificate), study, share)? {
        Err(why) => none(format!("a claim does not hold: {why}")),
        Ok(verified) if !verified.bounded => none(certificate.without_bound().unwrap_or_default()),
        Ok(verified) => {
            let verdict = weakest(&verified);
            let error_bound_rad =
                verified.error_bounds.iter().map(|own| own.error_bound_rad).collect();
            let least = verified.error_bounds.iter().find(|own| own.verdict == verdict);
            let words = least.map_or_else(String::new, |own| own.basis.clone());
            RecordedBound { verdict, error_bound_rad, words }
        }
    }))
}

/// Largest bound of gains for the motion of their tube, as the file claims it.
pub fn tube_standing(gains: &Gains) -> Option<BoundStanding> {
    let tube = gains.certificate.as_ref()?.tube.as_ref()?;
    let joints = tube.joints.iter().map(|joint| (&*joint.name, joint.error_bound_rad));
    BoundStanding::of(&joints.collect::<Vec<_>>(), Verdict::NotProved, gains)
}
