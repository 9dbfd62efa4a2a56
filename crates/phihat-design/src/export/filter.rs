//! The filter on a joint's innovation.

use crate::{FilterSection, JointRecord};

/// Its sections; empty: there is none.
pub(super) fn filter(joint: &JointRecord) -> &[FilterSection] {
    joint.observer.as_ref().map_or(&[], |own| &own.innovation_filter)
}
