//! The fault matrix: faults × arms × orders × severities × seeds, each run against its bar.
//!
//! Every run is a study: the arm's own with one thing changed, so that `phihat run` repeats it. What goes
//! wrong and what must come of it is one table, [`FAULTS`]; the onset, the joint and the sign of a run are
//! drawn from its name.

mod case;
mod catalogue;
mod cell;
mod change;
mod matrix;
mod options;
mod seen;
mod summary;

pub use case::{CaseName, FaultCase};
pub use catalogue::{Bar, CatalogueFault, FAULTS, RequiredEnd, SEVERITIES};
pub use cell::{FaultCell, STOP_SAMPLES};
pub use matrix::{Choose, FaultMatrix, FaultedArm, FaultsError, MatrixExtent};
pub use options::{FaultsAnswer, FaultsOptions};
pub use seen::BRAKE_S;
pub use summary::{
    EXCURSION_SHARE, FORMAT, FaultArmRecord, FaultRecord, FaultRunRecord, Miss, Summary, Totals,
};
