//! Orientations in the five ways in which a file can state one.

use super::attributes::{finite, wrong};
use super::classes::WithDefaults;
use super::compiler::CompilerSettings;
use crate::markup::MarkupElement;
use crate::placement::{
    IDENTITY, Matrix3, Placement, about, cross, dot, mul, normalised, transpose,
};
use crate::whole::Result;

/// Length of a cross product below which two directions are one.
const PARALLEL: f64 = 1e-10;

const WAYS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// Pose that an element and its classes state.
pub(super) fn pose(element: &WithDefaults<'_>, settings: &CompilerSettings) -> Result<Placement> {
    let p = element.finite("pos")?.unwrap_or([0.0; 3]);
    Ok(Placement { r: orientation(&element.levels, settings)?, p })
}

/// Pose that an element states, which has no class.
pub(super) fn own_pose(element: &MarkupElement, settings: &CompilerSettings) -> Result<Placement> {
    let p = finite(element, "pos")?.unwrap_or([0.0; 3]);
    Ok(Placement { r: orientation(&[element], settings)?, p })
}

/// Orientation by the nearest element that states one.
fn orientation(levels: &[&MarkupElement], settings: &CompilerSettings) -> Result<Matrix3> {
    for level in levels {
        let ways: Vec<&str> =
            WAYS.into_iter().filter(|way| level.attribute(way).is_some()).collect();
        match ways[..] {
            [] => {}
            [way] => return by(level, way, settings),
            _ => return Err(wrong(level, "it states its orientation in more than one way")),
        }
    }
    Ok(IDENTITY)
}

fn by(element: &MarkupElement, way: &str, settings: &CompilerSettings) -> Result<Matrix3> {
    let direction = |stated: [f64; 3]| {
        normalised(stated).ok_or_else(|| wrong(element, &format!("\"{way}\" has no direction")))
    };
    match way {
        "quat" => {
            let found = of_quaternion(finite(element, way)?.unwrap_or_default());
            found.ok_or_else(|| wrong(element, "a quaternion of zeros"))
        }
        "axisangle" => {
            let [x, y, z, angle] = finite(element, way)?.unwrap_or_default();
            Ok(about(direction([x, y, z])?, settings.angle(angle)))
        }
        "xyaxes" => {
            let [a, b, c, d, e, f] = finite(element, way)?.unwrap_or_default();
            let x = direction([a, b, c])?;
            let along = dot(x, [d, e, f]);
            let y = direction([d - along * x[0], e - along * x[1], f - along * x[2]])?;
            Ok(transpose(&[x, y, cross(x, y)]))
        }
        "zaxis" => Ok(z_along(direction(finite(element, way)?.unwrap_or_default())?)),
        _ => {
            let angles: [f64; 3] = finite(element, way)?.unwrap_or_default();
            let turn = |r: Matrix3, (angle, (axis, moves)): (f64, (usize, bool))| {
                let one = about(IDENTITY[axis], settings.angle(angle));
                if moves { mul(&r, &one) } else { mul(&one, &r) }
            };
            Ok(angles.into_iter().zip(settings.sequence).fold(IDENTITY, turn))
        }
    }
}

/// Rotation of a quaternion `w, x, y, z` of any length but 0.
fn of_quaternion(quaternion: [f64; 4]) -> Option<Matrix3> {
    let norm = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(norm.is_finite() && norm > 0.0) {
        return None;
    }
    let [w, x, y, z] = quaternion.map(|x| x / norm);
    Some([
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ])
}

/// The shortest rotation that takes z to a unit vector.
pub(super) fn z_along(direction: [f64; 3]) -> Matrix3 {
    let axis = cross([0.0, 0.0, 1.0], direction);
    let sine = dot(axis, axis).sqrt();
    let across = if sine < PARALLEL { [1.0, 0.0, 0.0] } else { axis.map(|x| x / sine) };
    about(across, libm::atan2(sine, direction[2]))
}
