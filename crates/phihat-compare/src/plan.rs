//! The plan of a comparison: what runs, in which order.

use std::path::PathBuf;

use phihat_rivals::{Entry, RIVALS};

use crate::arm_case::ArmCase;
use crate::case::ComparisonCase;
use crate::error::CompareError;
use crate::extent::ComparisonExtent;
use crate::row::GainsKind;
use crate::world::{ComparisonWorld, WORLDS, world};

/// Raised when the same run would come out otherwise: journals of before are then done again.
pub(crate) const EDITION: &str = "compare 6";

/// Parts of a job's id, with the edition of a law that is not in the list.
pub(crate) fn with_edition<'a>(parts: &[&'a str], edition: &'a str) -> Vec<&'a str> {
    let own = (!edition.is_empty()).then_some(edition);
    parts.iter().copied().chain(own).collect()
}

/// A comparison, ready to run.
#[derive(Debug, Clone)]
pub struct ComparisonPlan {
    /// The arms.
    pub arms: Vec<ArmCase>,
    /// The rivals, in the order of the table.
    pub rivals: Vec<&'static Entry>,
    /// The worlds, from easy to hard.
    pub worlds: Vec<&'static ComparisonWorld>,
    /// Extent of the comparison.
    pub extent: ComparisonExtent,
}

impl ComparisonPlan {
    /// Reads the studies and finds rivals and worlds by name.
    ///
    /// # Errors
    ///
    /// [`CompareError`]
    pub fn new(studies: &[PathBuf], extent: ComparisonExtent) -> Result<Self, CompareError> {
        Self::with(studies, &[], extent)
    }

    /// Reads the studies, and finds rivals by name among those of the list and laws of somebody's own.
    ///
    /// # Errors
    ///
    /// [`CompareError`]; two laws of one name among them.
    pub fn with(
        studies: &[PathBuf],
        own: &[&'static Entry],
        extent: ComparisonExtent,
    ) -> Result<Self, CompareError> {
        let mut rivals: Vec<&'static Entry> = RIVALS.iter().collect();
        for law in own {
            if rivals.iter().any(|other| other.card.id == law.card.id) {
                return Err(CompareError::Taken(law.card.id.to_owned()));
            }
            rivals.push(law);
        }
        if let Some(id) = extent.only.iter().find(|id| rivals.iter().all(|r| r.card.id != **id)) {
            return Err(CompareError::Rival(id.clone()));
        }
        rivals.retain(|r| extent.only.is_empty() || extent.only.iter().any(|id| id == r.card.id));
        Self::of(studies, rivals, extent)
    }

    /// A plan for rivals that need not be in the list.
    ///
    /// # Errors
    ///
    /// [`CompareError`]
    pub fn of(
        studies: &[PathBuf],
        rivals: Vec<&'static Entry>,
        extent: ComparisonExtent,
    ) -> Result<Self, CompareError> {
        if let Some(name) = extent.worlds.iter().find(|name| world(name).is_none()) {
            return Err(CompareError::World(name.clone()));
        }
        let chosen = |world: &&ComparisonWorld| {
            extent.worlds.is_empty() || extent.worlds.iter().any(|name| name == world.name)
        };
        let worlds = WORLDS.iter().filter(chosen).collect();
        let mut arms: Vec<ArmCase> = Vec::new();
        for path in studies {
            let arm = ArmCase::read(path)?;
            if arms.iter().any(|other| other.name == arm.name) {
                let why = "another study of the comparison has the same name".into();
                return Err(CompareError::Unfit { path: path.clone(), why });
            }
            arms.push(arm);
        }
        Ok(Self { arms, rivals, worlds, extent })
    }

    /// Every arm with every rival.
    pub(crate) fn pairs(&self) -> Vec<(usize, usize)> {
        let rivals = 0..self.rivals.len();
        (0..self.arms.len()).flat_map(|g| rivals.clone().map(move |r| (g, r))).collect()
    }

    /// The name of a run.
    pub(crate) fn name(&self, case: &ComparisonCase) -> String {
        let gains = match case.gains {
            GainsKind::Default => "default",
            GainsKind::Tuned => "tuned",
        };
        let (arm, rival) = (&self.arms[case.arm], self.rivals[case.rival]);
        format!(
            "{}/{}/{}/{gains}/{}",
            arm.name, rival.card.id, self.worlds[case.world].name, case.seed
        )
    }

    /// The names of the runs that count, in the order of the answer.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.cases().into_iter().map(|case| self.name(&case))
    }

    /// Every run that counts, in the order of the answer.
    pub(crate) fn cases(&self) -> Vec<ComparisonCase> {
        let mut cases = Vec::new();
        for (arm, rival) in self.pairs() {
            for world in 0..self.worlds.len() {
                for gains in [GainsKind::Default, GainsKind::Tuned] {
                    for seed in 1..=self.extent.seeds {
                        cases.push(ComparisonCase { arm, rival, world, gains, seed });
                    }
                }
            }
        }
        cases
    }

    /// Length of a run that counts, and start of its scored part \[s\].
    pub(crate) fn span(&self, arm: usize) -> (f64, f64) {
        let study = &self.arms[arm].study;
        let settle = study.spec.settle;
        (study.duration.min(settle + self.extent.scored_max_s), settle)
    }
}
