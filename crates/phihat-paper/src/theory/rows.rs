//! (44): what a criterion row by row is worth as a bound.

use phihat_design::claims::{ErrorLimits, MinimalGains, PeakGains};
use phihat_design::prelude::*;

use crate::compose::{number, three};
use crate::gains::PHI_MAX;
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// The largest error that the worst φ makes, as a share of its limit, with the least gains of (44).
fn share_of_limit(x_max: &[f64]) -> Result<(MinimalGains, f64), PartError> {
    let limits = ErrorLimits { phi_max: PHI_MAX, x_max: x_max.to_vec() };
    let least = MinimalGains::first_order(&limits)?;
    let peaks = PeakGains::of(&least.law(), 1.0)?;
    let shares = peaks.states.iter().zip(x_max).map(|(gain, x)| gain.upper * PHI_MAX / x);
    Ok((least, shares.fold(0.0, f64::max)))
}

/// Rows of (44) hold, and a limit is broken all the same.
pub(super) fn componentwise() -> Result<Statement, PartError> {
    let (least, own) = share_of_limit(&[1e-3, 1e-2, 1e-1])?;
    let (_, other) = share_of_limit(&[1e-4, 1e-2, 1e-2])?;
    Ok(Published {
        id: "theorem5-componentwise",
        place: "(44)",
        claim: "Gains that satisfy (44) row by row keep the errors within the limits",
        paper: "errors ≤ x_max",
    }
    .found(
        format!(
            "limits (48): K̃ = {}, K_p = {}, K_d = {}, worst error {:.1} % of its limit; limits (1e-4, 1e-2, 1e-2): \
                {:.1} %",
            three(least.k_tilde.into()),
            three(least.kp.into()),
            three(least.kd.into()),
            100.0 * own,
            100.0 * other
        ),
        Verdict::of(own <= 1.0 && other <= 1.0, false),
        "Row by row, ½Q_ii x_i > (SB)_i φ_max says that V̇ < 0 where every error is at its limit at once. V̇ can be \
         positive while all but one are small, so the rows bound nothing: at the paper's own limits they happen to \
         do, at others they do not. Peak-to-peak gains are the bound.",
        vec![
            number("worst error as a share of its limit, (48)", "", own, 1e-4),
            number("the same, limits (1e-4, 1e-2, 1e-2)", "", other, 1e-4),
        ],
    )
    .assuming(&["phi-max"]))
}
