//! A study with its motion from a file.

use std::path::{Path, PathBuf};

use phihat_study::Study;
use toml::{Table, Value};

use crate::edit::set;
use crate::error::SessionError;
use crate::files;

/// A study whose motion is that of a file (CSV: `t_s` and every joint's name), to its last sample; `path` is
/// the study's.
///
/// # Errors
///
/// [`SessionError`]: the file cannot be read, or its motion is not one of this arm, by place: joints, times,
/// limits of position and velocity.
pub fn referred(study: &Study, path: &Path, file: &Path) -> Result<Box<Study>, SessionError> {
    let whole: PathBuf = std::path::absolute(file).map_err(|e| SessionError::at(file, e))?;
    let mut table: Table = study.table().map_err(|e| SessionError::at(path, e))?;
    table.remove("reference");
    if let Some(supervisor) = table.get_mut("supervisor").and_then(Value::as_table_mut) {
        supervisor.remove("start_imbalance_nm");
    }
    set(&mut table, &["reference", "kind"], Value::from("csv"));
    set(&mut table, &["reference", "file"], Value::from(whole.display().to_string()));
    // Where the file cannot be read so far, whoever reads it as a motion says why.
    if let Some(end) = last_time(file)? {
        set(&mut table, &["duration_s"], Value::from(end));
        let settle = f64::min(study.spec.settle, 0.5 * end);
        set(&mut table, &["spec", "settle_s"], Value::from(settle));
        // What begins later never comes.
        for above in [None, Some("world")] {
            let at = match above {
                None => Some(&mut table),
                Some(section) => table.get_mut(section).and_then(Value::as_table_mut),
            };
            let Some(at) = at else { continue };
            for key in ["fault", "push"] {
                let Some(Value::Array(all)) = at.get_mut(key) else { continue };
                let start = |one: &Value| one.get("start_s").and_then(Value::as_float);
                all.retain(|one| start(one).is_none_or(|start| start < end));
                if all.is_empty() {
                    at.remove(key);
                }
            }
        }
    }
    let text = toml::to_string(&table).map_err(|e| SessionError::at(path, e))?;
    let base = path.parent().unwrap_or_else(|| Path::new(""));
    let mut read = Study::from_text(&text, &format!("{}.toml", study.name), base).map(Box::new)?;
    phihat_sim::derive_substeps(&mut read);
    stay_in_class(study, &mut read);
    Ok(read)
}

/// A supervisor that keeps references in a class of motions does so with those of a file.
fn stay_in_class(study: &Study, read: &mut Study) {
    let (Some(from), Some(own)) = (&study.supervisor, &mut read.supervisor) else { return };
    if from.reference_box.is_some() {
        own.motion.clone_from(&from.motion);
        own.reference_box.clone_from(&from.reference_box);
        own.start_imbalance.clone_from(&from.start_imbalance);
    }
}

/// The time of the last sample of a file \[s\], if it has one.
fn last_time(file: &Path) -> Result<Option<f64>, SessionError> {
    let text = files::read(file)?;
    let column = text.lines().next().unwrap_or("").split(',').position(|name| name.trim() == "t_s");
    let last = text.lines().rev().find(|line| !line.trim().is_empty());
    let time = last.zip(column).and_then(|(line, at)| line.split(',').nth(at));
    let time = time.and_then(|text| text.trim().parse::<f64>().ok());
    Ok(time.filter(|time| time.is_finite() && *time > 0.0))
}
