//! Why no gains keep every clause, and what would be possible.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::advice::Alternative;
use super::search::DesignSearch;
use super::verdict::{KEYS, Nearest};
use crate::{Gains, TradeOff};

/// Why no gains keep every clause.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Infeasible {
    /// The clauses in the way, each with the nearest value that is possible if all others stand.
    pub clauses: Vec<Clause>,
    /// Changes of the loop, each of which alone makes it feasible; tried out and certified.
    pub alternatives: Vec<Alternative>,
    /// Number of laws of the grid that were tried.
    pub tried: u32,
    /// Number of the laws, each with up to three nominal inertias, that satisfy window and modulus margin.
    pub stable: u32,
    /// Result in plain words.
    #[serde(default)]
    pub words: Vec<String>,
    /// The front of error against torque noise of the laws that keep window and margin.
    #[serde(default)]
    pub front: Vec<TradeOff>,
    /// True if no law keeps a clause, by an inequality: there is nothing to search for.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub beyond_any_law: bool,
    /// The law that misses the least, without a certificate; no document holds it.
    #[serde(skip)]
    pub nearest: Option<Box<Gains>>,
}

impl fmt::Display for Infeasible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "NO GAINS keep what the study asks for")?;
        for clause in &self.clauses {
            let joint = clause.joint.as_ref().map_or_else(String::new, |j| format!(" on {j}"));
            let possible = clause.possible.map_or_else(
                || "no value alone makes it possible".to_owned(),
                |value| format!("{value:.3e} is possible while all others stand"),
            );
            write!(f, "\n  {}{joint}: {:.3e} is wanted, {possible}", clause.key, clause.wanted)?;
        }
        for words in &self.words {
            write!(f, "\n  {words}")?;
        }
        for other in &self.alternatives {
            if other.key == "robot.armature_kg_m2" {
                write!(
                    f,
                    "\n  light joints have no rotor: with a {} of at least {} on every joint there are gains, of order \
                        {}",
                    other.key, other.value, other.order
                )?;
                continue;
            }
            write!(
                f,
                "\n  or {} = {}: then there are gains, of order {}",
                other.key, other.value, other.order
            )?;
        }
        Ok(())
    }
}

impl Infeasible {
    /// Summary of the search in one sentence.
    pub fn searched(&self) -> String {
        format!(
            "{} laws tried, with up to three nominal inertias each; {} keep the stability window μ with \
             design.window_margin and |1 + L/μ| ≥ design.modulus_margin_min",
            self.tried, self.stable
        )
    }
}

/// The search's estimates are up to 2 % low.
const SURE: f64 = 1.02;

/// One clause of the specification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Clause {
    /// Key of the clause in the study.
    pub key: String,
    /// The joint that decides; `None`: the arm.
    pub joint: Option<String>,
    /// Value that the study requests.
    pub wanted: f64,
    /// The nearest value that is possible while all other clauses stand; `None`: none is.
    pub possible: Option<f64>,
}

impl DesignSearch<'_> {
    /// The clauses in the way.
    pub(super) fn clauses(&self, nearest: &Nearest) -> Vec<Clause> {
        let Some(any) = nearest.any else {
            let wanted = self.study.design.window_margin;
            let key = "design.window_margin".to_owned();
            return vec![Clause { key, joint: None, wanted, possible: None }];
        };
        let clause = |i: usize| {
            let found = nearest.alone[i];
            // The error is always told, were it only for the joint that decides.
            let (share, joint) = found.or((i == 0).then_some(any))?;
            let wanted = self.limit(i)?.get(joint).copied()?;
            Some(Clause {
                key: self.key(i, joint).to_owned(),
                joint: Some(self.study.robot.joints[joint].name.clone()),
                wanted,
                possible: found.map(|_| wanted * share * SURE),
            })
        };
        (0..KEYS.len()).filter_map(clause).collect()
    }
}
