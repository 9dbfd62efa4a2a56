//! The plan of a comparison: what runs, in which order.

use std::path::PathBuf;

use phihat_rivals::{Entry, RIVALS};

use super::case::Case;
use super::ground::{CompareError, Ground};
use super::prepare::{Prepared, drawn, tuned};
use super::record::Comparison;
use super::row::{GainsKind, TuningRecord};
use super::rows;
use super::world::{WORLDS, World, world};
use phihat_campaign::Journal;
use phihat_campaign::{Ended, Progress, run_all};
use phihat_session::short_hash;

/// Raised when the same run would come out otherwise: journals of before are then done again.
pub(crate) const EDITION: &str = "compare 5";

/// How much is done.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Ids of rivals; empty: all.
    pub only: Vec<String>,
    /// Names of worlds; empty: all.
    pub worlds: Vec<String>,
    /// Motions that are scored: the study's own, and drawn ones.
    pub seeds: u64,
    /// Evaluations of every tuning.
    pub tuning_runs: usize,
    /// Motions of an evaluation, each in every world that is trained in.
    pub training_motions: u64,
    /// Their length \[s\].
    pub training_s: f64,
    /// Where they begin to count \[s\].
    pub training_settle_s: f64,
    /// Draws of gains.
    pub draws: usize,
    /// Most seconds after `settle_s` that are scored.
    pub scored_max_s: f64,
}

impl Extent {
    /// For a first look: some minutes.
    pub fn quick() -> Self {
        Self {
            only: Vec::new(),
            worlds: Vec::new(),
            seeds: 1,
            tuning_runs: 60,
            training_motions: 1,
            training_s: 3.0,
            training_settle_s: 1.5,
            draws: 24,
            scored_max_s: 3.0,
        }
    }

    /// For the record: most of an hour.
    pub fn full() -> Self {
        Self {
            seeds: 3,
            tuning_runs: 300,
            training_motions: 2,
            training_s: 4.0,
            draws: 100,
            scored_max_s: f64::INFINITY,
            ..Self::quick()
        }
    }
}

/// A comparison, ready to run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The arms.
    pub grounds: Vec<Ground>,
    /// The rivals, in the order of the table.
    pub rivals: Vec<&'static Entry>,
    /// The worlds, from easy to hard.
    pub worlds: Vec<&'static World>,
    /// How much is done.
    pub extent: Extent,
}

/// What is known of an arm and a rival before the runs that count.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    pub(crate) tuning: Result<TuningRecord, String>,
    pub(crate) share: f64,
}

impl Plan {
    /// Reads the studies and finds rivals and worlds by name.
    ///
    /// # Errors
    ///
    /// [`CompareError`]
    pub fn new(studies: &[PathBuf], extent: Extent) -> Result<Self, CompareError> {
        let mut rivals: Vec<&'static Entry> = RIVALS.iter().collect();
        if let Some(id) = extent.only.iter().find(|id| rivals.iter().all(|r| r.card.id != **id)) {
            return Err(CompareError::Rival(id.clone()));
        }
        rivals.retain(|r| extent.only.is_empty() || extent.only.iter().any(|id| id == r.card.id));
        Self::of(studies, rivals, extent)
    }

    /// The same for rivals that need not be in the list.
    ///
    /// # Errors
    ///
    /// [`CompareError`]
    pub fn of(
        studies: &[PathBuf],
        rivals: Vec<&'static Entry>,
        extent: Extent,
    ) -> Result<Self, CompareError> {
        if let Some(name) = extent.worlds.iter().find(|name| world(name).is_none()) {
            return Err(CompareError::World(name.clone()));
        }
        let chosen = |world: &&World| {
            extent.worlds.is_empty() || extent.worlds.iter().any(|name| name == world.name)
        };
        let worlds = WORLDS.iter().filter(chosen).collect();
        let mut grounds: Vec<Ground> = Vec::new();
        for path in studies {
            let ground = Ground::read(path)?;
            if grounds.iter().any(|other| other.name == ground.name) {
                let why = "another study of the comparison has the same name".into();
                return Err(CompareError::Unfit { path: path.clone(), why });
            }
            grounds.push(ground);
        }
        Ok(Self { grounds, rivals, worlds, extent })
    }

    /// Does everything that the journal does not hold, on `threads` threads. The answer does not depend on
    /// their number, nor on interruptions.
    ///
    /// `progress` is told of both parts, preparation and runs that count, in one figure.
    ///
    /// # Errors
    ///
    /// [`CompareError::Journal`] when the journal cannot be written.
    pub fn run(
        &self,
        journal: &mut Journal,
        threads: usize,
        mut progress: impl FnMut(Progress),
    ) -> Result<Comparison, CompareError> {
        let pairs = self.pairs();
        let cases = self.cases();
        let later = cases.len();
        // Tunings and draws in turn.
        let jobs: Vec<_> =
            pairs.iter().flat_map(|(g, r)| [(*g, *r, false), (*g, *r, true)]).collect();
        let ids: Vec<_> = jobs.iter().map(|job| self.preparation_id(*job)).collect();
        let prepare = |place: usize| {
            let (ground, rival, draws) = jobs[place];
            let (ground, entry) = (&self.grounds[ground], self.rivals[rival]);
            let how = if draws { drawn } else { tuned };
            how(ground, entry, &self.extent)
        };
        let whole = |p: Progress| Progress { all: p.all + later, ..p };
        let prepared = run_all(&ids, journal, threads, &prepare, |p| progress(whole(p)))?;
        let known: Vec<Known> = prepared.chunks(2).map(known).collect();
        let before = jobs.len();
        let ids: Vec<_> = cases.iter().map(|case| self.case_id(case, &known)).collect();
        let score = |place: usize| self.score(&cases[place], &known);
        let whole = |p: Progress| Progress {
            resumed: p.resumed + before,
            done: p.done + before,
            all: p.all + before,
        };
        let scored = run_all(&ids, journal, threads, &score, |p| progress(whole(p)))?;
        Ok(rows::comparison(self, &known, &cases, scored))
    }

    /// Every arm with every rival.
    pub(crate) fn pairs(&self) -> Vec<(usize, usize)> {
        let rivals = 0..self.rivals.len();
        (0..self.grounds.len()).flat_map(|g| rivals.clone().map(move |r| (g, r))).collect()
    }

    /// The names of the runs that count, in the order of the answer.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.cases().into_iter().map(|case| self.name(&case))
    }

    /// Every run that counts, in the order of the answer.
    pub(crate) fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for (ground, rival) in self.pairs() {
            for world in 0..self.worlds.len() {
                for gains in [GainsKind::Default, GainsKind::Tuned] {
                    for seed in 1..=self.extent.seeds {
                        cases.push(Case { ground, rival, world, gains, seed });
                    }
                }
            }
        }
        cases
    }

    /// Equal ids, equal outcomes: an edition, the arm's text, the rival's scalars, the extent of the preparation.
    fn preparation_id(&self, (ground, rival, draws): (usize, usize, bool)) -> String {
        let (ground, entry, extent) = (&self.grounds[ground], self.rivals[rival], &self.extent);
        let training = (extent.training_motions, extent.training_s, extent.training_settle_s);
        let count = if draws { extent.draws } else { extent.tuning_runs };
        short_hash(&[
            EDITION,
            env!("CARGO_PKG_VERSION"),
            &ground.study.sha256,
            &ground.name,
            entry.card.id,
            &format!("{:?}", entry.scalars),
            &format!("{draws} {count} {training:?}"),
        ])
    }

    /// How long a run that counts is, and where its scored part begins \[s\].
    pub(crate) fn span(&self, ground: usize) -> (f64, f64) {
        let study = &self.grounds[ground].study;
        let settle = study.spec.settle;
        (study.duration.min(settle + self.extent.scored_max_s), settle)
    }
}

/// What a tuning and the draws after it came to.
fn known(pair: &[Ended<Prepared>]) -> Known {
    let mut known = Known { tuning: Err("it was not tuned".to_owned()), share: 0.0 };
    for ended in pair {
        match ended {
            Ended::With(Prepared::Tuned(record)) => known.tuning = Ok(record.clone()),
            Ended::With(Prepared::Drawn(share)) => known.share = *share,
            Ended::With(Prepared::Refused(why)) => known.tuning = Err(why.clone()),
            Ended::Panicked(why) => known.tuning = Err(format!("the program panicked: {why}")),
        }
    }
    known
}
