//! An arm's file with intervals of rotor inertia and dry friction that a first motion narrowed.

use std::path::{Path, PathBuf};

use phihat_certificate::extremes::{Extremes as _, larger, smaller};
use phihat_model::Joint;
use phihat_study::Study;
use toml_edit::{Array, DocumentMut, Item, TableLike, Value};

use super::FirstMeasured;
use super::measured::MeasuredJoint;
use crate::error::SessionError;
use crate::files;
use crate::layout::INPUTS;

/// Source of what is narrowed, in the file.
const SOURCE: &str = "narrowed by a first motion: measured inertia less that of the links by the description; half \
    of the largest jump of φ";

/// Interval of one joint, and the one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Narrowed {
    before: (f64, f64),
    after: (f64, f64),
}

/// An arm's file with narrower intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct NarrowedArm {
    /// Name of the file: that of the arm's file with `_measured`, for the folder of the record.
    pub name: PathBuf,
    /// Text of the file. It names the description as the record has it, below `inputs/`.
    pub text: String,
    /// Joints whose measured inertia lies outside of what the links and any rotor of the interval make: their
    /// intervals stay.
    pub contradicted: Vec<String>,
    /// Width of the widest interval of rotor inertia before and after \[kg·m²\].
    pub widest_kg_m2: (f64, f64),
}

/// Narrows the intervals of an arm's file by what a first motion measured; `None` where the study's arm has no such
/// file, or it states no intervals of rotor inertia.
///
/// ```text
/// rotor of joint i within [low_i − m̄_i, high_i − m_i] and its interval;   dry friction ≤ ½ largest jump of φ
/// ```
///
/// with the measured inertia `[low_i, high_i]` and that of the links by the description in the posture of the motion,
/// `m_i` without payload and `m̄_i` with the heaviest of the study \[kg·m²\]. Masses of the description are taken to be
/// right, and the arm carries no more than the study says.
///
/// # Errors
///
/// [`SessionError`]: the arm's file or its description cannot be read.
pub fn narrowed_arm(
    study: &Study,
    found: &FirstMeasured,
) -> Result<Option<NarrowedArm>, SessionError> {
    let Some(arm) = study.robot.toml_file() else { return Ok(None) };
    let is_description = |(_, path): &&(PathBuf, PathBuf)| {
        path != arm && study.robot.files.contains(path) && path.extension() != arm.extension()
    };
    let Some((description, _)) = study.inputs.iter().find(is_description) else { return Ok(None) };
    let text = files::read(arm)?;
    let mut document: DocumentMut = text.parse().map_err(|e| SessionError::at(arm, e))?;
    if !study.robot.has_rotor_interval() || !is_of(&document, study.robot.joints.len()) {
        return Ok(None);
    }
    let joints = || study.robot.joints.iter().zip(&found.joints);
    let rotors: Vec<_> = joints().map(|(joint, measured)| rotor(joint, measured)).collect();
    let frictions: Vec<_> = joints().map(|(joint, measured)| friction(joint, measured)).collect();
    let none = rotors.iter().zip(joints()).filter(|(rotor, _)| rotor.is_err());
    let contradicted = none.map(|(_, (joint, _))| joint.name.clone()).collect();
    let rotors: Vec<Narrowed> =
        rotors.into_iter().map(|rotor| rotor.unwrap_or_else(|r| r)).collect();
    let widest = |of: fn(&Narrowed) -> (f64, f64)| {
        rotors.iter().map(of).map(|(low, high)| high - low).largest()
    };
    let widest_kg_m2 = (widest(|rotor| rotor.before), widest(|rotor| rotor.after));
    let middle = |r: &Narrowed, own: f64| if r.before == r.after { own } else { centre(r.after) };
    let armature = joints().zip(&rotors).map(|((joint, _), r)| middle(r, joint.armature));
    put(&mut document, "rotor", "armature_kg_m2", armature);
    put(&mut document, "rotor", "armature_min_kg_m2", rotors.iter().map(|r| r.after.0));
    put(&mut document, "rotor", "armature_max_kg_m2", rotors.iter().map(|r| r.after.1));
    source(&mut document, "rotor");
    if let Some(frictions) = frictions.into_iter().collect::<Option<Vec<Narrowed>>>() {
        let inside =
            |(joint, r): (&Joint, &Narrowed)| joint.friction.coulomb.clamp(r.after.0, r.after.1);
        let level = study.robot.joints.iter().zip(&frictions).map(inside);
        put(&mut document, "friction", "coulomb_nm", level);
        put(&mut document, "friction", "coulomb_min_nm", frictions.iter().map(|r| r.after.0));
        put(&mut document, "friction", "coulomb_max_nm", frictions.iter().map(|r| r.after.1));
        source(&mut document, "friction");
    }
    let key = if document.contains_key("mjcf") { "mjcf" } else { "urdf" };
    document[key] = toml_edit::value(Path::new(INPUTS).join(description).display().to_string());
    let stem = arm.file_stem().unwrap_or_default().to_string_lossy();
    let name = PathBuf::from(format!("{stem}_measured.toml"));
    Ok(Some(NarrowedArm { name, text: document.to_string(), contradicted, widest_kg_m2 }))
}

/// Returns true if every list of the sections that are written has one entry per joint of the study: a study that locks
/// joints has fewer than its arm's file.
fn is_of(document: &DocumentMut, joints: usize) -> bool {
    let sections = ["rotor", "friction"].iter().filter_map(|section| document.get(section));
    let lists = sections.filter_map(Item::as_table_like).flat_map(TableLike::iter);
    let lengths = lists.filter_map(|(_, item)| item.as_array()).map(Array::len);
    lengths.into_iter().all(|length| length == joints)
}

/// The rotor of a joint; an error, with the interval as it was: no rotor of it explains what was measured.
fn rotor(joint: &Joint, measured: &MeasuredJoint) -> Result<Narrowed, Narrowed> {
    let before = joint.armature_range.unwrap_or((joint.armature, joint.armature));
    let same = Narrowed { before, after: before };
    let (Some(found), Some(links)) = (&measured.found, measured.links_kg_m2) else {
        return Ok(same);
    };
    let inertia = (found.inertia.low_kg_m2, found.inertia.high_kg_m2);
    rotor_of(before, inertia, links).map(|after| Narrowed { before, after }).ok_or(same)
}

/// Rotor inertia within an interval that makes a measured inertia with that of the links, from and to \[kg·m²\];
/// `None`:
/// there is none.
fn rotor_of(before: (f64, f64), inertia: (f64, f64), links: (f64, f64)) -> Option<(f64, f64)> {
    let low = larger(before.0, outward(inertia.0 - links.1, f64::floor));
    let high = smaller(before.1, outward(inertia.1 - links.0, f64::ceil));
    (low <= high).then_some((low, high))
}

/// The level of dry friction of a joint; `None` where the file states no interval of it.
fn friction(joint: &Joint, measured: &MeasuredJoint) -> Option<Narrowed> {
    let before = joint.friction.coulomb_range?;
    let Some(found) = &measured.found else { return Some(Narrowed { before, after: before }) };
    let high = smaller(before.1, outward(0.5 * found.phi_jump_max_nm, f64::ceil));
    // An estimate that begins above what was measured was wrong.
    let low = if before.0 <= high { before.0 } else { 0.0 };
    Some(Narrowed { before, after: (low, high) })
}

/// Geometric mean, with four digits.
fn centre((low, high): (f64, f64)) -> f64 {
    outward((low * high).sqrt(), f64::round).clamp(low, high)
}

/// A number with four digits, rounded one way.
fn outward(x: f64, round: fn(f64) -> f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let unit = libm::pow(10.0, libm::log10(x.abs()).floor() - 3.0);
    let rounded = round(x / unit) * unit;
    format!("{rounded:.4e}").parse().unwrap_or(rounded)
}

fn put(document: &mut DocumentMut, section: &str, key: &str, values: impl Iterator<Item = f64>) {
    let list: Array = values.collect();
    document[section][key] = Item::Value(Value::Array(list));
}

fn source(document: &mut DocumentMut, section: &str) {
    document[section]["source"] = toml_edit::value(SOURCE);
}

#[cfg(test)]
mod tests {
    use super::{outward, rotor_of};

    #[test]
    fn a_rotor_is_what_is_measured_less_the_links() {
        // Links 0.3 kg·m², with the payload 0.5: the rotor of 0.6 is within [0.75 − 0.5, 1.05 − 0.3].
        assert_eq!(rotor_of((0.1, 2.0), (0.75, 1.05), (0.3, 0.5)), Some((0.25, 0.75)));
        // An interval that is narrower already stays.
        assert_eq!(rotor_of((0.4, 0.6), (0.75, 1.05), (0.3, 0.5)), Some((0.4, 0.6)));
    }

    #[test]
    fn a_measurement_that_no_rotor_explains_contradicts() {
        assert_eq!(rotor_of((1.0, 2.0), (0.75, 1.05), (0.3, 0.5)), None);
        assert_eq!(rotor_of((0.01, 0.1), (0.75, 1.05), (0.3, 0.5)), None);
    }

    #[test]
    fn rounding_never_narrows() {
        for x in [1.234_567_8e-4, 0.098_765_4, 7.0, 123.456_78] {
            assert!(outward(x, f64::floor) <= x && outward(x, f64::ceil) >= x, "{x}");
            assert!((outward(x, f64::ceil) - x).abs() <= 1.1e-3 * x, "{x}");
        }
    }
}
