//! The linear loop in every interval of the run.

use phihat_model::Model;

use super::linear::{Differences, StepInterval};
use super::nominal::NominalRun;
use super::refusal::TubeRefusal;
use super::scene::Scene;
use phihat_certificate::parallel::parallel;

/// Intervals that one thread takes at a time.
const TOGETHER: usize = 256;

/// Derivatives and steps of every interval, around the nominal run of a model.
pub(super) fn intervals(
    scene: &Scene<'_>,
    nominal: &NominalRun,
    model: &Model,
    threads: usize,
) -> Result<Vec<StepInterval>, TubeRefusal> {
    let starts: Vec<usize> = (0..scene.samples).step_by(TOGETHER).collect();
    let parts = parallel(&starts, threads, |start| {
        let mut differences = Differences::new(model);
        let mut bare = Differences::new(&scene.bare);
        (start..(start + TOGETHER).min(scene.samples))
            .map(|k| StepInterval::new(scene, nominal, k, &mut differences, &mut bare))
            .collect::<Option<Vec<StepInterval>>>()
    });
    let mut all = Vec::with_capacity(scene.samples);
    for part in parts {
        let part = part.ok_or_else(|| {
            TubeRefusal::Payload("the mass matrix is not positive definite".into())
        })?;
        all.extend(part);
    }
    Ok(all)
}
