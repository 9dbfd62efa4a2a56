//! From the text of a URDF to links, joints and their limits.

use std::borrow::Cow;
use std::collections::BTreeSet;

use roxmltree::{Document, Node};

use super::element::{Element, ElementSource};
use super::scan;
use super::travel::{reach, read_limits, read_moves};
use crate::body::{Body, LumpedBody};
use crate::description::{JointMotion, JointOf};
use crate::error::RobotError;
use crate::joint::JointKind;
use crate::placement::{dot, normalised};
use crate::whole::{
    DescribedFile, JointElement, LINKS_MAX, LinkElement, Moves, Result, StatedJoint, checked_matter,
};

/// Most prefixes that are declared for a file that forgot to.
const PREFIXES_MAX: usize = 8;

/// Links and joints of a URDF; `origin` stands for the file in errors.
pub(crate) fn described(document: &Document<'_>, origin: &str) -> Result<DescribedFile> {
    let root = robot_element(document, origin)?;
    let (mut warnings, source) = (Vec::new(), ElementSource::of(origin, document.input_text()));
    let links = read_links(root, &source)?;
    let joints = read_joints(root, &source, &mut warnings)?;
    Ok(DescribedFile {
        name: root.attribute("name").unwrap_or("robot").to_owned(),
        origin: origin.to_owned(),
        included: Vec::new(),
        links,
        joints,
        follows: "<mimic>",
        gravity: None,
        poses: std::collections::BTreeMap::new(),
        warnings,
        notes: source.notes(),
    })
}

/// The text with prefixes declared that nobody declared: what other programs read beside us.
pub(crate) fn readable<'t>(text: &'t str, origin: &str) -> Result<Cow<'t, str>> {
    scan::scan(text, origin)?;
    // Where C strings end, some programs write their last byte too.
    let mut text = Cow::Borrowed(text.trim_end_matches(['\0', '\u{feff}', '\u{1a}']));
    // Where comments stand before the declaration it says nothing: blanks take its place, for the lines to stay.
    if let Some(start) = text.find("<?xml").filter(|start| *start > 0)
        && let Some(length) = text[start..].find("?>")
    {
        let end = start + length + "?>".len();
        let blank = |c: char| if c == '\n' { c } else { ' ' };
        let declared: String = text[start..end].chars().map(blank).collect();
        text = Cow::Owned(format!("{}{declared}{}", &text[..start], &text[end..]));
    }
    Ok(declared(text))
}

/// The text of a description with the prefixes declared on its root that nobody declared.
pub(crate) fn declared(mut text: Cow<'_, str>) -> Cow<'_, str> {
    for _ in 0..PREFIXES_MAX {
        let Err(roxmltree::Error::UnknownNamespace(prefix, _)) = Document::parse(&text) else {
            break;
        };
        let Some(start) = text.find("<robot") else { break };
        let (before, after) = text.split_at(start + "<robot".len());
        text = Cow::Owned(format!("{before} xmlns:{prefix}=\"undeclared:{prefix}\"{after}"));
    }
    text
}

fn xacro(line: u32, origin: &str) -> RobotError {
    let why = "this is xacro, which writes URDF: expand it first, `phihat robots FILE.xacro --urdf FILE.urdf`";
    RobotError::Xml { origin: origin.to_owned(), line, why: why.to_owned() }
}

/// The root element, which must be a robot's, all expanded.
fn robot_element<'a, 'x>(document: &'a Document<'x>, origin: &str) -> Result<Node<'a, 'x>> {
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        let tag = root.tag_name().name();
        let hint = match tag {
            "mujocoinclude" => " (this is a part of MJCF; the file that includes it is read)",
            "sdf" => " (this is SDF, which is not read; the URDF that it was made from is)",
            _ => "",
        };
        let why =
            format!("the root element is <{tag}>; it must be <robot>, or <mujoco> of MJCF{hint}");
        return Err(RobotError::Xml { origin: origin.to_owned(), line: 1, why });
    }
    // Properties and arguments that nothing uses are left out.
    let unused = |node: &Node<'_, '_>| {
        matches!(node.tag_name().name(), "property" | "arg")
            && !document.input_text().contains("${")
    };
    let written = |node: &Node<'_, '_>| {
        node.tag_name().namespace().is_some_and(|space| space.contains("xacro")) && !unused(node)
    };
    if let Some(node) = root.descendants().find(written) {
        return Err(xacro(document.text_pos_at(node.range().start).row, origin));
    }
    Ok(root)
}

fn read_links<'a>(root: Node<'a, '_>, source: &'a ElementSource<'a>) -> Result<Vec<LinkElement>> {
    let nodes = || root.children().filter(|child| child.has_tag_name("link"));
    at_most(source.origin, "links", nodes().count(), LINKS_MAX)?;
    let mut names = BTreeSet::new();
    let mut links = Vec::new();
    for node in nodes() {
        let element = Element::of(node, source)?;
        if !names.insert(element.name) {
            return Err(element.error("another link has this name".to_owned()));
        }
        links.push(LinkElement { matter: read_matter(&element), element: element.named() });
    }
    Ok(links)
}

/// Mass properties in a link's `<inertial>`, and its oddities.
fn read_matter(link: &Element<'_, '_>) -> Result<(LumpedBody, Vec<String>)> {
    let mut all = link.node.children().filter(|child| child.has_tag_name("inertial"));
    let Some(inertial) = all.next() else { return Ok((LumpedBody::default(), Vec::new())) };
    let mut more = None;
    if all.next().is_some() {
        let name = link.name;
        more = Some(format!(
            "link \"{name}\": more than one <inertial>; the first is read, as others do"
        ));
    }
    let part = |tag: &str| {
        link.child(inertial, tag)?.ok_or_else(|| link.error(format!("<inertial> has no <{tag}>")))
    };
    let (mass, inertia) = (link.number(part("mass")?, "value")?, part("inertia")?);
    let entry = |key| link.number(inertia, key);
    let [xx, xy, xz] = [entry("ixx")?, entry("ixy")?, entry("ixz")?];
    let [yy, yz, zz] = [entry("iyy")?, entry("iyz")?, entry("izz")?];
    let at = link.placement(inertial)?;
    let stated = Body { mass, com: [0.0; 3], inertia: [xx, xy, xz, yy, yz, zz] };
    let (matter, odd) = checked_matter(&link.named(), (stated, &at))?;
    Ok((matter, more.into_iter().chain(odd).collect()))
}

fn read_joints<'a>(
    root: Node<'a, '_>,
    source: &'a ElementSource<'a>,
    warnings: &mut Vec<String>,
) -> Result<Vec<JointElement>> {
    let mut names = BTreeSet::new();
    let mut joints: Vec<JointElement> = Vec::new();
    for node in root.children().filter(|child| child.has_tag_name("joint")) {
        let element = Element::of(node, source)?;
        if !names.insert(element.name) {
            return Err(element.error("another joint has this name".to_owned()));
        }
        at_most(source.origin, "joints", joints.len() + 1, LINKS_MAX)?;
        joints.push(read_joint(element, source, warnings)?);
    }
    Ok(joints)
}

fn read_joint(
    element: Element<'_, '_>,
    source: &ElementSource<'_>,
    warnings: &mut Vec<String>,
) -> Result<JointElement> {
    let node = element.node;
    let moves = read_moves(&element)?;
    let end = |tag: &str| {
        let missing = || element.error(format!("it has no <{tag} link=…>"));
        element.text(element.child(node, tag)?.ok_or_else(missing)?, "link").map(str::to_owned)
    };
    let (parent, child) = (end("parent")?, end("child")?);
    let kind = match moves {
        Moves::Not | Moves::Free(_) => None,
        Moves::Driven(kind) | Moves::Follows { kind, .. } => Some(kind),
    };
    let axis = match kind {
        None => [1.0, 0.0, 0.0],
        Some(_) => read_axis(&element, warnings)?,
    };
    let motion = match kind {
        None => JointMotion::Fixed,
        Some(JointKind::Prismatic) => JointMotion::Prismatic,
        Some(_) => JointMotion::Revolute,
    };
    let placement = element.placement(node)?;
    let joint = JointOf { name: element.name.to_owned(), motion, parent: 0, placement, axis };
    let reach = kind.and_then(|kind| reach(&element, kind));
    let stated = match moves {
        Moves::Driven(kind) => {
            let mut odd = Vec::new();
            let (read, notes) = source.apart(|| read_limits(&element, kind, &mut odd));
            Some(read.map(|joint| StatedJoint { joint, warnings: odd, notes }))
        }
        _ => None,
    };
    let (element, drawn_at) = (element.named(), 0.0);
    Ok(JointElement { element, parent, child, joint, moves, reach, drawn_at, stated })
}

fn read_axis(joint: &Element<'_, '_>, warnings: &mut Vec<String>) -> Result<[f64; 3]> {
    let stated = joint.vector(joint.first_child(joint.node, "axis"), "xyz", [1.0, 0.0, 0.0])?;
    let axis = normalised(stated)
        .ok_or_else(|| joint.error(format!("axis {stated:?} has no direction")))?;
    if (dot(stated, axis) - 1.0).abs() > 1e-3 {
        warnings.push(format!("joint \"{}\": axis {stated:?} is not of length 1", joint.name));
    }
    Ok(axis)
}

fn at_most(origin: &str, what: &'static str, found: usize, limit: usize) -> Result<()> {
    if found <= limit {
        return Ok(());
    }
    Err(RobotError::TooMuch { origin: origin.to_owned(), what, found, limit })
}
