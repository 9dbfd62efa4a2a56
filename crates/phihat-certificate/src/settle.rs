//! When the steady part of a run begins, and why then.

use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::Tube;

/// When the steady part of a run begins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settle {
    /// From when on the specification is held against the run \[s\].
    pub settle_s: f64,
    /// Source of that time.
    pub from: SettleFrom,
}

/// Source of the time at which the steady part begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SettleFrom {
    /// The study states it.
    Study,
    /// The study does not: from then on the tube stays inside the specification.
    Tube,
    /// The study does not, and the tube never keeps the specification: from then on it is at its own level.
    TubeLevel,
    /// The study does not, and there is no tube: the default.
    Default,
}

impl Settle {
    /// When the steady part of a study's run begins, as far as its tube tells.
    pub fn of(study: &Study, tube: Option<&Tube>) -> Self {
        let stated = |from| Self { settle_s: study.spec.settle, from };
        if study.spec.settle_stated {
            return stated(SettleFrom::Study);
        }
        let Some(tube) = tube else { return stated(SettleFrom::Default) };
        let bound = study.spec.error_bound.as_ref();
        match bound.and_then(|bound| tube.settled(bound)) {
            Some(settle_s) => Self { settle_s, from: SettleFrom::Tube },
            None => Self { settle_s: tube.own_settled(), from: SettleFrom::TubeLevel },
        }
    }
}
