//! A certificate whose range of inertia is proved over all postures.

use serde::Serialize;

use crate::RangeProof;

/// Proof of a certificate's range of inertia, against the window in which its loops are stable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifiedRange {
    /// The proof.
    pub proof: RangeProof,
    /// Ends of the range over which the certificate shows stability: the stated range with its margin.
    pub window: (f64, f64),
    /// True if the proved range is inside of the window: stability at every posture then rests on no search.
    pub inside_window: bool,
}

impl VerifiedRange {
    /// The result in words, a line each.
    pub fn lines(&self) -> [String; 2] {
        let Self { proof: RangeProof { low, high, cells, .. }, window, inside_window } = self;
        let all = "at every posture inside the joints' travel, with every payload of the study";
        let (a, b) = window;
        let end = if *inside_window {
            "inside of it: stability at every posture rests on no search, A11 is proved"
        } else {
            "NOT PROVED to be inside of it: A11 stays an assumption; more seconds prove a tighter range"
        };
        let high = if high.is_finite() { format!("{high:.5}") } else { "∞".to_owned() };
        [
            format!("PROVED, μ in {low:.5} … {high} {all}; {cells} cells"),
            format!("the loops are stable for μ in {a:.5} … {b:.5}: {end}"),
        ]
    }
}
