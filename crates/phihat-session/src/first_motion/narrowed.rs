//! An arm's file with intervals of rotor inertia and dry friction that a first motion narrowed.

use std::path::PathBuf;

use phihat_certificate::extremes::{larger, smaller};
use phihat_model::Joint;
use phihat_study::Study;
use toml_edit::{Array, DocumentMut, Item, Value};

use super::FirstMeasured;
use super::measured::MeasuredJoint;
use crate::error::SessionError;
use crate::files;

/// Source of what is narrowed, in the file.
const SOURCE: &str = "narrowed by a first motion: measured inertia less that of the links by the description; half \
    of the largest jump of φ";

/// Interval of one joint, and the one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Narrowed {
    before: (f64, f64),
    after: (f64, f64),
}

/// An arm's file with narrower intervals, and the description that it names.
#[derive(Debug, Clone, PartialEq)]
pub struct NarrowedArm {
    /// Files to write side by side, the arm's first: name and text.
    pub files: Vec<(PathBuf, String)>,
    /// Joints whose measured inertia lies outside of what the links and any rotor of the interval make: their
    /// intervals stay.
    pub contradicted: Vec<String>,
    /// Product of the widths of the rotors' intervals before over that after, as factors.
    pub rotor_factor: f64,
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
    let [arm, description, ..] = &study.robot.files[..] else { return Ok(None) };
    if !study.robot.has_rotor_interval() {
        return Ok(None);
    }
    let text = files::read(arm)?;
    let mut document: DocumentMut = text.parse().map_err(|e| SessionError::at(arm, e))?;
    let joints = || study.robot.joints.iter().zip(&found.joints);
    let rotors: Vec<_> = joints().map(|(joint, measured)| rotor(joint, measured)).collect();
    let frictions: Vec<_> = joints().map(|(joint, measured)| friction(joint, measured)).collect();
    let none = rotors.iter().zip(joints()).filter(|(rotor, _)| rotor.is_err());
    let contradicted = none.map(|(_, (joint, _))| joint.name.clone()).collect();
    let rotors: Vec<Narrowed> =
        rotors.into_iter().map(|rotor| rotor.unwrap_or_else(|r| r)).collect();
    let width = |(low, high): (f64, f64)| high / low;
    let rotor_factor = rotors.iter().map(|r| width(r.before) / width(r.after)).product();
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
    let name = |path: &PathBuf| PathBuf::from(path.file_name().unwrap_or_default());
    let own = name(description);
    document["urdf"] = toml_edit::value(own.display().to_string());
    let files = vec![(name(arm), document.to_string()), (own, files::read(description)?)];
    Ok(Some(NarrowedArm { files, contradicted, rotor_factor }))
}

/// The rotor of a joint; an error, with the interval as it was: no rotor of it explains what was measured.
fn rotor(joint: &Joint, measured: &MeasuredJoint) -> Result<Narrowed, Narrowed> {
    let before = joint.armature_range.unwrap_or((joint.armature, joint.armature));
    let same = Narrowed { before, after: before };
    let (Some(found), Some(links)) = (&measured.found, measured.links_kg_m2) else {
        return Ok(same);
    };
    let low = larger(before.0, outward(found.inertia.low_kg_m2 - links.1, f64::floor));
    let high = smaller(before.1, outward(found.inertia.high_kg_m2 - links.0, f64::ceil));
    if low > high { Err(same) } else { Ok(Narrowed { before, after: (low, high) }) }
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
    let unit = 10.0_f64.powf(x.abs().log10().floor() - 3.0);
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
