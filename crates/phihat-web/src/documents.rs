//! Gains as documents: checked, and in other formats.

use phihat_certificate::Gains;
use phihat_design::export::{Target, export};
use phihat_session::{Checked, verify};
use serde_json::{Value, json};

use crate::error::AnswerError;
use crate::task::StudyTexts;

/// Claims of gains checked again, with the study where there is one.
pub(crate) fn verified(texts: &StudyTexts) -> Result<Value, AnswerError> {
    let gains = texts.gains()?.ok_or(AnswerError::NoGains)?;
    let study = if texts.study.is_empty() { None } else { Some(texts.read()?) };
    let checked = Checked::Documents { gains: &gains, study: study.as_deref(), seed: 0 };
    let found = verify(checked, &|_| ())?;
    Ok(match found.claims {
        Some(Ok(verified)) => json!({
            "holds": true, "verified": verified, "runs": found.runs, "rigid_joints": found.rigid_joints,
        }),
        Some(Err(why)) => json!({ "holds": false, "refuted": why.to_string() }),
        None => json!({ "holds": true, "verified": null }),
    })
}

/// Gains in another format.
pub(crate) fn exported(text: &str, format: &str) -> Result<Value, AnswerError> {
    let target = match format {
        "c-header" => Target::CHeader,
        "ros2" => Target::Ros,
        "csv" => Target::Csv,
        other => return Err(AnswerError::Format(other.to_owned())),
    };
    let text = export(&Gains::from_json(text)?, target)?;
    Ok(json!({ "text": text }))
}
