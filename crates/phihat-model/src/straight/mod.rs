//! Forward dynamics written out for chains of few joints: no loop, no product with 0 or 1, nothing that no
//! result needs.
//!
//! # Method
//!
//! The recursions of [`lockstep`](crate::Lockstep) run once on a number type that records its operations
//! (`written`), for a structure and any numbers; the operations that remain after folding are a file of this
//! folder. The same operations in the same order give the same bits; a zero may have the other sign, and
//! where there is an infinity or NaN, another one may come out.
#![allow(clippy::too_many_lines, reason = "written by a program, held to the recursions by a test")]

#[rustfmt::skip]
mod chain_of_6;
#[rustfmt::skip]
mod chain_of_7;
#[rustfmt::skip]
mod panda;
#[rustfmt::skip]
mod planar3r;
#[rustfmt::skip]
mod ur5;

use crate::inertia::LinkInertia;
use crate::lockstep::part::LockstepSegment;
use crate::segment::Segment;
use crate::shape::{SegmentShape, Tilt};
use crate::trig;
use crate::vector::Vec3;
use crate::{Lanes, Model, Scalar};

/// The numbers of an arm and its state, by segment.
pub(crate) trait ArmNumbers<S> {
    fn sine(&self, i: usize) -> S;
    fn cosine(&self, i: usize) -> S;
    fn dq(&self, i: usize) -> S;
    fn tau(&self, i: usize) -> S;
    fn a(&self, i: usize) -> S;
    fn d(&self, i: usize) -> S;
    fn cos_alpha(&self, i: usize) -> S;
    fn sin_alpha(&self, i: usize) -> S;
    fn armature(&self, i: usize) -> S;
    fn m(&self, i: usize) -> S;
    fn h(&self, i: usize, k: usize) -> S;
    fn inertia(&self, i: usize, k: usize) -> S;
    fn sigma(&self, i: usize, k: usize) -> S;
    /// Acceleration of the base that acts like gravity.
    fn lift(&self, k: usize) -> S;
}

/// Forward dynamics of chains of `N` joints, written out.
trait Code<const N: usize> {
    /// Structures that a chain may have, joint by joint.
    const SHAPES: [SegmentShape; N];

    /// Accelerations.
    fn forward<S: Scalar>(arm: &impl ArmNumbers<S>) -> [S; N];
}

/// The numbers of one arm.
struct Alone<'a, const N: usize> {
    segments: &'a [Segment; N],
    armature: &'a [f64; N],
    lift: [f64; 3],
    sines: [f64; N],
    cosines: [f64; N],
    dq: &'a [f64; N],
    tau: &'a [f64; N],
}

/// The numbers of many arms, one per lane.
struct ArmLanes<'a, const N: usize> {
    parts: &'a [LockstepSegment<Lanes>; N],
    lift: &'a Vec3<Lanes>,
    sines: [Lanes; N],
    cosines: [Lanes; N],
    dq: &'a [Lanes; N],
    tau: &'a [Lanes; N],
}

impl<const N: usize> ArmNumbers<f64> for Alone<'_, N> {
    #[inline(always)]
    fn sine(&self, i: usize) -> f64 {
        self.sines[i]
    }
    #[inline(always)]
    fn cosine(&self, i: usize) -> f64 {
        self.cosines[i]
    }
    #[inline(always)]
    fn dq(&self, i: usize) -> f64 {
        self.dq[i]
    }
    #[inline(always)]
    fn tau(&self, i: usize) -> f64 {
        self.tau[i]
    }
    #[inline(always)]
    fn a(&self, i: usize) -> f64 {
        self.segments[i].a
    }
    #[inline(always)]
    fn d(&self, i: usize) -> f64 {
        self.segments[i].d
    }
    #[inline(always)]
    fn cos_alpha(&self, i: usize) -> f64 {
        self.segments[i].cos_alpha
    }
    #[inline(always)]
    fn sin_alpha(&self, i: usize) -> f64 {
        self.segments[i].sin_alpha
    }
    #[inline(always)]
    fn armature(&self, i: usize) -> f64 {
        self.armature[i]
    }
    #[inline(always)]
    fn m(&self, i: usize) -> f64 {
        self.segments[i].m
    }
    #[inline(always)]
    fn h(&self, i: usize, k: usize) -> f64 {
        self.segments[i].h[k]
    }
    #[inline(always)]
    fn inertia(&self, i: usize, k: usize) -> f64 {
        self.segments[i].i[k]
    }
    #[inline(always)]
    fn sigma(&self, i: usize, k: usize) -> f64 {
        self.segments[i].sigma[k]
    }
    #[inline(always)]
    fn lift(&self, k: usize) -> f64 {
        self.lift[k]
    }
}

impl<const N: usize> ArmNumbers<Lanes> for ArmLanes<'_, N> {
    #[inline(always)]
    fn sine(&self, i: usize) -> Lanes {
        self.sines[i]
    }
    #[inline(always)]
    fn cosine(&self, i: usize) -> Lanes {
        self.cosines[i]
    }
    #[inline(always)]
    fn dq(&self, i: usize) -> Lanes {
        self.dq[i]
    }
    #[inline(always)]
    fn tau(&self, i: usize) -> Lanes {
        self.tau[i]
    }
    #[inline(always)]
    fn a(&self, i: usize) -> Lanes {
        self.parts[i].a
    }
    #[inline(always)]
    fn d(&self, i: usize) -> Lanes {
        self.parts[i].d
    }
    #[inline(always)]
    fn cos_alpha(&self, i: usize) -> Lanes {
        self.parts[i].turn.c
    }
    #[inline(always)]
    fn sin_alpha(&self, i: usize) -> Lanes {
        self.parts[i].turn.s
    }
    #[inline(always)]
    fn armature(&self, i: usize) -> Lanes {
        self.parts[i].armature
    }
    #[inline(always)]
    fn m(&self, i: usize) -> Lanes {
        self.parts[i].matter.m
    }
    #[inline(always)]
    fn h(&self, i: usize, k: usize) -> Lanes {
        let h = &self.parts[i].matter.h;
        match k {
            0 => h.x,
            1 => h.y,
            _ => h.z,
        }
    }
    #[inline(always)]
    fn inertia(&self, i: usize, k: usize) -> Lanes {
        let LinkInertia { xx, yy, zz, xy, xz, yz, .. } = self.parts[i].matter;
        match k {
            0 => xx,
            1 => yy,
            2 => zz,
            3 => xy,
            4 => xz,
            _ => yz,
        }
    }
    #[inline(always)]
    fn sigma(&self, i: usize, k: usize) -> Lanes {
        self.parts[i].sigma[k]
    }
    #[inline(always)]
    fn lift(&self, k: usize) -> Lanes {
        match k {
            0 => self.lift.x,
            1 => self.lift.y,
            _ => self.lift.z,
        }
    }
}

macro_rules! kernels {
    ($($(#[$what:meta])* $kernel:ident: $file:ident, $joints:literal;)*) => {
        /// Structure whose code is written out.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Kernel {
            $($(#[$what])* $kernel,)*
        }

        impl Kernel {
            /// The code for a chain of revolute joints of these shapes, if there is any.
            pub(crate) fn of(shapes: &[SegmentShape]) -> Option<Self> {
                $(if serves(&<$file::Chain as Code<$joints>>::SHAPES, shapes) { return Some(Self::$kernel); })*
                None
            }

            /// Accelerations of one arm; whether the arm is one of these.
            #[inline]
            pub(crate) fn alone(self, model: &Model, state: [&[f64]; 3], ddq: &mut [f64]) -> bool {
                let done = match self {
                    $(Self::$kernel => alone::<$joints, $file::Chain>(model, state, ddq),)*
                };
                done.is_some()
            }

            /// Accelerations of many arms; whether they are such.
            #[inline]
            pub(crate) fn beside(
                self,
                arms: (&[LockstepSegment<Lanes>], Vec3<Lanes>),
                state: [&[Lanes]; 3],
                ddq: &mut [Lanes],
            ) -> bool {
                let done = match self {
                    $(Self::$kernel => beside::<$joints, $file::Chain>(arms, state, ddq),)*
                };
                done.is_some()
            }
        }
    };
}

// The first that serves is taken: what is written for fewer arms stands before what is for more.
kernels! {
    Panda: panda, 7;
    Ur5: ur5, 6;
    Planar3r: planar3r, 3;
    /// Any chain of six revolute joints.
    ChainOf6: chain_of_6, 6;
    /// Any chain of seven.
    ChainOf7: chain_of_7, 7;
}

/// Returns true if the code for one structure serves an arm of the other: the arm has no part that the code
/// leaves out.
fn serves(code: &[SegmentShape], arm: &[SegmentShape]) -> bool {
    let part = |(i, (code, arm)): (usize, (&SegmentShape, &SegmentShape))| {
        let tilt = code.tilt == Tilt::Any || code.tilt == arm.tilt;
        // The first screw of the first segment is the base's, and turning about an axis is the same all along it.
        tilt && (i == 0 || (code.reaches || !arm.reaches) && (code.slides || !arm.slides))
    };
    code.len() == arm.len() && code.iter().zip(arm).enumerate().all(part)
}

/// One arm, by the code of its structure; `None`: it has other joints.
#[inline(never)]
fn alone<const N: usize, C: Code<N>>(
    model: &Model,
    [q, dq, tau]: [&[f64]; 3],
    ddq: &mut [f64],
) -> Option<()> {
    let (sines, cosines) = sines(model, q)?;
    let arm = Alone::<'_, N> {
        segments: model.segments().try_into().ok()?,
        armature: model.armature().try_into().ok()?,
        lift: model.lift(),
        sines,
        cosines,
        dq: dq.try_into().ok()?,
        tau: tau.try_into().ok()?,
    };
    let ddq: &mut [f64; N] = ddq.try_into().ok()?;
    *ddq = C::forward(&arm);
    Some(())
}

/// Many arms, by the code of their structure; `None`: they have other joints.
#[inline(never)]
fn beside<const N: usize, C: Code<N>>(
    (parts, lift): (&[LockstepSegment<Lanes>], Vec3<Lanes>),
    [q, dq, tau]: [&[Lanes]; 3],
    ddq: &mut [Lanes],
) -> Option<()> {
    let parts: &[LockstepSegment<Lanes>; N] = parts.try_into().ok()?;
    let (sines, cosines) = sines_beside(parts, q.try_into().ok()?);
    let (dq, tau) = (dq.try_into().ok()?, tau.try_into().ok()?);
    let ddq: &mut [Lanes; N] = ddq.try_into().ok()?;
    *ddq = C::forward(&ArmLanes { parts, lift: &lift, sines, cosines, dq, tau });
    Some(())
}

/// Sines and cosines of the angles of many arms.
#[inline(always)]
fn sines_beside<const N: usize>(
    parts: &[LockstepSegment<Lanes>; N],
    q: &[Lanes; N],
) -> ([Lanes; N], [Lanes; N]) {
    let (mut sines, mut cosines) = ([Lanes::default(); N], [Lanes::default(); N]);
    for i in 0..N {
        (sines[i], cosines[i]) = (q[i] + parts[i].theta).sin_cos();
    }
    (sines, cosines)
}

/// Sines and cosines of one arm's angles.
#[inline(always)]
fn sines<const N: usize>(model: &Model, q: &[f64]) -> Option<([f64; N], [f64; N])> {
    // Whole vectors.
    const MOST: usize = 8;
    let (mut angles, mut sines, mut cosines) = ([0.0; MOST], [0.0; MOST], [0.0; MOST]);
    let q: &[f64; N] = q.try_into().ok()?;
    let theta: &[f64; N] = model.compiled().theta.first_chunk()?;
    for ((angle, q), theta) in angles.iter_mut().zip(q).zip(theta) {
        *angle = q + theta;
    }
    trig::sin_cos_each(&angles, &mut sines, &mut cosines);
    Some((*sines.first_chunk()?, *cosines.first_chunk()?))
}
