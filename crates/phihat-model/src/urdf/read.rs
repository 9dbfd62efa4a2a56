//! From the text of a URDF to links, joints and their limits.

use std::collections::BTreeSet;

use roxmltree::{Document, Node};

use super::element::Element;
use super::tree::{self, JointElement, LinkElement};
use super::{Result, Urdf, scan};
use crate::body::{Body, Lumped};
use crate::description::{JointOf, Motion};
use crate::error::RobotError;
use crate::joint::{Friction, Joint, JointKind};
use crate::placement::{dot, mul, normalised, transpose};
use crate::{Model, Workspace};

/// Most links.
const LINKS_MAX: usize = 64;
/// A limit beyond this is what some exporters write for none \[rad, m, rad/s, N·m\].
const BOUNDLESS: f64 = 1e9;
/// Most joints that move.
const MOVING_MAX: usize = 16;

/// Reads and checks a URDF; `origin` stands for the file in errors.
pub(crate) fn read(text: &str, origin: &str) -> Result<Urdf> {
    scan::scan(text, origin)?;
    let document = Document::parse(text).map_err(|error| RobotError::Xml {
        origin: origin.to_owned(),
        line: error.pos().row,
        why: error.to_string(),
    })?;
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        let why = format!("the root element is <{}>; it must be <robot>", root.tag_name().name());
        return Err(RobotError::Xml { origin: origin.to_owned(), line: 1, why });
    }
    let mut warnings = Vec::new();
    let links = read_links(root, origin, &mut warnings)?;
    let joints = read_joints(root, origin, &mut warnings)?;
    let (description, order) = tree::grow(&links, &joints, origin)?;
    let name = root.attribute("name").unwrap_or("robot").to_owned();
    let moving = || order.iter().map(|at| &joints[*at]).filter(|joint| joint.moving.is_some());
    let model = Model::new(description);
    if let Some(joint) = unmoved(&model).and_then(|at| moving().nth(at)) {
        let why = "it moves no mass, so torque has nothing to act on".to_owned();
        return Err(joint.element.error(why));
    }
    let joints = moving().filter_map(|joint| joint.moving.clone()).collect();
    Ok(Urdf { name, model, joints, warnings })
}

/// A coordinate whose motion takes no energy, at a posture like no other.
fn unmoved(model: &Model) -> Option<usize> {
    const ROUNDING: f64 = 1e-13;
    let n = model.joint_count();
    let q: Vec<f64> = (0..n).map(|joint| 0.5 + 0.1 * joint as f64).collect();
    let mut m = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(model), &q, &mut m);
    let diagonal: Vec<f64> = (0..n).map(|i| m[i * n + i]).collect();
    // What is left of each joint's inertia when those before it are free to move.
    for k in 0..n {
        let pivot = m[k * n + k];
        if pivot.is_nan() || pivot <= ROUNDING * diagonal[k] {
            return Some(k);
        }
        for i in k + 1..n {
            let factor = m[i * n + k] / pivot;
            (k..n).for_each(|j| m[i * n + j] -= factor * m[k * n + j]);
        }
    }
    None
}

fn read_links<'a, 'x>(
    root: Node<'a, 'x>,
    origin: &'a str,
    warnings: &mut Vec<String>,
) -> Result<Vec<LinkElement<'a, 'x>>> {
    let nodes = || root.children().filter(|child| child.has_tag_name("link"));
    at_most(origin, "links", nodes().count(), LINKS_MAX)?;
    let mut names = BTreeSet::new();
    let mut links = Vec::new();
    for node in nodes() {
        let element = Element::of(node, origin)?;
        if !names.insert(element.name) {
            return Err(element.error("another link has this name".to_owned()));
        }
        links.push(LinkElement { element, matter: read_matter(&element, warnings)? });
    }
    Ok(links)
}

fn read_matter(link: &Element<'_, '_>, warnings: &mut Vec<String>) -> Result<Lumped> {
    let Some(inertial) = link.child(link.node, "inertial")? else {
        return Ok(Lumped::default());
    };
    let part = |tag: &str| {
        link.child(inertial, tag)?.ok_or_else(|| link.error(format!("<inertial> has no <{tag}>")))
    };
    let (mass, inertia) = (link.number(part("mass")?, "value")?, part("inertia")?);
    let entry = |key| link.number(inertia, key);
    let [xx, xy, xz] = [entry("ixx")?, entry("ixy")?, entry("ixz")?];
    let [yy, yz, zz] = [entry("iyy")?, entry("iyz")?, entry("izz")?];
    let at = link.placement(inertial)?;
    let stated = Body { mass, com: [0.0; 3], inertia: [xx, xy, xz, yy, yz, zz] };
    stated.check().map_err(|why| link.error(why.to_string()))?;
    if !stated.obeys_triangle_inequality() {
        let name = link.name;
        warnings.push(format!(
            "link \"{name}\": no mass distribution has this inertia (triangle inequality)"
        ));
    }
    if mass <= 0.0 && stated.inertia.iter().any(|x| x.abs() > 0.0) {
        warnings.push(format!("link \"{}\": it has inertia but no mass", link.name));
    }
    let turned = mul(&mul(&at.r, &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), &transpose(&at.r));
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = turned;
    Ok(Body { com: at.p, inertia: [xx, xy, xz, yy, yz, zz], ..stated }.lumped())
}

fn read_joints<'a, 'x>(
    root: Node<'a, 'x>,
    origin: &'a str,
    warnings: &mut Vec<String>,
) -> Result<Vec<JointElement<'a, 'x>>> {
    let mut names = BTreeSet::new();
    let mut joints: Vec<JointElement<'a, 'x>> = Vec::new();
    for node in root.children().filter(|child| child.has_tag_name("joint")) {
        let element = Element::of(node, origin)?;
        if !names.insert(element.name) {
            return Err(element.error("another joint has this name".to_owned()));
        }
        at_most(origin, "joints", joints.len() + 1, LINKS_MAX)?;
        joints.push(read_joint(element, warnings)?);
    }
    let moving = joints.iter().filter(|joint| joint.moving.is_some()).count();
    at_most(origin, "joints that move", moving, MOVING_MAX)?;
    Ok(joints)
}

fn read_joint<'a, 'x>(
    element: Element<'a, 'x>,
    warnings: &mut Vec<String>,
) -> Result<JointElement<'a, 'x>> {
    let node = element.node;
    let kind = match element.text(node, "type")? {
        "fixed" => None,
        "revolute" => Some(JointKind::Revolute),
        "continuous" => Some(JointKind::Continuous),
        "prismatic" => Some(JointKind::Prismatic),
        other => {
            return Err(element.error(format!(
                "type \"{other}\" is not read; revolute, continuous, prismatic and fixed are"
            )));
        }
    };
    let end = |tag: &str| {
        let missing = || element.error(format!("it has no <{tag} link=…>"));
        element.text(element.child(node, tag)?.ok_or_else(missing)?, "link")
    };
    let (parent, child) = (end("parent")?, end("child")?);
    if element.child(node, "mimic")?.is_some() {
        return Err(element.error(
            "<mimic> joints are not read: make it fixed, or a joint of its own".to_owned(),
        ));
    }
    let axis = match kind {
        None => [1.0, 0.0, 0.0],
        Some(_) => read_axis(&element, warnings)?,
    };
    let moving = kind.map(|kind| read_limits(&element, kind, warnings)).transpose()?;
    let motion = match kind {
        None => Motion::Fixed,
        Some(JointKind::Prismatic) => Motion::Prismatic,
        Some(_) => Motion::Revolute,
    };
    let placement = element.placement(node)?;
    let joint = JointOf { name: element.name.to_owned(), motion, parent: 0, placement, axis };
    Ok(JointElement { element, parent, child, joint, moving })
}

fn read_axis(joint: &Element<'_, '_>, warnings: &mut Vec<String>) -> Result<[f64; 3]> {
    let stated = joint.vector(joint.child(joint.node, "axis")?, "xyz", [1.0, 0.0, 0.0])?;
    let axis = normalised(stated)
        .ok_or_else(|| joint.error(format!("axis {stated:?} has no direction")))?;
    if (dot(stated, axis) - 1.0).abs() > 1e-3 {
        warnings.push(format!("joint \"{}\": axis {stated:?} is not of length 1", joint.name));
    }
    Ok(axis)
}

/// Ends of travel; `None` where they are so far apart that somebody meant none.
fn read_travel<'a, 'x>(
    joint: &Element<'a, 'x>,
    (kind, limit): (JointKind, Option<Node<'a, 'x>>),
    warnings: &mut Vec<String>,
) -> Result<Option<(f64, f64)>> {
    let Some(limit) = limit else {
        return Err(joint.error("it has no <limit>; only continuous joints go without".into()));
    };
    let number = |key| Ok(joint.number_if_any(limit, key)?.unwrap_or(0.0));
    let (low, high) = (number("lower")?, number("upper")?);
    if low >= high {
        return Err(joint.error(format!("lower limit {low} must be below upper {high}")));
    }
    if high - low <= BOUNDLESS {
        return Ok(Some((low, high)));
    }
    if kind == JointKind::Prismatic {
        let why = "leave a sliding joint without ends: state its travel in metres";
        return Err(joint.error(format!("limits {low} … {high} {why}")));
    }
    let why = format!("travel beyond {BOUNDLESS:e} is read as none: the joint turns without end");
    warnings.push(format!("joint \"{}\": a {why}", joint.name));
    Ok(None)
}

fn read_limits(
    joint: &Element<'_, '_>,
    kind: JointKind,
    warnings: &mut Vec<String>,
) -> Result<Joint> {
    let limit = joint.child(joint.node, "limit")?;
    let number = |key| limit.map_or(Ok(None), |node| joint.number_if_any(node, key));
    let position = match kind {
        JointKind::Continuous => None,
        _ => read_travel(joint, (kind, limit), warnings)?,
    };
    let kind = if position.is_none() { JointKind::Continuous } else { kind };
    let mut positive = |key| match number(key)? {
        Some(x) if x < 0.0 => {
            Err(joint.error(format!("<limit {key}=\"{x}\"> must not be negative")))
        }
        Some(x) if x > BOUNDLESS => {
            let why = format!("{key} limit beyond {BOUNDLESS:e} is read as none");
            warnings.push(format!("joint \"{}\": a {why}", joint.name));
            Ok(None)
        }
        Some(x) if x > 0.0 => Ok(Some(x)),
        Some(_) => {
            warnings.push(format!("joint \"{}\": {key} limit 0 is read as none", joint.name));
            Ok(None)
        }
        None => Ok(None),
    };
    let (torque_max, velocity_max) = (positive("effort")?, positive("velocity")?);
    let dynamics = joint.child(joint.node, "dynamics")?;
    let dissipation = |key| {
        let value = dynamics.map_or(Ok(None), |node| joint.number_if_any(node, key))?;
        let value = value.unwrap_or(0.0);
        if value < 0.0 {
            return Err(joint.error(format!("<dynamics {key}=\"{value}\"> must not be negative")));
        }
        Ok(value)
    };
    let (viscous, coulomb) = (dissipation("damping")?, dissipation("friction")?);
    Ok(Joint {
        name: joint.name.to_owned(),
        kind,
        position,
        velocity_max,
        torque_max,
        torque_rate_max: None,
        armature: 0.0,
        friction: Friction { viscous, coulomb, sigmoid: None },
        drive_bandwidth_hz: None,
        encoder_bits: None,
    })
}

fn at_most(origin: &str, what: &'static str, found: usize, limit: usize) -> Result<()> {
    if found <= limit {
        return Ok(());
    }
    Err(RobotError::TooMuch { origin: origin.to_owned(), what, found, limit })
}
