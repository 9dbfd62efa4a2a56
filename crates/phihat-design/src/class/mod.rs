//! Error bound for every motion of a class: joint box, speed, acceleration, jerk.
//!
//! docs/theory/class.md has the theorem; labels (CM1) … (CM9) are its equations. [`class_bound`] is the way in:
//!
//! 1. `scene`: the class, the arm with each payload, friction, encoder, feed-forward, read from a study.
//!    `imperfect`: stiction, cogging, noise, jitter, lost commands.
//! 2. `slopes`: `M`, `∂M` and the gradient of gravity at a posture.
//! 3. `extent`: maxima over box and payloads (torque rates, second derivatives), searched.
//! 4. `sums`: sums over the impulse responses of the loop frozen at a posture; `answers`, `starts`, `rows`: what they
//!    take of each sample, joints that answer side by side.
//! 5. `close`: the least solution of (CM5) over all postures; `effect`, `parts`: its inputs, effect by effect;
//!    `explain`: what would have to be less.
//! 6. `find`: the search for the postures that set the bound, and the document; `faster`: other paces.
//! 7. `demand`: what a search for gains reckons with.

mod answers;
mod close;
mod demand;
mod effect;
mod explain;
mod extent;
mod faster;
mod find;
mod imperfect;
mod joint_sums;
mod moving_sums;
mod parts;
mod refusal;
mod rows;
mod scene;
mod slopes;
mod starts;
mod sums;

pub use demand::{ClassDemand, LeastError};
pub use find::{class_bound, quick_class_bound};
pub use parts::class_parts;
pub use refusal::ClassRefusal;
