//! The plan of a comparison at equal noise: its laws and searches, and how they are done.

use std::path::{Path, PathBuf};

use phihat_campaign::{Journal, Progress, RunEnded, Shard, run_all};
use phihat_rivals::{Entry, RIVALS};
use phihat_session::short_hash;

use super::extent::FrontsExtent;
use super::gather;
use super::job::{Job, JobRecord, NamedLaw};
use super::record::{ChosenGains, Fronts, HeldOut};
use super::tier::Tier;
use crate::arm_case::ArmCase;
use crate::error::CompareError;
use crate::plan::with_edition;
use crate::protocol::{AssessedRun, Assessor, Split, draw, hardest};

/// Raised when the same search would come out otherwise: journals of before are then done again.
const EDITION: &str = "fronts 3";

/// Laws of few scalars whose searches end well: in each tier the first of them is compared with itself under
/// a second name.
const TWICE: [&str; 4] = ["industrial-pid", "time-delay", "proposed-1", "computed-torque-integral"];

/// A comparison at equal noise, ready to run.
#[derive(Debug)]
pub struct FrontsPlan {
    /// The one that laws are tuned on, and one that they are not.
    arms: Vec<ArmCase>,
    laws: Vec<NamedLaw>,
    /// Extent of the comparison.
    pub extent: FrontsExtent,
}

impl FrontsPlan {
    /// For a study and, if one is named, another whose arm nothing is tuned on; `only`: ids of laws, none for all.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: a study cannot be read, there is no such law, or none is left to be compared.
    pub fn new(
        study: &Path,
        held_out: Option<&PathBuf>,
        only: &[String],
        extent: FrontsExtent,
    ) -> Result<Self, CompareError> {
        let studies = std::iter::once(study).chain(held_out.map(PathBuf::as_path));
        let told = |path| ArmCase::read(path).map(ArmCase::told_of_drawn);
        let arms = studies.map(told).collect::<Result<_, _>>()?;
        Ok(Self { arms, laws: laws(only)?, extent })
    }

    /// Its searches: every law as often as it is begun anew; laws of all kinds in turn.
    fn jobs(&self) -> Vec<Job> {
        let restarts = |law: usize| {
            let designed = self.laws[law].entry.scalars.is_empty();
            if designed { 1 } else { self.extent.restarts }
        };
        (0..self.extent.restarts)
            .flat_map(|restart| (0..self.laws.len()).map(move |law| Job { law, restart }))
            .filter(|job| job.restart < restarts(job.law))
            .collect()
    }

    /// Searches, and runs of the simulator that they take where all margins are tried and no range gives way.
    pub fn size(&self) -> (usize, u64) {
        let [train, validation, test] = self.extent.worlds.map(u64::from);
        let caps = self.extent.caps.len() as u64;
        let jobs = self.jobs();
        let runs = |job: &Job| {
            let scalars = self.arms[0].free(self.laws[job.law].entry).0.len();
            // A world, and the two trials of its margin.
            3 * train * self.extent.evaluations(scalars) as u64 + caps * (3 * validation + test)
        };
        (jobs.len(), jobs.iter().map(runs).sum())
    }

    /// Does the searches of a shard that the journal does not hold, on `threads` threads. The answer of the
    /// whole does not depend on their number, on interruptions, or on the division into shards; a shard that
    /// is not the whole has none.
    ///
    /// # Errors
    ///
    /// [`CompareError::Journal`] when the journal cannot be written.
    pub fn run(
        &self,
        journal: &mut Journal,
        shard: Shard,
        threads: usize,
        mut progress: impl FnMut(Progress),
    ) -> Result<Option<Fronts>, CompareError> {
        let mut jobs = self.jobs();
        if shard != Shard::WHOLE {
            let own = |place: usize| place as u64 % shard.of == shard.part - 1;
            jobs = (0..).zip(jobs).filter(|(place, _)| own(*place)).map(|(_, job)| job).collect();
        }
        let ids: Vec<_> = jobs.iter().map(|job| self.id(job)).collect();
        let search = |place: usize| self.search(&jobs[place]);
        let done = run_all(&ids, journal, threads, &search, &mut progress)?;
        if shard != Shard::WHOLE {
            return Ok(None);
        }
        let mut fronts = gather::fronts(&self.arms[0], (&self.laws, &self.extent), &jobs, done);
        fronts.held_out = self.elsewhere(&fronts, (journal, threads), &mut progress)?;
        Ok(Some(fronts))
    }

    fn search(&self, job: &Job) -> JobRecord {
        match self.extent.search(&self.arms[0], self.laws[job.law], job.restart) {
            Ok(searched) => JobRecord::Searched(searched),
            Err(why) => JobRecord::Refused(why.to_string()),
        }
    }

    /// Equal ids, equal outcomes.
    fn id(&self, job: &Job) -> String {
        let (law, extent) = (self.laws[job.law], &self.extent);
        let how = format!(
            "{:?} {} {} {} {} {:?} {:?} {}",
            extent.caps,
            job.restart,
            law.stream,
            extent.per_scalar,
            extent.widenings,
            extent.worlds,
            extent.span,
            extent.seed
        );
        let scalars = format!("{:?}", self.arms[0].free(law.entry));
        let version = env!("CARGO_PKG_VERSION");
        let (sum, name) = (&self.arms[0].study.sha256, &self.arms[0].name);
        let mut parts = vec![EDITION, version, sum, name, law.entry.card.id, &scalars, &how];
        let told = format!("told {:?}", hardest());
        if law.entry.needs.designed {
            parts.push(&told);
        }
        short_hash(&with_edition(&parts, law.entry.edition))
    }

    /// The chosen gains on the arm that nothing was tuned on, in its own test worlds.
    fn elsewhere(
        &self,
        fronts: &Fronts,
        (journal, threads): (&mut Journal, usize),
        progress: &mut impl FnMut(Progress),
    ) -> Result<Option<HeldOut>, CompareError> {
        let Some(arm) = self.arms.get(1) else { return Ok(None) };
        let worlds = draw(self.extent.seed, Split::Test, self.extent.worlds[2]);
        let mut tried = Vec::new();
        for point in &fronts.points {
            let law = self.laws.iter().find(|law| law.stream == 1 && law.id() == point.law);
            let chosen = point.chosen.as_ref();
            let restart =
                chosen.and_then(|c| point.restarts.iter().find(|r| r.restart == c.restart));
            if let (Some(law), Some(restart)) = (law, restart) {
                tried.push((law.entry, point.cap, restart.values.clone()));
            }
        }
        let assessor = Assessor::new(arm, &worlds, self.extent.span, None)?;
        let id = |(entry, _, values): &(&Entry, f64, Vec<f64>)| {
            let (values, worlds) =
                (format!("{values:?}"), format!("{worlds:?} {:?}", self.extent.span));
            let parts = ["held out", EDITION, &arm.study.sha256, entry.card.id, &values, &worlds];
            short_hash(&with_edition(&parts, entry.edition))
        };
        let ids: Vec<_> = tried.iter().map(id).collect();
        let measure = |place: usize| {
            let (entry, _, values) = &tried[place];
            assessor.measured(entry, values)
        };
        let found =
            run_all::<Vec<Option<AssessedRun>>>(&ids, journal, threads, &measure, progress)?;
        let mut points = Vec::new();
        for ((entry, cap, _), ended) in tried.iter().zip(found) {
            if let RunEnded::With(test) = ended {
                points.push((entry.card.id.to_owned(), *cap, ChosenGains::of(0, &test, *cap)));
            }
        }
        Ok(Some(HeldOut { arm: arm.record(), points }))
    }
}

/// The laws in the order of the list, then those that are compared with themselves, one of each tier where
/// there is one.
fn laws(only: &[String]) -> Result<Vec<NamedLaw>, CompareError> {
    if let Some(id) = only.iter().find(|id| RIVALS.iter().all(|r| r.card.id != **id)) {
        return Err(CompareError::Rival(id.clone()));
    }
    let asked = |entry: &&Entry| only.is_empty() || only.iter().any(|id| id == entry.card.id);
    let mut laws: Vec<NamedLaw> =
        RIVALS.iter().filter(asked).map(|entry| NamedLaw { entry, stream: 1 }).collect();
    for tier in Tier::ALL {
        let of =
            |law: &&NamedLaw| Tier::of(&law.entry.needs) == tier && !law.entry.scalars.is_empty();
        let rank = |law: &&NamedLaw| {
            TWICE.iter().position(|id| *id == law.entry.card.id).unwrap_or(TWICE.len())
        };
        if let Some(law) = laws.iter().filter(of).min_by_key(rank) {
            laws.push(NamedLaw { stream: 2, ..*law });
        }
    }
    Ok(laws)
}
