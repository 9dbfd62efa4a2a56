#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! A study taken through gains, a closed loop and its record.
//!
//! [`Session`] is a study and its gains, ready to run; [`Done`] the finished run, whose record it leaves in a
//! folder; [`RunRecord`] such a record, read back. [`OutsideRun`] is a study under an external controller,
//! [`Serve`] its world behind a robot's interface. [`designed`] has gains found by `phihat-synthesis`, [`verify`]
//! checks them. The command line and the Python package are made of these, as any other program can be.
//!
//! [`disk`] is how results are written: whole or not at all, by one process at a time in a folder.
#![forbid(unsafe_code)]

mod arm;
mod audit;
mod begin;
mod budget;
mod check;
mod confirmed;
mod contact;
mod design;
mod dice;
pub mod disk;
mod drawn_worlds;
mod driven;
mod edit;
mod error;
pub mod files;
mod first_motion;
mod hash;
mod identify;
mod layout;
mod log;
mod log_layout;
mod motion_bound;
mod observer;
mod origin;
mod outside;
mod page;
mod record;
mod referred;
mod renamed;
mod rigid;
mod run_record;
mod second_tube;
mod served;
mod served_record;
mod session;
mod unfinished;
mod verify;
mod watch;
mod words;

pub use arm::arm as drawn_arm;
pub use audit::{Assumption, Audit, AuditRow, Standing, audit, audited};
pub use begin::{
    ArmOptions, BeginOptions, Begun, ambiguity_text, begin, begun, described, recognition_text,
    write_arm,
};
pub use budget::{BudgetFiles, write_budget};
pub use check::{Mistake, StudyCheck, check, check_rewritten, check_text};
pub use contact::{contact_lines, contact_watch};
pub use design::{
    arm, beside_limits, budget, designed, designed_for, designed_in_steps, read, study_of_texts,
};
pub use dice::Dice;
pub use drawn_worlds::{DrawnRuns, WORLDS};
pub use driven::{DrivenSession, Leave, Take};
pub use edit::{append, set};
pub use error::SessionError;
pub use files::read_gains;
pub use first_motion::{
    FIRST_WIDTH, FirstMeasured, FirstMotion, FirstMotionError, FirstStudy, MeasuredJoint,
    NarrowedArm, first_measured, first_study, narrowed_arm,
};
pub use hash::{sha256, share, short_hash};
pub use identify::{
    Identification, IdentifiedJoint, IdentifyOptions, UndeterminedJoint, identify, identify_moving,
};
pub use layout::TraceKind;
pub use log::LOGS;
pub use log_layout::log_layout;
pub use motion_bound::{JointOfMotion, MotionBound, MotionClause, REST_SHARE};
pub use observer::{RunFigures, error_shares, share_entries};
pub use origin::{how_to_recover, is_unfinished, trace_at};
pub use outside::OutsideRun;
pub use page::write_report;
pub use phihat_certificate::extremes::Extremes;
pub use phihat_report::RecordedBound;
pub use record::Done;
pub use referred::referred;
pub use rigid::rigid_joints;
pub use run_record::{RunRecord, are_of_a_run, recorded, report_again};
pub use second_tube::tube_reference;
pub use served::{Serve, ServeOptions, ServeWatch};
pub use served_record::ServedMotion;
pub use session::{RunOptions, Session};
pub use unfinished::{LOST_MAX_S, Recovered, none_unfinished, recover};
pub use verify::{
    BoundStanding, Checked, Verification, VerifyStage, class_standing, tube_standing, verify,
};
pub use watch::{Watch, threads};
pub use words::stopped;
