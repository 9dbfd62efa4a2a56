//! Claims about the loop as it is sampled: inertia window, margins, torque noise.
