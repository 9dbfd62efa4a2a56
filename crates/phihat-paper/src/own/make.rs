//! Every part, put together.

use std::path::Path;

use phihat_study::Study;

use super::error::OwnError;
use super::law::Own;
use super::phi::OwnPhi;
use super::record::{LeftOutOfPaper, OWN_FORMAT, OwnReproduction};
use super::{orders, table3};

/// Does it. `phi`: a file with an own φ; `joint`: whose it is, and which is shown.
///
/// # Errors
///
/// [`OwnError`]: the study has no law of the paper, there is no φ, or a run cannot begin.
pub fn own(
    study: Study,
    path: &Path,
    (phi, joint): (Option<&Path>, Option<&str>),
    progress: &dyn Fn(f64),
) -> Result<OwnReproduction, OwnError> {
    let own = Own::new(study, path)?;
    let joint = joint.map(|name| own.joint(name)).transpose()?;
    let runs = table3::Table3Runs::of(&own)?;
    progress(0.6);
    let phi = OwnPhi::of(&own, &runs.proposed, (phi, joint))?;
    let (orders, mut numbers) = orders::orders(&own, &phi, &runs.proposed);
    progress(0.9);
    let (table, more) = table3::section(&own, &runs);
    numbers.extend(more);
    Ok(OwnReproduction {
        format: OWN_FORMAT,
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        study: own.study.name.clone(),
        study_sha256: own.study.sha256.clone(),
        joint: phi.name.clone(),
        phi_from: phi.source.clone(),
        sections: vec![orders, table],
        numbers,
        left_out: left_out(),
    })
}

fn left_out() -> Vec<LeftOutOfPaper> {
    [
        ("Theorems 1 to 5, the remarks, errata", "They are about the law, not about an arm: `phihat reproduce`. What \
            holds of these gains: `phihat design` and `phihat verify`."),
        ("Table 1", "It compares laws by what is published of them; on an own arm `phihat compare` measures them."),
        ("Table 2", "Gains from limits on the error: `phihat design --method paper`, with `[design.paper]`."),
        ("Figs. 4 to 11", "One run of an arm along its path: `phihat run` shows path, errors, torques and φ̂ of this \
            study."),
        ("Table 3, the column of Chung et al.", "Its gains were found by trial and error and are not printed; `phihat \
            compare` tunes it on this study."),
    ]
    .map(|(part, why)| LeftOutOfPaper { part: part.to_owned(), why: why.to_owned() })
    .to_vec()
}
