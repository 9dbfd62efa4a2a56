//! Folder of the journal and the results of a campaign.

use std::path::{Path, PathBuf};

use phihat_session::SessionError;

/// The journal of a campaign, in its folder.
pub const JOURNAL: &str = "journal.jsonl";

/// Folder of the results of a campaign: `out` if it is given, else `out/STUDY/CAMPAIGN` for one study and
/// `out/CAMPAIGN` for several.
///
/// # Errors
///
/// [`SessionError`]: the study cannot be read.
pub fn results_of(
    studies: &[PathBuf],
    out: Option<&Path>,
    campaign: &str,
) -> Result<PathBuf, SessionError> {
    match (out, studies) {
        (Some(folder), _) => Ok(folder.to_owned()),
        (None, [one]) => {
            let study = phihat_session::read(one)?;
            Ok(Path::new("out").join(study.name).join(campaign))
        }
        (None, _) => Ok(Path::new("out").join(campaign)),
    }
}
