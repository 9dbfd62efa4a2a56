//! Details that one statement gives of itself.

/// `[id, covers, reading, varied, turns]`; items as `(40) F7 T2 R9 L1 Th5`, several in a row as `(1)-(4)`.
pub(super) type Detail = [&'static str; 5];
