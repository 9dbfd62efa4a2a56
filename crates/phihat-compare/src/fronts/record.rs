//! Results of a comparison at equal noise, as data.

use serde::{Deserialize, Serialize};

use super::extent::FrontsExtent;
use super::tier::{LoopKnowledge, Tier};
use crate::protocol::{Assessed, AssessedRun};
use crate::record::ArmRecord;
use crate::tune::AtEnd;
use phihat_campaign::statistics::{Placebo, Ratio, Spread, Standing};

/// Version of the document.
pub const FRONTS_FORMAT: u32 = 2;

/// A comparison at equal noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fronts {
    /// Version of this document.
    pub format: u32,
    /// Version of phihat.
    pub phihat_version: String,
    /// The arm.
    pub arm: ArmRecord,
    /// Extent of the comparison.
    pub extent: FrontsExtent,
    /// The laws, a law that is held against itself under its second name after all others.
    pub laws: Vec<LawRecord>,
    /// Each law under each cap.
    pub points: Vec<AtCap>,
    /// The area above each law's front.
    pub volumes: Vec<Volume>,
    /// Placebo bands from laws compared with themselves, in the order of the caps.
    pub placebo: Vec<Placebo>,
    /// Laws against this project's best law that knows no more than they do, at equal caps.
    pub versus: Vec<Versus>,
    /// Mean ranks, per tier and cap.
    pub ordered: Vec<Ordered>,
    /// The chosen gains on an arm that nothing was tuned on.
    pub held_out: Option<HeldOut>,
}

/// A law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawRecord {
    /// Its name.
    pub id: String,
    /// Its title.
    pub title: String,
    /// Its knowledge of the arm.
    pub tier: Tier,
    /// Its knowledge of the loop's time.
    pub timing: LoopKnowledge,
    /// Its inputs, in words.
    pub needs: String,
    /// True if it is of this project or its paper.
    pub ours: bool,
    /// True if its gains are designed for the study, with no scalar to search.
    pub designed: bool,
    /// The law whose second name this is.
    pub again: Option<String>,
    /// Names of its free scalars, then of the free choices in its inputs.
    pub scalars: Vec<String>,
}

/// A law under a cap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AtCap {
    /// The law's name.
    pub law: String,
    /// The cap.
    pub cap: f64,
    /// Its searches.
    pub restarts: Vec<Restart>,
    /// The tuning that is best in the validation worlds, in the test worlds; `None` where no search found
    /// gains that satisfy every constraint.
    pub chosen: Option<ChosenGains>,
}

/// A search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Restart {
    /// Number of the restart, from 0.
    pub restart: u64,
    /// Why there is none.
    pub failed: Option<String>,
    /// Values of the law's scalars, then of the free choices in its inputs.
    pub values: Vec<f64>,
    /// In the training worlds.
    pub train: Option<Assessed>,
    /// In the validation worlds.
    pub validation: Option<Assessed>,
    /// Evaluations of the search, under all caps.
    pub evaluations: usize,
    /// The least cost after so many of them, where it fell.
    pub history: Vec<(usize, f64)>,
    /// Number of times that ranges were widened.
    pub widened: usize,
    /// Ends of ranges that values are at all the same.
    pub at_end: Vec<AtEnd>,
    /// In the test worlds; `None`: it did not follow there.
    pub test: Vec<Option<AssessedRun>>,
    /// The tighter cap whose gains these are, where they are better in the validation worlds than those of this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_cap: Option<f64>,
}

impl Restart {
    /// Returns true if the tuning satisfies every constraint in the training worlds.
    pub fn feasible(&self) -> bool {
        self.train.is_some_and(|train| train.feasible())
    }
}

/// Gains in the test worlds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChosenGains {
    /// Number of the restart.
    pub restart: u64,
    /// Errors \[rad\]; where it did not follow 1 rad.
    pub error_rad: Option<Spread>,
    /// Noise where it followed, over the torque limit.
    pub noise: Option<Spread>,
    /// Share of test worlds in which it did not follow.
    pub failed: f64,
    /// Share of test worlds in which its noise is above the cap.
    pub above_cap: f64,
}

/// The area above a front of error against noise, both in natural logarithms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Volume {
    /// The law's name.
    pub law: String,
    /// The area; larger is better.
    pub area: f64,
    /// Its interval over worlds and restarts.
    pub interval: [f64; 2],
}

/// A law against ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Versus {
    /// The tier.
    pub tier: Tier,
    /// The cap.
    pub cap: f64,
    /// The law's name.
    pub law: String,
    /// Law of this project that it is compared with: of those that know no more of the arm, of the delay and of the
    /// reference ahead, the best in the validation worlds.
    pub ours: String,
    /// Its errors over ours.
    pub ratio: Ratio,
    /// The p-value, corrected for all questions.
    pub corrected_p: f64,
    /// Conclusion from ratio and p-value.
    pub standing: Standing,
}

/// Laws of a tier at a cap by their ranks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ordered {
    /// The tier.
    pub tier: Tier,
    /// The cap.
    pub cap: f64,
    /// Names and mean ranks, the best first.
    pub laws: Vec<(String, f64)>,
    /// Least distance of mean ranks that differ at 5 %.
    pub critical_difference: f64,
    /// Friedman's statistic.
    pub friedman: f64,
}

/// Another arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// The arm.
    pub arm: ArmRecord,
    /// Each law at each cap that has chosen gains: law, cap, what it measures.
    pub points: Vec<(String, f64, ChosenGains)>,
}
