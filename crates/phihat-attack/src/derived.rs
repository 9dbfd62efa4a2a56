//! A kept study verified again from its files: the tube by the certificate's own derivation, and runs in drawn worlds.

use std::path::Path;

use phihat_session::{Checked, verify};

use crate::held::Violation;

/// Result of `phihat verify --study` for a stored study, in words: the degree to which its tube is confirmed.
///
/// # Errors
///
/// The claim that does not hold, or why nothing could be checked.
pub(crate) fn derived(folder: &Path) -> Result<String, Violation> {
    let (gains, study) = (folder.join("gains.json"), folder.join("study.toml"));
    let left = |signal: String, sides: (f64, f64)| Violation {
        run: "verify --study".to_owned(),
        joint: String::new(),
        signal,
        t_s: 0.0,
        measured: sides.0,
        claimed: (0.0, sides.1),
        ratio: f64::MAX,
    };
    let checked = verify(Checked::Gains { gains: &gains, study: Some(&study), seed: 0 }, &|_| ());
    let found = checked.map_err(|why| left(why.to_string(), (0.0, 0.0)))?;
    let verified = match found.claims {
        Some(Ok(verified)) => verified,
        Some(Err(why)) => {
            return Err(left(format!("{}: {}", why.claim, why.inequality), (why.left, why.right)));
        }
        None => return Ok("nothing to check".to_owned()),
    };
    let Some(tube) = verified.tube else { return Ok("no tube".to_owned()) };
    Ok(match tube.on_trust {
        Some(why) => format!("on trust: {why}"),
        None if tube.joints.iter().all(phihat_certificate::tube::JointBeside::confirmed) => {
            "confirmed".to_owned()
        }
        None => "first derivation tighter".to_owned(),
    })
}
