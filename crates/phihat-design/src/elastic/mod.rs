//! Elastic joints: the springs that a law bears, how stiff they have to be, and a slower law.
//!
//! Theorem C of docs/theory/elastic.md: rotor, spring, drive and law of a joint are one scalar `L″` to the links. The
//! search here tries points of frequency and stiffness; its result is a claim
//! ([`ElasticJoints`](phihat_certificate::ElasticJoints)) only once its own check, by cells, has shown it.

mod actuator;
mod find;
mod grid;
mod refusal;
mod slower;
mod softest;

pub use find::{FindElastic, links_of, softest_springs};
pub use refusal::{ElasticRefusal, SpringNeeds, SpringRefusal};
pub use slower::slower;
pub use softest::SPREAD;
