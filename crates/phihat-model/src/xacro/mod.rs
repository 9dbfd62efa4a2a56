//! xacro: descriptions with properties, macros, conditions and includes, expanded to URDF.
//!
//! # Method
//!
//! As the xacro of ROS 2 does it: elements in the order of the file; `${…}` is an expression of a part of Python,
//! `$(…)` an argument, a package's folder or a variable of the environment; a property is evaluated when it is used,
//! in the scope that it stands in; a macro has a scope of its own within that of its call.
//!
//! # Not read
//!
//! Lambda, comprehensions, slices, named arguments of functions other than `dict`, and formats of Python; patterns in
//! the name of an include; `xacro:include ns`. Each is refused by name.
//!
//! # Bounds
//!
//! Files, depth, steps, texts and elements are bounded, so that no file costs more than some seconds.
//!
//! # References
//!
//! <https://github.com/ros/xacro/wiki>

mod evaluate;
mod expand;
mod expression;
mod functions;
mod packages;
mod reason;
mod scope;
mod text;
mod value;
mod yaml;

pub use expand::{Expanded, XacroOptions, expand, is_xacro};
