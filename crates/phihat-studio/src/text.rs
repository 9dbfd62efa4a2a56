//! Texts of studies: read, and written again with what came while they ran.

use std::path::Path;

use phihat_sim::Motion;
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
    if let Some(late) = came["late"].as_u64() {
        whole = with_key(&whole, "sensor", "sample_delay_samples", &late.to_string());
    }
    whole += came["sections"].as_str().unwrap_or_default();
    whole
}

/// A study's text with a supervisor around its law, every key at its default. It arms with the torque \[N·m\] that held
/// the arm at its start, where the study states one.
pub(crate) fn with_supervisor(study: &Study) -> Result<String, StudioError> {
    let motion = Motion::of(study).map_err(|why| StudioError::refused(why.to_string()))?;
    let start: Vec<f64> =
        (0..study.robot.joints.len()).map(|joint| motion.at(joint, 0.0)[0]).collect();
    let preset = study.held_torque(&start);
    let preset = preset.map_or_else(String::new, |torque| format!("preset_nm = {torque:?}\n"));
    let bare = without_key(&study.text, "start", "torque_nm");
    Ok(format!("{}\n\n[supervisor]\n{preset}", bare.trim_end()))
}

/// The text without a key of a section.
fn without_key(text: &str, section: &str, key: &str) -> String {
    let header = format!("[{section}]");
    let mut inside = false;
    let stays = |line: &&str| {
        let own = line.trim();
        if own.starts_with('[') {
            inside = own.split('#').next().is_some_and(|own| own.trim() == header);
        }
        let says = own.strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
        !(inside && says)
    };
    text.lines().filter(stays).map(|line| format!("{line}\n")).collect::<Vec<_>>().concat()
}

/// The text with another value of a key in a section that has a header of its own; without one, with such a
/// section at its end.
fn with_key(text: &str, section: &str, key: &str, value: &str) -> String {
    let header = format!("[{section}]");
    let is_header = |line: &&str| line.split('#').next().is_some_and(|line| line.trim() == header);
    let says = |line: &str| {
        let rest = line.trim_start().strip_prefix(key);
        rest.is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let told = format!("{key} = {value}");
    let Some(head) = text.lines().position(|line| is_header(&line)) else {
        lines.extend([String::new(), header, told]);
        return lines.join("\n") + "\n";
    };
    let length = lines[head + 1..].iter().position(|line| line.trim_start().starts_with('['));
    let end = length.map_or(lines.len(), |length| head + 1 + length);
    match (head + 1..end).find(|&k| says(&lines[k])) {
        Some(k) => lines[k] = told,
        None => lines.insert(head + 1, told),
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::{with_key, without_key};

    #[test]
    fn a_key_goes_from_its_section_alone() {
        let text = "torque_nm = 1\n[start] # here\ntorque_nm = 2\nq = 3\n[a]\ntorque_nm = 4\n";
        let left = "torque_nm = 1\n[start] # here\nq = 3\n[a]\ntorque_nm = 4\n";
        assert_eq!(without_key(text, "start", "torque_nm"), left);
    }

    #[test]
    fn a_key_is_put_where_its_section_is() {
        let put = |text: &str| with_key(text, "sensor", "late", "2");
        assert_eq!(put("[a]\nlate = 1\n"), "[a]\nlate = 1\n\n[sensor]\nlate = 2\n");
        assert_eq!(put("[sensor] # eyes\nx = 1\n[b]\n"), "[sensor] # eyes\nlate = 2\nx = 1\n[b]\n");
        assert_eq!(
            put("[sensor]\nx = 1\nlate=7 # s\n[b]\nlate = 3\n"),
            "[sensor]\nx = 1\nlate = 2\n[b]\nlate = 3\n"
        );
    }
}
