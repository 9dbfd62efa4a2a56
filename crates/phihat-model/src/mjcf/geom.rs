//! Mass and inertia of a geom.

use core::f64::consts::PI;

use super::attributes::{AutoSetting, wrong};
use super::classes::WithDefaults;
use super::compiler::CompilerSettings;
use super::orientation::{pose, z_along};
use crate::body::{Body, LumpedBody};
use crate::placement::{Placement, dot};
use crate::whole::Result;

/// Density that is assumed where none is stated \[kg/m³\].
const DENSITY: f64 = 1000.0;

/// Mass \[kg\], volume \[m³\] or length \[m\] below which there is none, as in MuJoCo.
const NOTHING: f64 = 1e-14;

/// A solid: its volume \[m³\], and its principal moments over its mass \[m²\].
struct Solid {
    volume: f64,
    gyration: [f64; 3],
}

/// Matter of a geom in its body's frame, where `frame` is the one that it stands in; `None`: it has none.
pub(super) fn matter(
    geom: &WithDefaults<'_>,
    settings: &CompilerSettings,
    frame: &Placement,
) -> Result<Option<LumpedBody>> {
    let group = geom.number("group")?.unwrap_or(0.0);
    let (mass, density) = (geom.number("mass")?, geom.number("density")?.unwrap_or(DENSITY));
    let counts = settings.groups.0 <= group && group <= settings.groups.1;
    let weightless = mass.map_or(density <= 0.0, |mass| mass <= 0.0);
    let kind = geom.word("type").unwrap_or("sphere");
    if mass.unwrap_or(density) < 0.0 {
        return Err(wrong(geom.own(), "mass and density must not be negative"));
    }
    if !counts || weightless || (kind == "plane" && geom.word("mesh").is_none()) {
        return Ok(None);
    }
    let refuse = |what: &str| {
        let why = format!(
            "{what}, whose mass and inertia are not computed here: give its body an <inertial>, or the geom \
             mass=\"0\"; MuJoCo's `compile` writes a file with all of them, where <compiler saveinertial=\"true\"/>"
        );
        Err(wrong(geom.own(), &why))
    };
    if geom.word("mesh").is_some() || matches!(kind, "mesh" | "sdf") {
        return refuse("a mesh");
    }
    if kind == "hfield" {
        return refuse("a height field");
    }
    if geom.setting("shellinertia")? == AutoSetting::True {
        return refuse("a shell");
    }
    let mut size = geom.up_to("size", [0.0; 3])?;
    let at = match geom.finite::<6>("fromto")? {
        Some(ends) => between(geom, kind, (ends, &mut size))?,
        None => pose(geom, settings)?,
    };
    let solid = solid(geom, kind, size)?;
    let mass = match mass {
        Some(mass) if solid.volume > NOTHING => mass,
        Some(_) => return Ok(None),
        None => density * solid.volume,
    };
    if mass <= NOTHING {
        return Ok(None);
    }
    let [xx, yy, zz] = solid.gyration.map(|g| mass * g);
    let body = Body { mass, com: [0.0; 3], inertia: [xx, 0.0, 0.0, yy, 0.0, zz] };
    Ok(Some(body.lumped().seen_from(&frame.then(&at))))
}

/// Pose of a geom between two points, and its size along them.
fn between(
    geom: &WithDefaults<'_>,
    kind: &str,
    ([ax, ay, az, bx, by, bz], size): ([f64; 6], &mut [f64; 3]),
) -> Result<Placement> {
    let along = [ax - bx, ay - by, az - bz];
    let length = dot(along, along).sqrt();
    if length < NOTHING {
        return Err(wrong(geom.own(), "the points of \"fromto\" are one"));
    }
    match kind {
        "capsule" | "cylinder" => size[1] = 0.5 * length,
        "box" | "ellipsoid" => *size = [size[0], size[0], 0.5 * length],
        _ => {
            let why = "\"fromto\" is for a capsule, cylinder, box or ellipsoid";
            return Err(wrong(geom.own(), why));
        }
    }
    let p = [0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz)];
    Ok(Placement { r: z_along(along.map(|x| x / length)), p })
}

/// A solid by its kind and its half sizes \[m\].
fn solid(geom: &WithDefaults<'_>, kind: &str, [a, b, c]: [f64; 3]) -> Result<Solid> {
    let needed = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        "box" | "ellipsoid" => 3,
        _ => return Err(wrong(geom.own(), &format!("\"{kind}\" is no type of a geom"))),
    };
    if [a, b, c].iter().take(needed).any(|x| !(x.is_finite() && *x > 0.0)) {
        return Err(wrong(geom.own(), &format!("a {kind} has {needed} sizes above 0")));
    }
    Ok(match kind {
        "sphere" => Solid { volume: 4.0 / 3.0 * PI * a * a * a, gyration: [0.4 * a * a; 3] },
        "cylinder" => {
            let across = a * a / 4.0 + b * b / 3.0;
            let volume = 2.0 * PI * a * a * b;
            Solid { volume, gyration: [across, across, 0.5 * a * a] }
        }
        "capsule" => {
            // Two halves of a ball around a cylinder; each half's centre is 3/8 of the radius beyond its end.
            let (ball, middle) = (4.0 / 3.0 * a, 2.0 * b);
            let ball_share = ball / (ball + middle);
            let own = 0.4 * a * a;
            let away = own + b * b + 0.75 * a * b;
            let across = (1.0 - ball_share) * (a * a / 4.0 + b * b / 3.0) + ball_share * away;
            let along = (1.0 - ball_share) * 0.5 * a * a + ball_share * own;
            Solid { volume: PI * a * a * (ball + middle), gyration: [across, across, along] }
        }
        "ellipsoid" => {
            let [x, y, z] = [a * a, b * b, c * c];
            let gyration = [(y + z) / 5.0, (x + z) / 5.0, (x + y) / 5.0];
            Solid { volume: 4.0 / 3.0 * PI * a * b * c, gyration }
        }
        _ => {
            let [x, y, z] = [a * a, b * b, c * c];
            let gyration = [(y + z) / 3.0, (x + z) / 3.0, (x + y) / 3.0];
            Solid { volume: 8.0 * a * b * c, gyration }
        }
    })
}
