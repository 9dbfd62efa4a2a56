//! From a description to the form the recursions run on: modified Denavit–Hartenberg.
//!
//! # Method
//!
//! A moving joint's frame may turn about its axis z and slide along it without changing the
//! mechanics. Using that freedom, the pose of every body in its parent is two screws,
//!
//! ```text
//! T = Rx(α) Tx(a) · Rz(θ) Tz(d)                                                    (1)
//! ```
//!
//! with `θ = q + θ₀` (revolute) or `d = q + d₀` (prismatic). Each constant placement is split as
//! `Rz(γ) Tz(b) · Rx(α) Tx(a) · Rz(θ₀) Tz(d₀)`: x is the common normal of the two axes. `γ` and `b`
//! go into the parent's own `θ₀` and `d₀` for its first child, and into a massless body between
//! the two for any other child. Nearly parallel axes, whose common normal is far away, get such a
//! body too. Two planar rotations per body cost half of one general rotation.
//!
//! # References
//!
//! W. Khalil, J. F. Kleinfinger, "A new geometric notation for open and closed-loop robots", ICRA
//! 1986.

use crate::Scalar;
use crate::body::LumpedBody;
use crate::columns::LANES;
use crate::description::{Description, JointMotion, JointOf};
use crate::placement::{Placement, SNAP, about, apply, mul, transpose, with_z_along};
use crate::segment::Segment;
use crate::shape::SegmentShape;
use crate::straight::Kernel;
use crate::vector::Turn;

/// Axes this close to parallel (sine of the angle) do not use their common normal.
const NEARLY_PARALLEL: f64 = 0.05;

/// Position of a link in the compiled form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seat {
    /// Segment that carries the link; `None`: the base, and then `at` is the pose in the world.
    pub(crate) segment: Option<usize>,
    /// Pose of the link in the segment's frame.
    pub(crate) at: Placement,
}

/// The compiled form of a description.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Compiled {
    pub(crate) segments: Vec<Segment>,
    /// `θ₀` \[rad\] of each segment; zeros at the end fill up whole vectors.
    pub(crate) theta: Vec<f64>,
    /// True if segments and coordinates are one to one, and all revolute.
    pub(crate) plain: bool,
    /// Code written out for this structure.
    pub(crate) kernel: Option<Kernel>,
    /// Pose of the base frame, in which the first segment's `α` and `a` are 0, in the world.
    pub(crate) base: Placement,
    /// One seat per link of the description.
    pub(crate) seats: Vec<Seat>,
    /// Segment of each coordinate.
    pub(crate) segment_of_joint: Vec<usize>,
    /// Link that each coordinate moves.
    pub(crate) link_of_joint: Vec<usize>,
    /// Matter of each coordinate, fixed links merged, in the moved link's axes.
    pub(crate) lumped: Vec<LumpedBody>,
}

/// The two screws and the gauge of one placement.
#[derive(Debug, Clone, Copy)]
struct CompiledScrews {
    gamma: f64,
    b: f64,
    /// A segment between parent and child, for nearly parallel axes: its `a` and `θ`.
    detour: Option<(f64, f64)>,
    cos_alpha: f64,
    sin_alpha: f64,
    a: f64,
    theta: f64,
    d: f64,
}

/// A moving joint on its way to becoming a segment.
struct Mover<'a> {
    joint: &'a JointOf,
    link: usize,
    parent: Option<usize>,
    /// From the axes with z along the joint axis into the link's axes.
    align: Placement,
    screws: CompiledScrews,
    /// Turn and slide about its own axis that its first child asks for.
    gauge: (f64, f64),
    first: bool,
}

pub(crate) fn compile(description: &Description) -> Compiled {
    let anchors = anchor_links(description);
    let mut movers: Vec<Mover<'_>> = Vec::new();
    let mut base: Option<Placement> = None;
    for (link, joint) in description.moving() {
        let (parent, at) = anchors[joint.parent];
        let align = Placement { r: with_z_along(joint.axis), p: [0.0; 3] };
        let in_link = at.then(&joint.placement).then(&align);
        let first = match parent {
            None => base.is_none(),
            Some(p) => !movers.iter().any(|m: &Mover<'_>| m.parent == Some(p)),
        };
        let origin = match parent {
            None => *base.get_or_insert(in_link),
            Some(p) => movers[p].align,
        };
        let screws = CompiledScrews::of(&origin.inverse().then(&in_link));
        if first && let Some(p) = parent {
            movers[p].gauge = (screws.gamma, screws.b);
        }
        movers.push(Mover { joint, link, parent, align, screws, gauge: (0.0, 0.0), first });
    }
    let base = base.unwrap_or(Placement::IDENTITY);
    assemble(description, &anchors, &movers, base)
}

/// Per link: the moving joint (by coordinate) it is rigidly attached to, and its pose in that
/// joint's child link.
fn anchor_links(description: &Description) -> Vec<(Option<usize>, Placement)> {
    let mut anchors: Vec<(Option<usize>, Placement)> = Vec::new();
    let mut coordinate = 0;
    for link in &description.links {
        let anchor = match &link.joint {
            None => (None, Placement::IDENTITY),
            Some(joint) if joint.motion == JointMotion::Fixed => {
                let (mover, at) = anchors[joint.parent];
                (mover, at.then(&joint.placement))
            }
            Some(_) => {
                coordinate += 1;
                (Some(coordinate - 1), Placement::IDENTITY)
            }
        };
        anchors.push(anchor);
    }
    anchors
}

fn assemble(
    description: &Description,
    anchors: &[(Option<usize>, Placement)],
    movers: &[Mover<'_>],
    base: Placement,
) -> Compiled {
    let mut lumped = vec![LumpedBody::default(); movers.len()];
    for (link, (mover, at)) in description.links.iter().zip(anchors) {
        if let Some(j) = *mover {
            lumped[j] = lumped[j].plus(&link.matter.seen_from(at));
        }
    }
    let mut segments: Vec<Segment> = Vec::new();
    let mut thetas: Vec<f64> = Vec::new();
    let mut segment_of_joint: Vec<usize> = Vec::new();
    let mut frames: Vec<Placement> = Vec::new();
    for (j, mover) in movers.iter().enumerate() {
        let mut parent = mover.parent.map(|p| segment_of_joint[p]);
        let gauge = if mover.first { None } else { mover.parent.map(|p| movers[p].gauge) };
        let (gamma, b) = match (mover.first, gauge) {
            (true, _) => (0.0, 0.0),
            (false, Some((gamma, b))) => (mover.screws.gamma - gamma, mover.screws.b - b),
            (false, None) => (mover.screws.gamma, mover.screws.b),
        };
        let bridges = [(0.0, gamma, b)].into_iter().filter(|_| !mover.first);
        let detours = mover.screws.detour.map(|(a, theta)| (a, theta, 0.0));
        for (a, theta, d) in bridges.chain(detours) {
            thetas.push(theta);
            segments.push(Segment::massless(parent, a, d));
            parent = Some(segments.len() - 1);
        }
        // Link to final frame: align z, then the gauge.
        let frame = mover.align.then(&Placement::screw_z(mover.gauge.0, mover.gauge.1));
        frames.push(frame);
        thetas.push(mover.screws.theta + mover.gauge.0);
        segments.push(Segment::moving(j, mover, parent, &lumped[j].seen_from(&frame.inverse())));
        segment_of_joint.push(segments.len() - 1);
    }
    link_up(&mut segments);
    let seat = |&(mover, at): &(Option<usize>, Placement)| match mover {
        None => Seat { segment: None, at },
        Some(j) => Seat { segment: Some(segment_of_joint[j]), at: frames[j].inverse().then(&at) },
    };
    let seats = anchors.iter().map(seat).collect();
    let link_of_joint = movers.iter().map(|mover| mover.link).collect();
    let plain = segments.len() == movers.len()
        && segments.iter().all(|segment| segment.motion == JointMotion::Revolute);
    let shapes: Vec<SegmentShape> =
        segments.iter().map(|segment| SegmentShape::shared(&[segment])).collect();
    let chain = (1..segments.len()).all(|i| segments[i].follows_parent(i));
    let kernel = if plain && chain { Kernel::of(&shapes) } else { None };
    thetas.resize(segments.len().next_multiple_of(LANES), 0.0);
    Compiled {
        segments,
        theta: thetas,
        plain,
        kernel,
        base,
        seats,
        segment_of_joint,
        link_of_joint,
        lumped,
    }
}

/// Tells every segment what hangs on it.
fn link_up(segments: &mut [Segment]) {
    for i in (0..segments.len()).rev() {
        if segments[i].motion != JointMotion::Fixed {
            let (first, end) = segments[i].coordinates;
            let own = segments[i].joint;
            segments[i].coordinates = (first.min(own), end.max(own + 1));
        }
        let (first, end) = segments[i].coordinates;
        if let Some(p) = segments[i].parent {
            segments[p].forks = segments[p].bears;
            segments[p].bears = true;
            let (so_far, so_far_end) = segments[p].coordinates;
            segments[p].coordinates = (so_far.min(first), so_far_end.max(end));
        }
    }
}

impl Segment {
    /// Returns true if this is the first segment on its parent, given its own index.
    #[inline(always)]
    pub(crate) fn follows_parent(&self, index: usize) -> bool {
        self.parent.is_some_and(|parent| parent + 1 == index)
    }

    /// The first screw: its rotation and its `a`.
    #[inline(always)]
    pub(crate) fn tilt<S: Scalar>(&self) -> (Turn<S>, S) {
        let turn = Turn { c: S::splat(self.cos_alpha), s: S::splat(self.sin_alpha) };
        (turn, S::splat(self.a))
    }

    fn massless(parent: Option<usize>, a: f64, d: f64) -> Self {
        let nothing = [0.0; 6];
        Self {
            motion: JointMotion::Fixed,
            joint: 0,
            parent,
            bears: false,
            forks: false,
            coordinates: (usize::MAX, 0),
            cos_alpha: 1.0,
            sin_alpha: 0.0,
            a,
            d,
            m: 0.0,
            h: [0.0; 3],
            i: nothing,
            sigma: nothing,
        }
    }

    fn moving(joint: usize, mover: &Mover<'_>, parent: Option<usize>, matter: &LumpedBody) -> Self {
        let i = &matter.i;
        let half = 0.5 * (i[0][0] + i[1][1] + i[2][2]);
        let second = [half - i[0][0], half - i[1][1], half - i[2][2]];
        let off = [i[0][1], i[0][2], i[1][2]];
        Self {
            motion: mover.joint.motion,
            joint,
            cos_alpha: mover.screws.cos_alpha,
            sin_alpha: mover.screws.sin_alpha,
            a: mover.screws.a,
            d: mover.screws.d + mover.gauge.1,
            m: matter.m,
            h: matter.h,
            i: [i[0][0], i[1][1], i[2][2], off[0], off[1], off[2]],
            sigma: [second[0], second[1], second[2], -off[0], -off[1], -off[2]],
            ..Self::massless(parent, 0.0, 0.0)
        }
    }
}

impl CompiledScrews {
    /// Splits `at` as in the module's text.
    fn of(at: &Placement) -> Self {
        let [[_, _, c02], [_, _, c12], [_, _, c22]] = at.r;
        let tilt = libm::hypot(c02, c12);
        let reach = libm::hypot(at.p[0], at.p[1]);
        let tilt_direction = libm::atan2(c02, -c12);
        let reach_direction = if reach > SNAP { libm::atan2(at.p[1], at.p[0]) } else { 0.0 };
        if tilt < SNAP {
            let r = [[1.0, 0.0, 0.0], [0.0, c22.signum(), 0.0], [0.0, 0.0, c22.signum()]];
            let theta = turn_left(&r, reach_direction, at);
            let d = at.p[2] * c22.signum();
            Self::plain(reach_direction, 0.0, (c22.signum(), 0.0, reach), theta, d)
        } else if tilt < NEARLY_PARALLEL {
            let theta = turn_left(&tilt_about_x(c22, tilt), tilt_direction, at);
            let detour = Some((reach, tilt_direction - reach_direction));
            let screws = Self::plain(reach_direction, at.p[2], (c22, tilt, 0.0), theta, 0.0);
            Self { detour, ..screws }
        } else {
            let cos = if c22.abs() < SNAP { 0.0 } else { c22 };
            let sin = if c22.abs() < SNAP { 1.0 } else { tilt };
            let theta = turn_left(&tilt_about_x(cos, sin), tilt_direction, at);
            let back = transpose(&about([0.0, 0.0, 1.0], tilt_direction));
            let [a, y, z] = apply(&back, at.p);
            let d = -y / sin;
            Self::plain(tilt_direction, z - cos * d, (cos, sin, a), theta, d)
        }
    }

    fn plain(gamma: f64, b: f64, x: (f64, f64, f64), theta: f64, d: f64) -> Self {
        let (cos_alpha, sin_alpha, a) = x;
        Self { gamma, b, detour: None, cos_alpha, sin_alpha, a, theta, d }
    }
}

fn tilt_about_x(cos: f64, sin: f64) -> [[f64; 3]; 3] {
    [[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]]
}

/// The angle about z that is left of `at` after `Rz(gamma)` and `tilt`.
fn turn_left(tilt: &[[f64; 3]; 3], gamma: f64, at: &Placement) -> f64 {
    let done = mul(&about([0.0, 0.0, 1.0], gamma), tilt);
    let left = mul(&transpose(&done), &at.r);
    libm::atan2(left[1][0], left[0][0])
}
