//! The marks of the paper's Table 1.

use phihat_rivals::Tick;
use serde::{Deserialize, Serialize};

/// A tick, printed or measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// ✓
    Yes,
    /// ✗
    No,
    /// –
    Partly,
}

impl From<Tick> for Mark {
    fn from(tick: Tick) -> Self {
        match tick {
            Tick::Yes => Self::Yes,
            Tick::No => Self::No,
            Tick::Partly => Self::Partly,
        }
    }
}
