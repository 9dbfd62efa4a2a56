//! MJCF, the format of MuJoCo: bodies, joints, inertia and drives of what makes an arm.
//!
//! # Method
//!
//! As MuJoCo's compiler does it: files that are included are put in place of their `<include>`; a value
//! that an element does not state is that of its class, or of the class before that. A body is a link; each
//! of its joints moves a link of its own, which is the body where the joint's anchor is the body's origin.
//! A site is a link that is welded on. Mass and inertia are those of `<inertial>`, or of the geoms where
//! `inertiafromgeom` has it so. The largest torque of a joint is what its actuators and `actuatorfrcrange`
//! permit; an actuator's `armature` and `damping` are added to the joint's.
//!
//! # Not read
//!
//! Attached and replicated parts, composites, flexible bodies and plugins are refused; meshes, height
//! fields and shells are refused where a body's inertia would be theirs. Springs of joints, tendons,
//! contacts, `gravcomp` and constraints other than a joint that follows another one are left out, with a
//! warning each where they act on an arm.
//!
//! # Bounds
//!
//! Files, bytes, elements, classes and depth are bounded, so that no file costs more than some seconds.
//!
//! # References
//!
//! MuJoCo 4.0, XML reference, <https://mujoco.readthedocs.io/en/stable/XMLreference.html>

mod actuators;
mod attributes;
mod bodies;
mod classes;
mod compiler;
mod equality;
mod geom;
mod include;
mod inertia;
mod joint;
mod orientation;
mod read;

pub(crate) use include::{ROOT, flat};
pub(crate) use read::described;
