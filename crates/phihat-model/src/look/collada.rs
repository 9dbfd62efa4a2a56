//! COLLADA: meshes, and the nodes of the scene that place them. Axes are read as they are, whatever
//! `<up_axis>` states, as viewers of ROS do.

use std::collections::BTreeMap;

use roxmltree::{Document, Node, ParsingOptions};

use super::soup::{Result, Soup, Unread};
use crate::placement::{about, normalised};

/// Most nodes of XML.
const NODES_MAX: u32 = 200_000;
/// Deepest nesting of elements: what walks through them calls itself.
const DEPTH_MAX: usize = 64;

/// `x ↦ m x + p`, scales included.
type MeshAffine = ([[f64; 3]; 3], [f64; 3]);

/// Elements by their `id`.
type Ids<'a, 'x> = BTreeMap<&'a str, Node<'a, 'x>>;

pub(super) fn read(bytes: &[u8], room: usize) -> Result<Soup> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not UTF-8 text")?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: NODES_MAX, ..Default::default() };
    shallow(text)?;
    let document = Document::parse_with_options(text.trim_start_matches('\u{feff}'), options);
    let document = document.map_err(|why| Unread::from(why.to_string()))?;
    let root = document.root_element();
    let ids: Ids<'_, '_> =
        root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let unit = child(root, "asset").and_then(|asset| child(asset, "unit"));
    let unit = unit.and_then(|unit| unit.attribute("meter")?.parse().ok()).unwrap_or(1.0);
    let whole: MeshAffine = ([[unit, 0.0, 0.0], [0.0, unit, 0.0], [0.0, 0.0, unit]], [0.0; 3]);
    let scene = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let scene = scene.and_then(|scene| target(&ids, scene, "url"));
    let scene = scene.or_else(|| root.descendants().find(|node| node.has_tag_name("visual_scene")));
    let mut all = Walk { ids, soup: Soup::default(), room, left: 10_000 };
    match scene {
        Some(scene) => all.node(scene, whole, DEPTH_MAX)?,
        None => {
            for geometry in root.descendants().filter(|node| node.has_tag_name("geometry")) {
                all.geometry(geometry, whole)?;
            }
        }
    }
    Ok(all.soup)
}

/// That elements do not stand in elements without end, which the parser would follow.
fn shallow(text: &str) -> Result<()> {
    let mut depth = 0_usize;
    for piece in text.split('<').skip(1) {
        let open = !piece.starts_with(['/', '!', '?']);
        let tag = piece.split('>').next().unwrap_or_default();
        depth = match () {
            () if open && !tag.ends_with('/') => depth + 1,
            () if piece.starts_with('/') => depth.saturating_sub(1),
            () => depth,
        };
        if depth > DEPTH_MAX {
            return Err(format!("elements stand {DEPTH_MAX} deep in each other").into());
        }
    }
    Ok(())
}

fn child<'a, 'x>(node: Node<'a, 'x>, tag: &str) -> Option<Node<'a, 'x>> {
    node.children().find(|child| child.tag_name().name() == tag)
}

fn target<'a, 'x>(ids: &Ids<'a, 'x>, node: Node<'a, 'x>, key: &str) -> Option<Node<'a, 'x>> {
    ids.get(node.attribute(key)?.strip_prefix('#')?).copied()
}

fn numbers(node: Node<'_, '_>) -> Result<Vec<f64>> {
    let text = node.text().unwrap_or_default();
    let all: Option<Vec<f64>> =
        text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    all.ok_or_else(|| format!("<{}> has what is no number", node.tag_name().name()).into())
}

struct Walk<'a, 'x> {
    ids: Ids<'a, 'x>,
    soup: Soup,
    room: usize,
    /// Nodes that may still come: those that name each other would go on for ever.
    left: usize,
}

impl<'a, 'x> Walk<'a, 'x> {
    fn node(&mut self, node: Node<'a, 'x>, at: MeshAffine, depth: usize) -> Result<()> {
        if depth == 0 || self.left == 0 {
            return Err("its nodes go on without end".into());
        }
        self.left -= 1;
        let mut at = at;
        for child in node.children() {
            match child.tag_name().name() {
                "matrix" | "translate" | "rotate" | "scale" => at = then(&at, &step(child)?),
                "node" => self.node(child, at, depth - 1)?,
                "instance_node" => {
                    if let Some(other) = target(&self.ids, child, "url") {
                        self.node(other, at, depth - 1)?;
                    }
                }
                "instance_geometry" => {
                    if let Some(geometry) = target(&self.ids, child, "url") {
                        self.geometry(geometry, at)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn geometry(&mut self, geometry: Node<'a, 'x>, at: MeshAffine) -> Result<()> {
        let Some(mesh) = child(geometry, "mesh") else { return Ok(()) };
        for part in mesh.children() {
            if matches!(part.tag_name().name(), "triangles" | "polylist" | "polygons") {
                self.faces(part, at)?;
            }
            if self.soup.triangles.len() > self.room {
                return Err("it has too many triangles".into());
            }
        }
        Ok(())
    }

    /// The faces of one list, with the points that they have.
    fn faces(&mut self, part: Node<'a, 'x>, at: MeshAffine) -> Result<()> {
        let inputs = part
            .children()
            .filter(|node| node.has_tag_name("input") || node.tag_name().name() == "input");
        let offset =
            |node: &Node<'_, '_>| node.attribute("offset").and_then(|o| o.parse::<usize>().ok());
        let (mut stride, mut own) = (1, None);
        for input in inputs {
            let at = offset(&input).unwrap_or(0).min(64);
            stride = stride.max(at + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                own = target(&self.ids, input, "source").map(|vertices| (vertices, at));
            }
        }
        let (vertices, at_vertex) = own.ok_or("faces without points")?;
        let first = self.soup.points.len();
        let points = self.points(vertices)?;
        self.soup.points.extend(points.iter().map(|p| apply(&at, *p)));
        let count = points.len();
        let sizes = child(part, "vcount").map(numbers).transpose()?;
        for list in part.children().filter(|node| node.tag_name().name() == "p") {
            let mut corners = Vec::new();
            let text = list.text().unwrap_or_default();
            for word in text.split_ascii_whitespace().skip(at_vertex).step_by(stride) {
                let corner = word.parse::<usize>().ok().filter(|corner| *corner < count);
                corners.push(first + corner.ok_or("a corner that is no point")?);
            }
            self.cut(part, &corners, sizes.as_deref());
        }
        Ok(())
    }

    /// A list of corners as faces: three each, as many as a list says, or all of them one.
    fn cut(&mut self, part: Node<'_, '_>, corners: &[usize], sizes: Option<&[f64]>) {
        match (part.tag_name().name(), sizes) {
            ("triangles", _) => corners.chunks_exact(3).for_each(|face| self.soup.face(face)),
            ("polylist", Some(sizes)) => {
                let mut rest = corners;
                for size in sizes {
                    // A number that was counted: not negative, and cut off at what is there.
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "saturates"
                    )]
                    let (face, more) = rest.split_at((*size as usize).min(rest.len()));
                    self.soup.face(face);
                    rest = more;
                }
            }
            _ => self.soup.face(corners),
        }
    }

    /// The positions that a `<vertices>` names.
    fn points(&self, vertices: Node<'a, 'x>) -> Result<Vec<[f64; 3]>> {
        let position =
            vertices.children().find(|node| node.attribute("semantic") == Some("POSITION"));
        let source = position.and_then(|input| target(&self.ids, input, "source"));
        let source = source.ok_or("points without a source")?;
        let array = child(source, "float_array").ok_or("a source without numbers")?;
        let accessor = source.descendants().find(|node| node.tag_name().name() == "accessor");
        let stride = accessor.and_then(|node| node.attribute("stride")?.parse().ok());
        let stride: usize = stride.filter(|stride| (3..=16).contains(stride)).unwrap_or(3);
        let numbers = numbers(array)?;
        Ok(numbers.chunks_exact(stride).map(|point| [point[0], point[1], point[2]]).collect())
    }
}

/// Transform of one element of a node.
fn step(node: Node<'_, '_>) -> Result<MeshAffine> {
    const ONE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let n = numbers(node)?;
    match (node.tag_name().name(), &n[..]) {
        ("matrix", [a, b, c, x, d, e, f, y, g, h, i, z, ..]) => {
            Ok(([[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]], [*x, *y, *z]))
        }
        ("translate", [x, y, z]) => Ok((ONE, [*x, *y, *z])),
        ("scale", [x, y, z]) => Ok(([[*x, 0.0, 0.0], [0.0, *y, 0.0], [0.0, 0.0, *z]], [0.0; 3])),
        ("rotate", [x, y, z, degrees]) => {
            let axis = normalised([*x, *y, *z]);
            Ok((axis.map_or(ONE, |axis| about(axis, degrees.to_radians())), [0.0; 3]))
        }
        (name, _) => Err(format!("<{name}> has {} numbers", n.len()).into()),
    }
}

fn apply((m, p): &MeshAffine, x: [f64; 3]) -> [f64; 3] {
    crate::placement::add(*p, crate::placement::apply(m, x))
}

/// First `inner`, then `outer`.
fn then(outer: &MeshAffine, inner: &MeshAffine) -> MeshAffine {
    (crate::placement::mul(&outer.0, &inner.0), apply(outer, inner.1))
}
