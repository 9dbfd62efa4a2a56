//! Shapes of an arm for drawing, as its URDF gives them to its links, where their files can be read.
//!
//! # Method
//!
//! A `<visual>` is a box, a cylinder, a ball, or a mesh in a file (STL, OBJ, COLLADA). All are triangles
//! here, in metres and in the axes of their link. Where they are more than requested, points that share a
//! cell of a grid become one, their mean, and triangles that lose a corner go; the cell is the smallest, to a
//! few per cent, that leaves no more triangles than requested. So no point moves by more than the diagonal of
//! a cell.
//!
//! # Not claimed
//!
//! Colours and textures are not read; nor is collision geometry. Nothing here is ever computed with: it is for drawing.

use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use crate::kinematics::Pose;
use crate::placement::{Placement, from_rpy};
use crate::robot_text::read_text;
use crate::{Robot, urdf};

mod collada;
mod file;
mod obj;
mod primitive;
mod reduce;
mod soup;
mod stl;

pub use soup::LinkShape;
use soup::{Result, Soup, TRIANGLES_MAX, Unread, plain};

/// Shapes of a robot, as far as its files describe them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Look {
    /// One for each link that has one.
    pub shapes: Vec<LinkShape>,
    /// Links whose shape could not be read, and why, in words.
    pub missing: Vec<(String, String)>,
    /// Triangles of all files, before they became fewer.
    pub triangles_read: usize,
}

impl Robot {
    /// Shapes of the robot in its URDF, in at most `triangles` triangles; files outside of the folder
    /// `within` are not read, if one is given. Links that cannot be read are listed in [`Look::missing`],
    /// which is no error: an arm can be drawn without them.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat_model::Robot;
    ///
    /// // The arms that come with the crate have no meshes.
    /// assert!(Robot::named("panda")?.look(1000, None).shapes.is_empty());
    /// # Ok::<(), phihat_model::RobotError>(())
    /// ```
    pub fn look(&self, triangles: usize, within: Option<&Path>) -> Look {
        let is_urdf =
            |path: &&PathBuf| path.extension().is_none_or(|extension| extension != "toml");
        let Some(path) = self.files.iter().find(is_urdf) else { return Look::default() };
        // It was read before: what is wrong with it was told then.
        let Ok(text) = read_text(&self.source, path) else { return Look::default() };
        let Ok(text) = urdf::readable(&text, "") else { return Look::default() };
        let Ok(document) = Document::parse(&text) else { return Look::default() };
        let known = self.model.frame_names();
        let mut look = Look::default();
        let files = file::Files { urdf: path, within };
        let links = document.root_element().children().filter(|node| node.has_tag_name("link"));
        let mut soups = Vec::new();
        for link in links {
            let Some(name) = link.attribute("name").filter(|name| known.iter().any(|k| k == name))
            else {
                continue;
            };
            let mut soup = Soup::default();
            for visual in link.children().filter(|node| node.has_tag_name("visual")) {
                let room = TRIANGLES_MAX.saturating_sub(look.triangles_read);
                match shape(visual, &files, room) {
                    Ok(own) => {
                        look.triangles_read += own.triangles.len();
                        soup.add(&own);
                    }
                    Err(why) => look.missing.push((name.to_owned(), why.to_string())),
                }
            }
            if !soup.triangles.is_empty() {
                soups.push((name.to_owned(), soup));
            }
        }
        look.shapes = reduce::reduced(&soups, triangles);
        look
    }
}

/// The shape of a `<visual>` in its link's axes.
fn shape(visual: Node<'_, '_>, files: &file::Files<'_>, room: usize) -> Result<Soup> {
    let child = |node: Node<'_, '_>, tag| {
        node.children().find(|child| child.has_tag_name(tag)).map(|n| n.id())
    };
    let find =
        |node: Node<'_, '_>, tag| child(node, tag).and_then(|id| visual.document().get_node(id));
    let at = find(visual, "origin").map_or(Ok(Placement::IDENTITY), |origin| {
        let p = numbers(origin, "xyz")?.unwrap_or([0.0; 3]);
        Ok::<_, Unread>(Placement { r: from_rpy(numbers(origin, "rpy")?.unwrap_or([0.0; 3])), p })
    })?;
    let at = Pose { p: at.p, r: at.r };
    let geometry = find(visual, "geometry").ok_or("a <visual> without <geometry>")?;
    let kind = geometry.children().find(Node::is_element).ok_or("an empty <geometry>")?;
    let one = |key| -> Result<f64> {
        Ok(numbers::<1>(kind, key)?.ok_or_else(|| format!("no \"{key}\""))?[0])
    };
    let soup = match kind.tag_name().name() {
        "box" => primitive::cuboid(numbers(kind, "size")?.ok_or("a box without a size")?),
        "cylinder" => primitive::cylinder(one("radius")?, one("length")?),
        "sphere" => primitive::ball(one("radius")?),
        "mesh" => {
            let name = kind.attribute("filename").ok_or("a mesh without a file")?;
            let scale = numbers(kind, "scale")?.unwrap_or([1.0; 3]);
            return sound(files.mesh(name, room)?.moved(&at, scale), name);
        }
        other => return Err(format!("<{}> is no shape of a URDF", plain(other)).into()),
    };
    sound(soup.moved(&at, [1.0; 3]), "a shape")
}

fn sound(soup: Soup, name: &str) -> Result<Soup> {
    let wrong = || format!("{}: its points are not those of a robot", plain(name));
    if soup.sound() { Ok(soup) } else { Err(wrong().into()) }
}

/// So many finite numbers of an attribute, if it is there.
fn numbers<const N: usize>(node: Node<'_, '_>, key: &str) -> Result<Option<[f64; N]>> {
    let Some(text) = node.attribute(key) else { return Ok(None) };
    let words: Option<Vec<f64>> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    let found = words.and_then(|words| <[f64; N]>::try_from(words).ok());
    found.map(Some).ok_or_else(|| format!("{key}=\"{}\" is not {N} numbers", plain(text)).into())
}
