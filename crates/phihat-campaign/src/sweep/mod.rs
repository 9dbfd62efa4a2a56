//! Monte Carlo over the numbers of a study: every run draws them anew, and the results have confidence
//! intervals.
//!
//! A run is the study with a seed and values of its own, which depend on the sweep's seed and the run's
//! number alone: the number of threads, of shards and of interruptions changes no byte of the answer.
//!
//! # Example
//!
//! ```no_run
//! use phihat_campaign::sweep::{SweepAnswer, SweepOptions};
//!
//! let options = SweepOptions {
//!     study: "studies/panda.toml".into(),
//!     vary: vec!["world.payload.mass_kg=0..2".to_owned(), "world.coulomb_extra_nm=log:0.05..1".to_owned()],
//!     runs: 1000,
//!     ..SweepOptions::default()
//! };
//! if let SweepAnswer::Whole(swept) = options.run(&mut ())? {
//!     println!("{} of {} runs kept every bound", swept.summary.totals.within_spec, swept.summary.runs);
//! }
//! # Ok::<(), phihat_campaign::sweep::SweepError>(())
//! ```
//!
//! # Not claimed
//!
//! A share of runs is no certificate: what was not drawn was not tried.

mod error;
mod options;
mod page;
mod plan;
mod plot;
mod row;
mod summary;
mod vary;

pub use error::{RunError, SweepError};
pub use options::{SweepAnswer, SweepOptions, SweptWhole, merge};
pub use plan::SweepPlan;
pub use row::{FIGURES, FigureKind, SweepColumns, SweepEnd, SweepRow};
pub use summary::{
    FORMAT, FigureRecord, Quantile, SweepSummary, SweepTotals, VaryRecord, WorstRun,
};
pub use vary::Vary;
