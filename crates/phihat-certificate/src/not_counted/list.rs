//! The list of what is left out, and how an entry comes on it.

use serde::{Deserialize, Serialize};

/// Something in a study that the claims leave out. The law's linear loop is as certified all the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotCounted {
    /// Key in the study.
    pub key: String,
    /// Value of the key in the study.
    pub value: String,
    /// Claims that do not count it.
    pub claims: LeftOut,
}

/// Claims that leave something out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeftOut {
    /// Bounds on the error, and the tube; the loop stays the one whose stability is claimed.
    Bounds,
    /// Bounds, tube and stability: while it acts, the loop is another one.
    BoundsAndStability,
    /// Bounds from φ and the claims about the loop; the tube of the run counts it.
    AllButTube,
    /// The tube and the coupled gains, which are for the simulated value; range, stability and bounds from φ
    /// hold for all values.
    TubeBesideValue,
    /// An assumption of every claim: what the value says.
    Assumed,
    /// Every claim but that of elastic joints: bounds and tube are those of rigid joints.
    AllButElastic,
}

pub(super) struct List(pub(super) Vec<NotCounted>);

impl List {
    #[allow(clippy::needless_pass_by_value, reason = "numbers and words alike")]
    pub(super) fn add(&mut self, key: &str, value: impl ToString, claims: LeftOut) {
        self.0.push(NotCounted { key: key.to_owned(), value: value.to_string(), claims });
    }

    /// A list in which a value differs from the one that is counted; one number where all are the same.
    pub(super) fn values(&mut self, key: &str, values: &[f64], counted: f64) {
        if values.iter().any(|value| value.is_nan() || (value - counted).abs() > 0.0) {
            self.add(key, text(values), LeftOut::Bounds);
        }
    }

    /// Values that change the loop while they act.
    pub(super) fn acting(&mut self, key: &str, values: Option<&Vec<f64>>) {
        if let Some(values) = values {
            self.add(key, text(values), LeftOut::BoundsAndStability);
        }
    }
}

/// One number where all are the same.
pub(super) fn text(values: &[f64]) -> String {
    let same = values.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
    match values.first() {
        Some(value) if same => format!("{value}"),
        _ => format!("{values:?}"),
    }
}
