//! Table 3 as printed.

/// `(51)` per joint of PD, the comparator and the proposed law, times 1e-4.
pub(super) const PRINTED: [[f64; 3]; 7] = [
    [0.798, 0.537, 0.123],
    [1.910, 14.40, 1.240],
    [4.230, 1.440, 0.269],
    [2.050, 2.550, 0.276],
    [1.220, 0.731, 0.182],
    [2.660, 1.090, 0.548],
    [2.350, 1.260, 0.519],
];
