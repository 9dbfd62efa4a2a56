//! Bodies of the world, one inside the other: links and joints.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::actuators::Actuators;
use super::attributes::{finite, wrong};
use super::classes::DefaultClasses;
use super::compiler::CompilerSettings;
use super::equality::FollowerOf;
use super::inertia::StatedMatter;
use super::joint::JointOfBody;
use super::orientation::{own_pose, pose};
use super::{geom, inertia};
use crate::body::LumpedBody;
use crate::description::{JointMotion, JointOf};
use crate::error::RobotError;
use crate::markup::MarkupElement;
use crate::placement::Placement;
use crate::whole::{JointElement, LINKS_MAX, Moves, NamedElement, Result};

/// Link that stands still.
pub(super) const WORLD: &str = "world";

/// Content of a file other than its bodies.
pub(super) struct Surroundings<'m> {
    pub(super) settings: &'m CompilerSettings,
    pub(super) classes: &'m DefaultClasses,
    pub(super) actuators: &'m Actuators,
    pub(super) followers: &'m BTreeMap<String, FollowerOf>,
}

/// Matter of a link, before the mass of all is known.
pub(super) struct LinkOfBody {
    pub(super) element: NamedElement,
    pub(super) matter: Result<StatedMatter>,
    /// Oddities that count where a joint moves it.
    pub(super) odd: Vec<String>,
}

/// Position of a joint in a posture of the whole file.
pub(super) struct Coordinate {
    pub(super) joint: Option<String>,
    pub(super) size: usize,
}

/// Links and joints as they are met.
pub(super) struct Bodies<'m> {
    about: Surroundings<'m>,
    names: Names,
    pub(super) links: Vec<LinkOfBody>,
    pub(super) joints: Vec<JointElement>,
    pub(super) coordinates: Vec<Coordinate>,
    /// Reference position of each joint.
    pub(super) references: BTreeMap<String, f64>,
    /// Number of those met.
    count: usize,
}

/// Names that are taken, of links and of joints.
#[derive(Default)]
struct Names {
    links: BTreeSet<String>,
    joints: BTreeSet<String>,
}

impl Names {
    /// Names that bodies and joints have; what they say is found in error later.
    fn collect(&mut self, element: &MarkupElement) {
        if let Some(name) = element.attribute("name") {
            match &*element.name {
                "body" => drop(self.links.insert(name.to_owned())),
                "joint" | "freejoint" => drop(self.joints.insert(name.to_owned())),
                _ => {}
            }
        }
        for child in element.elements() {
            self.collect(child);
        }
    }

    /// A name that nothing has.
    fn fresh(taken: &mut BTreeSet<String>, mut name: String) -> String {
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        name
    }
}

/// Elements of a body, gathered from it and the frames in it.
#[derive(Default)]
struct InsideBody<'m> {
    inertial: Option<&'m MarkupElement>,
    joints: Vec<(&'m MarkupElement, usize, Placement)>,
    geoms: Vec<(&'m MarkupElement, usize, Placement)>,
    sites: Vec<(&'m MarkupElement, usize, Placement)>,
    bodies: Vec<(&'m MarkupElement, usize, Placement)>,
}

impl<'m> Bodies<'m> {
    /// Links and joints of all worlds of a file.
    pub(super) fn of(root: &'m MarkupElement, about: Surroundings<'m>) -> Result<Self> {
        let mut names = Names::default();
        names.links.insert(WORLD.to_owned());
        let worlds = || root.elements().filter(|section| section.name == "worldbody");
        for world in worlds() {
            names.collect(world);
        }
        let mut all = Self {
            about,
            names,
            links: Vec::new(),
            joints: Vec::new(),
            coordinates: Vec::new(),
            references: BTreeMap::new(),
            count: 0,
        };
        let element = named(root, WORLD.to_owned(), true);
        let matter = Ok(StatedMatter::none(Placement::IDENTITY));
        all.links.push(LinkOfBody { element, matter, odd: Vec::new() });
        for world in worlds() {
            let mut inside = InsideBody::default();
            all.gather(world, (0, Placement::IDENTITY), &mut inside)?;
            for body in inside.bodies {
                all.body(body, WORLD)?;
            }
        }
        Ok(all)
    }

    /// Elements of a body, and of the frames in it, each with its class and its frame.
    fn gather(
        &self,
        element: &'m MarkupElement,
        (class, frame): (usize, Placement),
        into: &mut InsideBody<'m>,
    ) -> Result<()> {
        for child in element.elements() {
            let place = (child, class, frame);
            match &*child.name {
                "inertial" => into.inertial = Some(child),
                "joint" | "freejoint" => into.joints.push(place),
                "geom" => into.geoms.push(place),
                "site" => into.sites.push(place),
                "body" => into.bodies.push(place),
                "frame" => {
                    let class = self.about.classes.named(child, "childclass", class)?;
                    let own = own_pose(child, self.about.settings)?;
                    self.gather(child, (class, frame.then(&own)), into)?;
                }
                "camera" | "light" => {}
                "attach" | "replicate" | "composite" => {
                    let why = "it is not read: MuJoCo's `compile` writes a file in which the bodies stand that it \
                        makes";
                    return Err(wrong(child, why));
                }
                "flexcomp" | "plugin" => {
                    return Err(wrong(child, "it is not read: an arm is of rigid bodies"));
                }
                _ => return Err(wrong(child, "it is no element of a body")),
            }
        }
        Ok(())
    }

    fn body(
        &mut self,
        (element, class, frame): (&'m MarkupElement, usize, Placement),
        parent: &str,
    ) -> Result<()> {
        self.count += 1;
        let name = match element.attribute("name").filter(|name| !name.is_empty()) {
            Some(name) => name.to_owned(),
            None => Names::fresh(&mut self.names.links, format!("body{}", self.count)),
        };
        let class = self.about.classes.named(element, "childclass", class)?;
        let mut inside = InsideBody::default();
        self.gather(element, (class, Placement::IDENTITY), &mut inside)?;
        let own = own_pose(element, self.about.settings)?;
        let at = self.hang((element, &name), &inside, (parent.to_owned(), frame.then(&own)))?;
        self.weld((element, &name), at, false)?;
        self.matter((element, &name), &inside, own)?;
        self.sites(&inside, &name)?;
        for body in inside.bodies {
            self.body(body, &name)?;
        }
        Ok(())
    }

    /// Joints of a body on a link, each with a link of its own; the link that the body is then welded to, and its pose
    /// there, `None` where the last joint moves the body itself.
    fn hang(
        &mut self,
        (body, name): (&MarkupElement, &str),
        inside: &InsideBody<'_>,
        (mut above, mut at): (String, Placement),
    ) -> Result<Option<(String, Placement)>> {
        for (n, (element, class, frame)) in inside.joints.iter().enumerate() {
            let joint = self.about.classes.with(element, *class)?;
            let read = if element.name == "freejoint" {
                JointOfBody::free()
            } else {
                JointOfBody::of(&joint, self.about.settings, frame)?
            };
            let named = self.joint_name(element, read.reference)?;
            let stated = read.stated((&named, &joint), self.about.settings, self.about.actuators);
            let is_body =
                n + 1 == inside.joints.len() && read.anchor.iter().all(|x| x.abs() <= 0.0);
            let child = if is_body {
                name.to_owned()
            } else {
                self.link_between(body, format!("{name}/{}", named.name))?
            };
            let (kind, size) = read.kind();
            let coordinate = Some(named.name.clone()).filter(|_| kind.is_some());
            self.coordinates.push(Coordinate { joint: coordinate, size });
            let joint = read.at((&at, kind), named.name.clone());
            at = Placement { p: read.anchor.map(|x| -x), ..Placement::IDENTITY };
            self.joints.push(JointElement {
                element: named,
                parent: std::mem::replace(&mut above, child.clone()),
                child,
                joint,
                moves: read.moves,
                reach: read.travel.filter(|(low, high)| low < high),
                drawn_at: read.reference,
                stated,
            });
            if is_body {
                return Ok(None);
            }
        }
        Ok(Some((above, at)))
    }

    /// Name and place of a joint, which is at `reference` where the file is drawn.
    fn joint_name(&mut self, element: &MarkupElement, reference: f64) -> Result<NamedElement> {
        let stated = element.attribute("name").filter(|name| !name.is_empty()).map(str::to_owned);
        let number = self.coordinates.len();
        let fresh = || Names::fresh(&mut self.names.joints, format!("joint{number}"));
        let name = stated.unwrap_or_else(fresh);
        if self.references.insert(name.clone(), reference).is_some() {
            return Err(wrong(element, "another joint has this name"));
        }
        Ok(named(element, name, false))
    }

    /// A link without matter between two joints of a body.
    fn link_between(&mut self, body: &MarkupElement, name: String) -> Result<String> {
        let name = Names::fresh(&mut self.names.links, name);
        let element = named(body, name.clone(), true);
        let matter = Ok(StatedMatter::none(Placement::IDENTITY));
        self.push_link(LinkOfBody { element, matter, odd: Vec::new() })?;
        Ok(name)
    }

    /// Welds a link to another one, unless a joint moves it itself.
    fn weld(
        &mut self,
        (element, name): (&MarkupElement, &str),
        at: Option<(String, Placement)>,
        is_site: bool,
    ) -> Result<()> {
        let Some((parent, placement)) = at else { return Ok(()) };
        if self.links.len() >= LINKS_MAX {
            return Err(too_many(element.place.file.to_string()));
        }
        let words = if is_site { "to site" } else { "to" };
        let own = Names::fresh(&mut self.names.joints, format!("{words} {name}"));
        let axis = [1.0, 0.0, 0.0];
        let motion = JointMotion::Fixed;
        self.joints.push(JointElement {
            element: named(element, own.clone(), false),
            parent,
            child: name.to_owned(),
            joint: JointOf { name: own, motion, parent: 0, placement, axis },
            moves: Moves::Not,
            reach: None,
            drawn_at: 0.0,
            stated: None,
        });
        Ok(())
    }

    fn matter(
        &mut self,
        (element, name): (&MarkupElement, &str),
        inside: &InsideBody<'_>,
        pose: Placement,
    ) -> Result<()> {
        let about = &self.about;
        let geom = |(geom, class, frame): &(&MarkupElement, usize, Placement)| {
            geom::matter(&about.classes.with(geom, *class)?, about.settings, frame)
        };
        let geoms: Result<Vec<LumpedBody>> =
            inside.geoms.iter().map(geom).filter_map(Result::transpose).collect();
        let matter = inertia::of_body((inside.inertial, geoms), about.settings, pose);
        let mut odd = Vec::new();
        let helped = finite::<1>(element, "gravcomp")?;
        if let Some([share]) = helped.filter(|[share]| *share != 0.0) {
            odd.push(format!(
                "link \"{name}\": gravcomp=\"{share}\" is not read: its weight is the drives' here"
            ));
        }
        let element = named(element, name.to_owned(), true);
        self.push_link(LinkOfBody { element, matter, odd })
    }

    /// Sites as links without mass, under their names, where no body has them.
    fn sites(&mut self, inside: &InsideBody<'_>, body: &str) -> Result<()> {
        for (element, class, frame) in &inside.sites {
            let Some(name) = element.attribute("name").filter(|name| !name.is_empty()) else {
                continue;
            };
            if !self.names.links.insert(name.to_owned()) {
                continue;
            }
            let site = self.about.classes.with(element, *class)?;
            let at = match site.finite::<6>("fromto")? {
                Some([ax, ay, az, bx, by, bz]) => {
                    let p = [0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz)];
                    Placement { p, ..Placement::IDENTITY }
                }
                None => pose(&site, self.about.settings)?,
            };
            self.weld((element, name), Some((body.to_owned(), frame.then(&at))), true)?;
            let element = named(element, name.to_owned(), true);
            let matter = Ok(StatedMatter::none(Placement::IDENTITY));
            self.push_link(LinkOfBody { element, matter, odd: Vec::new() })?;
        }
        Ok(())
    }

    fn push_link(&mut self, link: LinkOfBody) -> Result<()> {
        if self.links.len() >= LINKS_MAX {
            let origin = link.element.origin.to_string();
            return Err(too_many(origin));
        }
        self.links.push(link);
        Ok(())
    }

    /// Joints that follow others, where both are joints that move.
    pub(super) fn follow(&mut self) {
        for joint in &mut self.joints {
            let Some(follower) = self.about.followers.get(&joint.element.name) else { continue };
            let (Moves::Driven(kind), Some(leader)) =
                (&joint.moves, self.references.get(&follower.leader))
            else {
                continue;
            };
            let (constant, factor) = follower.line;
            joint.moves = Moves::Follows {
                kind: *kind,
                leader: follower.leader.clone(),
                factor,
                offset: joint.drawn_at + constant - factor * leader,
            };
        }
    }
}

fn named(element: &MarkupElement, name: String, is_link: bool) -> NamedElement {
    let origin = Rc::clone(&element.place.file);
    NamedElement { name, origin, line: element.place.line, is_link }
}

fn too_many(origin: String) -> RobotError {
    RobotError::TooMuch { origin, what: "links", found: LINKS_MAX + 1, limit: LINKS_MAX }
}
