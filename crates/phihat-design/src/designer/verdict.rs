//! Distance of a candidate from each clause of the specification, and the nearest miss of each.

/// The clauses: their keys in a study, in the order of [`ClauseVerdict::shares`].
pub(super) const KEYS: [&str; 5] = [
    "spec.error_bound_rad",
    "spec.velocity_error_bound_rad_s",
    "spec.error_integral_bound_rad_s",
    "design.torque_step_max_nm",
    "loop.torque_rate_max_nm_s",
];

/// Share of a clause that is used, and the joint that decides.
pub(super) type Share = (f64, usize);

/// For each clause: measured over wanted, and the joint that decides; 0 where the study does not ask.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ClauseVerdict {
    pub(super) shares: [Share; 5],
}

impl ClauseVerdict {
    /// Keeps the larger share; a NaN counts as the largest.
    pub(super) fn raise(&mut self, clause: usize, share: f64, joint: usize) {
        let slot = &mut self.shares[clause];
        if share.is_nan() || share > slot.0 {
            *slot = (share, joint);
        }
    }

    pub(super) fn within(&self) -> bool {
        self.shares.iter().all(|(share, _)| *share <= 1.0)
    }

    /// Returns true if every clause but one is satisfied.
    pub(super) fn within_but(&self, clause: usize) -> bool {
        (0..KEYS.len()).all(|i| i == clause || self.shares[i].0 <= 1.0)
    }
}

/// The nearest miss of each clause while the others stand.
#[derive(Debug, Default)]
pub(super) struct Nearest {
    pub(super) alone: [Option<Share>; 5],
    /// The error that decides when nothing else is asked.
    pub(super) any: Option<Share>,
}

impl Nearest {
    pub(super) fn note(&mut self, verdict: &ClauseVerdict) {
        lower(&mut self.any, verdict.shares[0]);
        for clause in 0..KEYS.len() {
            if verdict.within_but(clause) {
                lower(&mut self.alone[clause], verdict.shares[clause]);
            }
        }
    }
}

fn lower(slot: &mut Option<Share>, found: Share) {
    if slot.is_none_or(|best| found.0 < best.0) {
        *slot = Some(found);
    }
}
