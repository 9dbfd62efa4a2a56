//! The rivals, one file each.

use crate::rival::Entry;

mod computed_torque;
mod h_infinity_pid;
mod pd;
mod proposed;

/// Every rival, in the order of the table. One line each.
pub const RIVALS: &[Entry] = &[
    Entry::of::<pd::Pd>(),
    Entry::of::<computed_torque::ComputedTorque>(),
    Entry::of::<h_infinity_pid::HInfinityPid>(),
    Entry::of::<proposed::First>(),
    Entry::of::<proposed::Second>(),
];

/// The rival of an id.
pub fn rival(id: &str) -> Option<&'static Entry> {
    RIVALS.iter().find(|entry| entry.card.id == id)
}
