//! Proof of a range of inertia within a time.

use std::time::Duration;

use phihat_certificate::{ArmInertia, RangeProof, RangeUnproved};
use phihat_study::Study;

use crate::shown::spinner;

/// The range of inertia of a study's arm, proved as far as it comes in so many seconds.
pub(crate) fn timed_proof(
    study: &Study,
    stated: &ArmInertia,
    seconds: f64,
) -> Result<RangeProof, RangeUnproved> {
    let time = Duration::from_secs_f64(seconds.min(1e6));
    let bar = spinner();
    let proof = RangeProof::of(study, stated, &mut |proof| {
        if let Some(step) = proof.step {
            let (to, done) = (100.0 * (step.factor - 1.0), 100.0 * step.done);
            let message = format!("range of inertia to {to:.1} %: {done:.1} % of all postures");
            bar.set_message(message);
            bar.tick();
        }
        bar.elapsed() < time
    });
    bar.finish_and_clear();
    proof
}
