//! The recursions of `Model::forward_dynamics`, one arm per lane.

use super::part::{Part, zero};
use crate::description::Motion;
use crate::inertia::Inertia;
use crate::inverse_dynamics::Gamma;
use crate::vector::{Turn, Vec3};
use crate::{Lanes, Scalar};

/// Force and moment, one of each per lane.
type Wrench = (Vec3<Lanes>, Vec3<Lanes>);

/// What the recursions leave: the upper triangle of `M`, and `bias − τ`.
struct System<const N: usize> {
    m: [[Lanes; N]; N],
    rhs: [Lanes; N],
}

/// Sines and shifts of the second screws at the positions of the moment.
struct Screws<const N: usize> {
    sines: [Lanes; N],
    cosines: [Lanes; N],
    shifts: [Lanes; N],
}

/// Accelerations of chains of at most `N` segments; `PLAIN`: of exactly so many, all revolute.
#[inline(always)]
pub(super) fn forward<const N: usize, const PLAIN: bool>(
    (parts, lift): (&[Part], Vec3<Lanes>),
    [q, dq, tau]: [&[Lanes]; 3],
    ddq: &mut [Lanes],
) {
    let (segments, n) = if PLAIN { (N, N) } else { (parts.len(), ddq.len()) };
    let (parts, ddq) = (&parts[..segments], &mut ddq[..n]);
    let [q, dq, tau] = [&q[..n], &dq[..n], &tau[..n]];
    let screws = Screws::<N>::at::<PLAIN>(parts, q);
    let wrenches = out::<N, PLAIN>((parts, lift), &screws, dq);
    let mut system = back::<N, PLAIN>(parts, &screws, &wrenches, tau);
    eliminate(&mut system, ddq);
}

impl<const N: usize> Screws<N> {
    #[inline(always)]
    fn at<const PLAIN: bool>(parts: &[Part], q: &[Lanes]) -> Self {
        let mut screws = Self { sines: [zero(); N], cosines: [zero(); N], shifts: [zero(); N] };
        for (i, part) in parts.iter().enumerate() {
            let turns = PLAIN || part.motion == Motion::Revolute;
            let angle = if turns { q[joint::<PLAIN>(i, part)] + part.theta } else { part.theta };
            (screws.sines[i], screws.cosines[i]) = angle.sin_cos();
            let slides = !PLAIN && part.motion == Motion::Prismatic;
            screws.shifts[i] = if slides { q[part.first] + part.d } else { part.d };
        }
        screws
    }

    #[inline(always)]
    fn turn(&self, i: usize) -> Turn<Lanes> {
        Turn { c: self.cosines[i], s: self.sines[i] }
    }
}

/// The coordinate of a segment that moves.
#[inline(always)]
fn joint<const PLAIN: bool>(i: usize, part: &Part) -> usize {
    if PLAIN { i } else { part.first }
}

/// From base to tips: the wrench that every segment's own matter takes at `q̈ = 0`.
#[inline(always)]
fn out<const N: usize, const PLAIN: bool>(
    (parts, lift): (&[Part], Vec3<Lanes>),
    screws: &Screws<N>,
    dq: &[Lanes],
) -> [Wrench; N] {
    let nothing = Vec3::<Lanes>::zero();
    let mut wrenches = [(nothing, nothing); N];
    let (mut omega, mut alpha, mut acc) = (nothing, nothing, lift);
    let mut rest = parts.iter().enumerate();
    if PLAIN && let Some((i, part)) = rest.next() {
        // It turns about its own axis alone, and of its wrench only the moment about that axis counts: what is zero or counts for
        // nothing is not computed.
        acc = screws.turn(i).into_z(part.tilt_in(acc));
        omega.z = dq[i];
        wrenches[i].1.z = part.matter.h.cross(acc).z;
    }
    for (i, part) in rest {
        let turn = screws.turn(i);
        if part.reaches {
            let (w, l) = (omega, alpha);
            let reach = Vec3::new(-(w.y * w.y + w.z * w.z), w.x * w.y + l.z, w.x * w.z - l.y);
            acc += reach.scale(part.a);
        }
        let inward = |v| turn.into_z(part.tilt_in(v));
        (omega, alpha, acc) = (inward(omega), inward(alpha), inward(acc));
        match part.motion {
            _ if PLAIN => turned(&mut omega, &mut alpha, dq[i]),
            Motion::Revolute => turned(&mut omega, &mut alpha, dq[part.first]),
            Motion::Prismatic => {
                let twice = dq[part.first] + dq[part.first];
                acc += Vec3::new(omega.y * twice, -(omega.x * twice), zero());
            }
            Motion::Fixed => {}
        }
        let g = Gamma::of(omega, alpha);
        if part.slides {
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

/// Adds the rate of a joint that turns.
#[inline(always)]
fn turned(omega: &mut Vec3<Lanes>, alpha: &mut Vec3<Lanes>, dq: Lanes) {
    alpha.x += omega.y * dq;
    alpha.y += -(omega.x * dq);
    omega.z += dq;
}

/// From tips to base: composite inertias, the columns of `M`, and the bias as one more column.
#[inline(always)]
fn back<const N: usize, const PLAIN: bool>(
    parts: &[Part],
    screws: &Screws<N>,
    wrenches: &[Wrench; N],
    tau: &[Lanes],
) -> System<N> {
    let n = tau.len();
    let nothing = (Vec3::zero(), Vec3::zero());
    let (mut columns, mut bias) = ([nothing; N], nothing);
    let mut system = System { m: [[zero(); N]; N], rhs: [zero(); N] };
    let mut inertia = Inertia::default();
    for (i, part) in parts.iter().enumerate().rev() {
        let first = joint::<PLAIN>(i, part);
        let last = i + 1 == parts.len();
        inertia = if last { part.matter } else { inertia.plus(&part.matter) };
        bias.0 += wrenches[i].0;
        bias.1 += wrenches[i].1;
        let slides = !PLAIN && part.motion == Motion::Prismatic;
        if PLAIN || part.motion != Motion::Fixed {
            let along = |(force, moment): &Wrench| if slides { force.z } else { moment.z };
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
        let outward = |(force, mut moment): Wrench| {
            if part.slides {
                moment.x -= d * force.y;
                moment.y += d * force.x;
            }
            let force = part.tilt_out(turn.out_z(force));
            let mut moment = part.tilt_out(turn.out_z(moment));
            if part.reaches {
                moment.y -= part.a * force.z;
                moment.z += part.a * force.y;
            }
            (force, moment)
        };
        if PLAIN && i == 1 {
            // Of what arrives at the first joint, only what is about its axis counts.
            let [own, ..] = parts else { break };
            for j in 1..n {
                system.m[0][j] = outward(columns[j]).1.z;
            }
            system.m[0][0] = moved.zz + own.matter.zz + own.armature;
            system.rhs[0] = outward(bias).1.z + wrenches[0].1.z - tau[0];
            break;
        }
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
fn unit_wrench(slides: bool, inertia: &Inertia<Lanes>) -> Wrench {
    let h = inertia.h;
    if slides {
        (Vec3::new(zero(), zero(), inertia.m), Vec3::new(h.y, -h.x, zero()))
    } else {
        (Vec3::new(-h.y, h.x, zero()), Vec3::new(inertia.xz, inertia.yz, inertia.zz))
    }
}

/// Solves `M q̈ = τ − bias` in pivot order.
#[inline(always)]
fn eliminate<const N: usize>(System { m, rhs }: &mut System<N>, ddq: &mut [Lanes]) {
    let n = ddq.len();
    for k in 0..n {
        let inverse = Lanes::splat(1.0) / m[k][k];
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
