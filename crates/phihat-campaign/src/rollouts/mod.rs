//! Many runs of one study, with numbers and seeds given for each run; the results are arrays in memory.
//!
//! [`sweep`](crate::sweep) draws numbers and writes files; a rollout gets its numbers and returns arrays, for
//! learning, tuning and robustness checks. Runs of one structure are simulated in lanes, as in a
//! [`Batch`](phihat_sim::Batch).
//!
//! # Law
//!
//! Run `k` is the study with its numbers in their places and its seed: [`Rollouts::study`] returns it.
//! Figures and signals are those of its own simulation with [`Rollouts::gains`], to the last bit (up to the
//! sign of a zero), on any number of threads.
//!
//! # Example
//!
//! ```
//! use phihat_campaign::rollouts::{Keep, RunNumbers, Rollouts};
//! use phihat_study::Study;
//!
//! # let text = "duration_s = 0.2\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.1\n\
//! #     [gains]\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\n\
//! #     inertia_kg_m2 = [0.42, 0.18, 0.14]\n[reference]\nkind = \"hold\"\npose = \"ready\"\n";
//! let study = Study::from_text(text, "demo.toml", "".as_ref())?;
//! let payload = RunNumbers {
//!     name: "payload_kg".to_owned(),
//!     paths: vec!["world.payload.mass_kg".to_owned()],
//!     values: vec![0.1, 0.2, 0.3],
//! };
//! let told = (vec![payload], None);
//! let rollouts = Rollouts::new((Box::new(study), "demo.toml".as_ref()), None, told, 3, false)?;
//! let rolled = rollouts.run(&Keep::default(), Some(1), &mut |_done, _all| true)?;
//! let errors = rolled.figure("error_steady_max_rad").unwrap();
//! assert!(errors.len() == 3 * 3 && errors[0] < errors[6]); // three runs of three joints: more load, more error
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Not claimed
//!
//! Gains are chosen and checked once, for the study as it stands. Nothing is certified about its runs.

mod error;
mod rolled;
mod told;
mod work;

pub use error::RolloutsError;
pub use rolled::{JOINT_FIGURES, JointFigure, Keep, Rolled, RolledSignal, SIGNALS, signal};
pub use told::{Rollouts, RunNumbers};
