//! Texts of studies: read, and written again with what came while they ran.

use std::path::Path;

use phihat_study::Study;
use serde_json::Value;

use crate::error::StudioError;

/// A study of a text that would stand at this path.
pub(crate) fn study(text: &str, path: &Path) -> Result<Box<Study>, StudioError> {
    let base = path.parent().unwrap_or(Path::new(""));
    let read = Study::from_text(text, &path.display().to_string(), base);
    let mut study = read.map(Box::new).map_err(|why| StudioError::refused(why.to_string()))?;
    phihat_sim::derive_substeps(&mut study);
    Ok(study)
}

/// The text of a run with the faults that came, as `Live` tells them, and a duration that holds them.
pub(crate) fn with_what_came(text: &str, came: &Value) -> String {
    let now = came["t"].as_f64().unwrap_or(0.0);
    let mut whole = String::with_capacity(text.len() + 256);
    let mut top = true;
    for line in text.lines() {
        let word = line.trim_start();
        top &= !word.starts_with('[');
        let lasts = word.strip_prefix("duration_s").filter(|_| top);
        let lasts = lasts.and_then(|rest| rest.trim_start().strip_prefix('='));
        let stated = lasts.and_then(|rest| rest.split('#').next()?.trim().parse::<f64>().ok());
        if stated.is_some_and(|stated| stated < now) {
            let longer = ((10.0 * now).floor() + 1.0) / 10.0;
            whole.extend(["duration_s = ", &format!("{longer:?}")]);
        } else {
            whole += line;
        }
        whole.push('\n');
        let world = word.starts_with("[world]");
        if let Some(steps) = came["substeps"].as_u64().filter(|_| world) {
            whole.extend(["substeps = ", &steps.to_string(), "\n"]);
        }
    }
    whole += came["sections"].as_str().unwrap_or_default();
    whole
}
