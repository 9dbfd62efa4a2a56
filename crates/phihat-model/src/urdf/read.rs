//! From the text of a URDF to links, joints and their limits.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use roxmltree::{Document, Node};

use super::element::{Element, ElementSource};
use super::part::WholeDescription;
use super::travel::{Moves, read_limits, read_moves};
use super::tree::{JointElement, LinkElement, Tree};
use super::{Result, Urdf, scan};
use crate::body::{Body, LumpedBody};
use crate::description::{JointMotion, JointOf};
use crate::error::RobotError;
use crate::input::plain;
use crate::joint::{Joint, JointKind};
use crate::part::{Chain, MotionOnly, Part};
use crate::placement::{dot, mul, normalised, transpose};
use crate::{Model, Workspace};

/// Most links, and most joints: far more than any robot has.
const LINKS_MAX: usize = 4096;
/// Most joints of an arm.
const MOVING_MAX: usize = 32;
/// Radius of gyration, and distance of a centre of mass, beyond which units are doubted \[m\].
const FAR: f64 = 5.0;
/// Most prefixes that are declared for a file that forgot to.
const PREFIXES_MAX: usize = 8;

/// Elements of a description before it is known which part of it is the arm.
type Elements<'a, 'x> = (Vec<LinkElement<'a, 'x>>, Vec<JointElement<'a, 'x>>);

/// Reads and checks a part of a URDF; `origin` stands for the file in errors.
pub(crate) fn read(text: &str, part: &Part, origin: &str) -> Result<Urdf> {
    let text = &readable(text, origin)?;
    let document = document(text, origin)?;
    let root = robot_element(&document, origin)?;
    let (mut warnings, source) = (Vec::new(), ElementSource::of(origin));
    let (mut links, mut joints) = elements(root, &source, &mut warnings)?;
    let tree = Tree::of(&links, &joints, origin)?;
    let whole = WholeDescription { links: &links, joints: &joints, tree: &tree, origin };
    let cut = whole.cut(part, &mut warnings)?;
    let moving = cut.driven.iter().filter(|driven| **driven).count();
    if moving > MOVING_MAX {
        let proposed = whole.chains().into_iter().find(|chain| chain.joints.len() <= MOVING_MAX);
        return Err(too_many(moving, proposed.as_ref(), origin));
    }
    let driven = driven_joints((&joints, &tree), &cut.driven, &mut warnings)?;
    let mut held = BTreeMap::new();
    for (at, joint) in joints.iter_mut().enumerate().filter(|(at, _)| !cut.driven[*at]) {
        if joint.joint.motion != JointMotion::Fixed {
            held.insert(joint.element.name.to_owned(), cut.at[at]);
        }
        joint.joint.hold(cut.at[at]);
    }
    let matter = matter(&mut links, (&tree, &cut.driven), &mut warnings)?;
    let (description, order) = tree.describe(&links, &joints, &matter);
    let name = root.attribute("name").unwrap_or("robot").to_owned();
    let model = Model::new(description);
    if let Some(at) = unmoved(&model) {
        let at = order.iter().filter(|at| cut.driven[**at]).nth(at).copied().unwrap_or(0);
        let joint = &joints[at].element;
        if matter.iter().all(|body| *body == LumpedBody::default()) {
            let (origin, line, joint) = (origin.to_owned(), joint.line(), joint.name.to_owned());
            return Err(RobotError::NoInertia { origin, line, joint });
        }
        let why = format!(
            "it moves no mass, so torque has nothing to act on: link \"{}\" and what is welded to it need an <inertial>",
            joints[at].child
        );
        return Err(joint.error(why));
    }
    warnings.extend(source.notes());
    Ok(Urdf { name, model, joints: driven, held, warnings })
}

/// Joints of a part of a URDF with their limits, in the order of their links, whatever its links weigh.
pub(crate) fn joints(text: &str, part: &Part, origin: &str) -> Result<MotionOnly> {
    let text = &readable(text, origin)?;
    let document = document(text, origin)?;
    let root = robot_element(&document, origin)?;
    let (mut warnings, source) = (Vec::new(), ElementSource::of(origin));
    let (links, joints) = elements(root, &source, &mut warnings)?;
    let tree = Tree::of(&links, &joints, origin)?;
    let whole = WholeDescription { links: &links, joints: &joints, tree: &tree, origin };
    let cut = whole.cut(part, &mut warnings)?;
    let name = root.attribute("name").unwrap_or("robot").to_owned();
    let joints = driven_joints((&joints, &tree), &cut.driven, &mut warnings)?;
    warnings.extend(source.notes());
    Ok(MotionOnly { name, joints, warnings: warnings.iter().map(|own| plain(own)).collect() })
}

/// Joints that are driven, with their limits, in the order of their links.
fn driven_joints(
    (joints, tree): (&[JointElement<'_, '_>], &Tree),
    driven: &[bool],
    warnings: &mut Vec<String>,
) -> Result<Vec<Joint>> {
    let mut read = Vec::new();
    for link in &tree.order {
        let Some(at) = tree.hangs[*link].filter(|at| driven[*at]) else { continue };
        if let Moves::Driven(kind) = joints[at].moves {
            read.push(read_limits(&joints[at].element, kind, warnings)?);
        }
    }
    Ok(read)
}

/// The chains of a URDF that could be arms, the longest first.
pub(crate) fn chains(text: &str, origin: &str) -> Result<Vec<Chain>> {
    let text = &readable(text, origin)?;
    let document = document(text, origin)?;
    let root = robot_element(&document, origin)?;
    let source = ElementSource::of(origin);
    let (links, joints) = elements(root, &source, &mut Vec::new())?;
    let tree = Tree::of(&links, &joints, origin)?;
    Ok(WholeDescription { links: &links, joints: &joints, tree: &tree, origin }.chains())
}

fn too_many(moving: usize, proposed: Option<&Chain>, origin: &str) -> RobotError {
    let remedy = proposed.map_or_else(String::new, |chain| {
        let Chain { base, tip, joints } = chain;
        format!(", such as base = \"{base}\", tip = \"{tip}\" ({} joints)", joints.len())
    });
    let why = format!(
        "{moving} joints move, more than the {MOVING_MAX} of an arm: name the arm's base and tip{remedy}"
    );
    RobotError::SeveralArms { origin: origin.to_owned(), why }
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

fn document<'t>(text: &'t str, origin: &str) -> Result<Document<'t>> {
    Document::parse(text).map_err(|error| RobotError::Xml {
        origin: origin.to_owned(),
        line: error.pos().row,
        why: error.to_string(),
    })
}

/// The root element, which must be a robot's, all expanded.
fn robot_element<'a, 'x>(document: &'a Document<'x>, origin: &str) -> Result<Node<'a, 'x>> {
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        let tag = root.tag_name().name();
        let hint = match tag {
            "mujoco" => " (this is MJCF: in Python, `phihat.mujoco.describe` writes a URDF of it)",
            "sdf" => " (this is SDF, which is not read; the URDF that it was made from is)",
            _ => "",
        };
        let why = format!("the root element is <{tag}>; it must be <robot>{hint}");
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

fn elements<'a, 'x>(
    root: Node<'a, 'x>,
    source: &'a ElementSource<'a>,
    warnings: &mut Vec<String>,
) -> Result<Elements<'a, 'x>> {
    Ok((read_links(root, source)?, read_joints(root, source, warnings)?))
}

/// Matter of every link. What is wrong with it counts where a joint moves it.
fn matter(
    links: &mut [LinkElement<'_, '_>],
    (tree, driven): (&Tree, &[bool]),
    warnings: &mut Vec<String>,
) -> Result<Vec<LumpedBody>> {
    let mut moved = vec![false; links.len()];
    for at in &tree.order {
        let Some(joint) = tree.hangs[*at] else { continue };
        moved[*at] = driven[joint] || moved[tree.parent_of_joint[joint]];
    }
    let one = |(link, moved): (&mut LinkElement<'_, '_>, bool)| {
        let read = std::mem::replace(&mut link.matter, Ok((LumpedBody::default(), Vec::new())));
        match read {
            Ok((matter, odd)) => {
                if moved {
                    warnings.extend(odd);
                }
                Ok(matter)
            }
            Err(why) if moved => Err(why),
            Err(why) => {
                warnings.push(format!("{why} (nothing moves it, so it is not needed)"));
                Ok(LumpedBody::default())
            }
        }
    };
    links.iter_mut().zip(moved).map(one).collect()
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
    source: &'a ElementSource<'a>,
) -> Result<Vec<LinkElement<'a, 'x>>> {
    let nodes = || root.children().filter(|child| child.has_tag_name("link"));
    at_most(source.origin, "links", nodes().count(), LINKS_MAX)?;
    let mut names = BTreeSet::new();
    let mut links = Vec::new();
    for node in nodes() {
        let element = Element::of(node, source)?;
        if !names.insert(element.name) {
            return Err(element.error("another link has this name".to_owned()));
        }
        links.push(LinkElement { element, matter: read_matter(&element) });
    }
    Ok(links)
}

/// Mass properties in a link's `<inertial>`, and its oddities.
fn read_matter(link: &Element<'_, '_>) -> Result<(LumpedBody, Vec<String>)> {
    let mut all = link.node.children().filter(|child| child.has_tag_name("inertial"));
    let Some(inertial) = all.next() else { return Ok((LumpedBody::default(), Vec::new())) };
    let mut odd = Vec::new();
    if all.next().is_some() {
        let name = link.name;
        odd.push(format!(
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
    let mut stated = Body { mass, com: [0.0; 3], inertia: [xx, xy, xz, yy, yz, zz] };
    if let Some(raised) = stated.raised_if_rounded() {
        let by = raised.inertia[0] - stated.inertia[0];
        odd.push(format!(
            "link \"{}\": inertia with a negative principal moment, by rounding: all three raised by {by:.1e} kg·m²",
            link.name
        ));
        stated = raised;
    }
    stated.check().map_err(|why| link.error(why.to_string()))?;
    if !stated.obeys_triangle_inequality() {
        odd.push(format!(
            "link \"{}\": no mass distribution has this inertia (triangle inequality)",
            link.name
        ));
    }
    if mass <= 0.0 && stated.inertia.iter().any(|x| x.abs() > 0.0) {
        odd.push(format!("link \"{}\": it has inertia but no mass", link.name));
    }
    odd.extend(doubts(link, &at.p, &stated));
    let [xx, xy, xz, yy, yz, zz] = stated.inertia;
    let turned = mul(&mul(&at.r, &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), &transpose(&at.r));
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = turned;
    Ok((Body { com: at.p, inertia: [xx, xy, xz, yy, yz, zz], ..stated }.lumped(), odd))
}

/// Doubts about the units of a link's figures: no link of an arm is this large.
fn doubts(link: &Element<'_, '_>, centre: &[f64; 3], body: &Body) -> Vec<String> {
    let mut odd = Vec::new();
    let place = |why: String| format!("link \"{}\" (line {}): {why}", link.name, link.line());
    let [xx, _, _, yy, _, zz] = body.inertia;
    let largest = xx.max(yy).max(zz);
    let gyration = (largest / body.mass).sqrt();
    if body.mass > 0.0 && gyration > FAR {
        odd.push(place(format!(
            "an inertia of {largest} kg·m² with a mass of {} kg is a radius of gyration of {gyration:.3} m; if it is kg·mm², divide by 1e6, if g·mm², by 1e9",
            body.mass
        )));
    }
    let away = dot(*centre, *centre).sqrt();
    if away > FAR {
        odd.push(place(format!(
            "the centre of mass is {away:.3} m from the link's frame; if it is in mm, divide by 1000"
        )));
    }
    odd
}

fn read_joints<'a, 'x>(
    root: Node<'a, 'x>,
    source: &'a ElementSource<'a>,
    warnings: &mut Vec<String>,
) -> Result<Vec<JointElement<'a, 'x>>> {
    let mut names = BTreeSet::new();
    let mut joints: Vec<JointElement<'a, 'x>> = Vec::new();
    for node in root.children().filter(|child| child.has_tag_name("joint")) {
        let element = Element::of(node, source)?;
        if !names.insert(element.name) {
            return Err(element.error("another joint has this name".to_owned()));
        }
        at_most(source.origin, "joints", joints.len() + 1, LINKS_MAX)?;
        joints.push(read_joint(element, warnings)?);
    }
    Ok(joints)
}

fn read_joint<'a, 'x>(
    element: Element<'a, 'x>,
    warnings: &mut Vec<String>,
) -> Result<JointElement<'a, 'x>> {
    let node = element.node;
    let moves = read_moves(&element)?;
    let end = |tag: &str| {
        let missing = || element.error(format!("it has no <{tag} link=…>"));
        element.text(element.child(node, tag)?.ok_or_else(missing)?, "link")
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
    Ok(JointElement { element, parent, child, joint, moves })
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
