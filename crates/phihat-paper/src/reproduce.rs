//! Every part of the reproduction, done on threads and put together.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use phihat_session::SessionError;
use phihat_session::disk::DiskError;
use thiserror::Error;

use crate::part::{Extent, PaperPart, PartError};
use crate::record::{Assumption, FORMAT, Reproduction};
use crate::{arm, details, orders, reach, table1, table2, table3, theory};

/// Why the paper could not be reproduced.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// A part could not be done: a fault of this program or of a study.
    #[error("{part}: {why}")]
    Part {
        /// The part.
        part: &'static str,
        /// Cause of the failure.
        why: PartError,
    },
    /// No part's name contains such words.
    #[error("reproduce: no part's name contains {0:?}; parts: {parts}", parts = part_names())]
    NoPartNamed(String),
    /// A part ended in a panic: a fault of this program.
    #[error("reproduce: a part panicked")]
    Panicked,
    /// No part is meant by such words.
    #[error("--only {0:?}: no part is named so, and none has such a section, statement or figure; parts: \
        {parts}", parts = part_names())]
    NoSuchPart(String),
    /// Results cannot be written.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// Results cannot be written.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// The answer cannot be written.
    #[error("{0}")]
    Answer(serde_json::Error),
}

fn part_names() -> String {
    parts().collect::<Vec<_>>().join(", ")
}

/// A part, by name; `progress` is told the share that is done, 0 to 1.
type PartWork = fn(Extent, &dyn Fn(f64)) -> Result<PaperPart, PartError>;

/// Every part, in the order of the page. One line each; long ones first would end sooner, but threads
/// take the next one as they become free.
const PARTS: &[(&str, PartWork)] = &[
    ("theory", theory::theory),
    ("table 1", |_, progress| table1::table1(progress)),
    ("arm in simulation", |extent, progress| {
        arm::simulation(&arm::Studies::shipped(), extent, progress)
    }),
    ("arm in experiment", |extent, progress| {
        arm::experiment(&arm::Studies::shipped(), extent, progress)
    }),
    ("table 2", table2::table2),
    ("figures 12 and 13", orders::orders),
    ("table 3", table3::table3),
    ("order switching", |extent, progress| {
        arm::order_switching(&arm::Studies::shipped(), extent, progress)
    }),
    ("how far does it hold", reach::reach),
];

/// The studies that the parts use: path in the repository (`studies/paper/m1.toml`), as [`Statement`]s
/// name them, and text. A path in a text holds from there.
const STUDIES: &[(&str, &str)] = &{
    let mut all = [("", ""); arm::SHIPPED.len() + table3::SHIPPED.len()];
    let (first, second) = all.split_at_mut(arm::SHIPPED.len());
    first.copy_from_slice(arm::SHIPPED);
    second.copy_from_slice(&table3::SHIPPED);
    all
};

/// The studies behind the statements: path, as [`Statement::studies`](crate::Statement::studies) names it, and text.
pub fn studies() -> &'static [(&'static str, &'static str)] {
    STUDIES
}

/// The names of the parts, in the order of the page.
pub fn parts() -> impl Iterator<Item = &'static str> {
    PARTS.iter().map(|(name, _)| *name)
}

/// Does every part on `threads` threads. The answer does not depend on their number.
///
/// # Errors
///
/// [`ReproduceError`] of the first part that could not be done.
pub fn reproduce(
    extent: Extent,
    threads: usize,
    progress: &(impl Fn(&str, f64) + Sync),
) -> Result<Reproduction, ReproduceError> {
    reproduce_only(None, extent, threads, progress)
}

/// [`reproduce`] for the parts whose name contains `only`; all of them where it is `None`.
///
/// # Errors
///
/// [`ReproduceError`] of the first part that could not be done, or no part is named so.
pub fn reproduce_only(
    only: Option<&str>,
    extent: Extent,
    threads: usize,
    progress: &(impl Fn(&str, f64) + Sync),
) -> Result<Reproduction, ReproduceError> {
    let chosen: Vec<_> =
        PARTS.iter().filter(|(name, _)| only.is_none_or(|text| name.contains(text))).collect();
    if let (Some(text), []) = (only, &chosen[..]) {
        return Err(ReproduceError::NoPartNamed(text.to_owned()));
    }
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((name, part)) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
            done.push((*name, part(extent, &|share| progress(name, share))));
        }
        done
    };
    let mut done: Vec<_> = thread::scope(|scope| {
        let threads: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap_or_default()).collect()
    });
    let place = |name: &str| PARTS.iter().position(|(other, _)| *other == name);
    done.sort_by_key(|(name, _)| place(name));
    let mut whole = Reproduction {
        format: FORMAT,
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        quick: extent.quick,
        only: only.map(str::to_owned),
        assumptions: Vec::new(),
        sections: Vec::new(),
    };
    if done.len() < chosen.len() {
        return Err(ReproduceError::Panicked);
    }
    for (part, result) in done {
        let result = result.map_err(|why| ReproduceError::Part { part, why })?;
        for assumption in result.assumptions {
            whole.assume(assumption);
        }
        whole.sections.extend(result.sections);
    }
    details::add(&mut whole.sections);
    whole.round();
    Ok(whole)
}

impl Reproduction {
    /// Adds an assumption. Where another part has made it too, what either measured of its influence counts.
    fn assume(&mut self, assumption: Assumption) {
        match self.assumptions.iter_mut().find(|other| other.id == assumption.id) {
            None => self.assumptions.push(assumption),
            Some(other) if other.influence.is_empty() => other.influence = assumption.influence,
            Some(other) if !other.influence.contains(&assumption.influence) => {
                other.influence = format!("{} {}", other.influence, assumption.influence);
            }
            Some(_) => {}
        }
    }
}
