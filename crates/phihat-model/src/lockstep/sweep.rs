//! The recursions of `Model::forward_dynamics` for chains, one arm per lane of the number type.

use super::part::LockstepSegment;
use crate::Scalar;
use crate::description::JointMotion;
use crate::inertia::LinkInertia;
use crate::inverse_dynamics::Gamma;
use crate::vector::{Turn, Vec3};

/// Force and moment.
type WrenchLanes<S> = (Vec3<S>, Vec3<S>);

/// Result of the recursions: the upper triangle of `M`, and `bias − τ`.
struct System<S, const N: usize> {
    m: [[S; N]; N],
    rhs: [S; N],
}

/// Sines and shifts of the second screws at the positions of the moment.
pub(crate) struct ScrewLanes<S, const N: usize> {
    pub(crate) sines: [S; N],
    pub(crate) cosines: [S; N],
    pub(crate) shifts: [S; N],
}

/// Accelerations of chains of at most `N` segments.
#[inline(always)]
pub(super) fn forward<S: Scalar, const N: usize>(
    (parts, lift): (&[LockstepSegment<S>], Vec3<S>),
    [q, dq, tau]: [&[S]; 3],
    ddq: &mut [S],
) {
    let screws = ScrewLanes::<S, N>::at(parts, q);
    placed((parts, lift), &screws, [dq, tau], ddq);
}

/// Rest of [`forward`] once sines and shifts are known.
#[inline(always)]
pub(crate) fn placed<S: Scalar, const N: usize>(
    (parts, lift): (&[LockstepSegment<S>], Vec3<S>),
    screws: &ScrewLanes<S, N>,
    [dq, tau]: [&[S]; 2],
    ddq: &mut [S],
) {
    let wrenches = out((parts, lift), screws, dq);
    let mut system = back(parts, screws, &wrenches, tau);
    eliminate(&mut system, ddq);
}

impl<S: Scalar, const N: usize> ScrewLanes<S, N> {
    #[inline(always)]
    fn at(parts: &[LockstepSegment<S>], q: &[S]) -> Self {
        let mut screws = Self {
            sines: [S::splat(0.0); N],
            cosines: [S::splat(0.0); N],
            shifts: [S::splat(0.0); N],
        };
        for (i, part) in parts.iter().enumerate() {
            let angle = match part.motion {
                JointMotion::Revolute => q[part.first] + part.theta,
                _ => part.theta,
            };
            (screws.sines[i], screws.cosines[i]) = angle.sin_cos();
            let slides = part.motion == JointMotion::Prismatic;
            screws.shifts[i] = if slides { q[part.first] + part.d } else { part.d };
        }
        screws
    }

    #[inline(always)]
    fn turn(&self, i: usize) -> Turn<S> {
        Turn { c: self.cosines[i], s: self.sines[i] }
    }
}

/// From base to tips: the wrench that every segment's own matter takes at `q̈ = 0`.
#[inline(always)]
fn out<S: Scalar, const N: usize>(
    (parts, lift): (&[LockstepSegment<S>], Vec3<S>),
    screws: &ScrewLanes<S, N>,
    dq: &[S],
) -> [WrenchLanes<S>; N] {
    let nothing = Vec3::<S>::zero();
    let mut wrenches = [(nothing, nothing); N];
    let (mut omega, mut alpha, mut acc) = (nothing, nothing, lift);
    for (i, part) in parts.iter().enumerate() {
        let turn = screws.turn(i);
        if part.shape.reaches {
            let (w, l) = (omega, alpha);
            let reach = Vec3::new(-(w.y * w.y + w.z * w.z), w.x * w.y + l.z, w.x * w.z - l.y);
            acc += reach.scale(part.a);
        }
        let inward = |v| turn.into_z(part.tilt_in(v));
        (omega, alpha, acc) = (inward(omega), inward(alpha), inward(acc));
        match part.motion {
            JointMotion::Revolute => {
                let dq = dq[part.first];
                alpha.x += omega.y * dq;
                alpha.y += -(omega.x * dq);
                omega.z += dq;
            }
            JointMotion::Prismatic => {
                let twice = dq[part.first] + dq[part.first];
                acc += Vec3::new(omega.y * twice, -(omega.x * twice), S::splat(0.0));
            }
            JointMotion::Fixed => {}
        }
        let g = Gamma::of(omega, alpha);
        if part.shape.slides {
            acc += Vec3::new(g.xz, g.yz, g.zz).scale(screws.shifts[i]);
        }
        let (h, [xx, yy, zz, xy, xz, yz]) = (part.matter.h, part.sigma);
        let turning = Vec3::new(
            (g.zx * xy + g.zy * yy + g.zz * yz) - (g.yx * xz + g.yy * yz + g.yz * zz),
            (g.xx * xz + g.xy * yz + g.xz * zz) - (g.zx * xx + g.zy * xy + g.zz * xz),
            (g.yx * xx + g.yy * xy + g.yz * xz) - (g.xx * xy + g.xy * yy + g.xz * yz),
        );
        wrenches[i] = (acc.scale(part.matter.m) + g.apply(h), turning + h.cross(acc));
    }
    wrenches
}

/// From tips to base: composite inertias, the columns of `M`, and the bias as one more column.
#[inline(always)]
fn back<S: Scalar, const N: usize>(
    parts: &[LockstepSegment<S>],
    screws: &ScrewLanes<S, N>,
    wrenches: &[WrenchLanes<S>; N],
    tau: &[S],
) -> System<S, N> {
    let n = tau.len();
    let nothing = (Vec3::zero(), Vec3::zero());
    let (mut columns, mut bias) = ([nothing; N], nothing);
    let mut system = System { m: [[S::splat(0.0); N]; N], rhs: [S::splat(0.0); N] };
    let mut inertia = LinkInertia::default();
    for (i, part) in parts.iter().enumerate().rev() {
        let first = part.first;
        let last = i + 1 == parts.len();
        inertia = if last { part.matter } else { inertia.plus(&part.matter) };
        bias.0 += wrenches[i].0;
        bias.1 += wrenches[i].1;
        let slides = part.motion == JointMotion::Prismatic;
        if part.motion != JointMotion::Fixed {
            let along = |(force, moment): &WrenchLanes<S>| if slides { force.z } else { moment.z };
            columns[first] = unit_wrench(slides, &inertia);
            for j in first..n {
                system.m[first][j] = along(&columns[j]);
            }
            system.m[first][first] += part.armature;
            system.rhs[first] = along(&bias) - tau[first];
        }
        if i == 0 {
            break;
        }
        let (turn, d) = (screws.turn(i), screws.shifts[i]);
        let moved = part.inertia_out_x(&inertia.out_z((turn, d)));
        let outward = |(force, mut moment): WrenchLanes<S>| {
            if part.shape.slides {
                moment.x -= d * force.y;
                moment.y += d * force.x;
            }
            let force = part.tilt_out(turn.out_z(force));
            let mut moment = part.tilt_out(turn.out_z(moment));
            if part.shape.reaches {
                moment.y -= part.a * force.z;
                moment.z += part.a * force.y;
            }
            (force, moment)
        };
        inertia = moved;
        for column in &mut columns[first..n] {
            *column = outward(*column);
        }
        bias = outward(bias);
    }
    system
}

/// The wrench that accelerates `inertia` at unit rate along its joint.
#[inline(always)]
fn unit_wrench<S: Scalar>(slides: bool, inertia: &LinkInertia<S>) -> WrenchLanes<S> {
    let h = inertia.h;
    if slides {
        (Vec3::new(S::splat(0.0), S::splat(0.0), inertia.m), Vec3::new(h.y, -h.x, S::splat(0.0)))
    } else {
        (Vec3::new(-h.y, h.x, S::splat(0.0)), Vec3::new(inertia.xz, inertia.yz, inertia.zz))
    }
}

/// Solves `M q̈ = τ − bias` in pivot order.
#[inline(always)]
fn eliminate<S: Scalar, const N: usize>(System { m, rhs }: &mut System<S, N>, ddq: &mut [S]) {
    let n = ddq.len();
    for k in 0..n {
        let inverse = S::splat(1.0) / m[k][k];
        // Where the diagonal's inverse is kept until the end.
        ddq[k] = inverse;
        for row in k + 1..n {
            let factor = m[k][row] * inverse;
            for column in row..n {
                let part = factor * m[k][column];
                m[row][column] -= part;
            }
            let part = factor * rhs[k];
            rhs[row] -= part;
        }
    }
    for k in (0..n).rev() {
        let mut left = rhs[k];
        for j in k + 1..n {
            left += m[k][j] * ddq[j];
        }
        ddq[k] = -(left * ddq[k]);
    }
}
