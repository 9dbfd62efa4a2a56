//! The free scalars of a law, and a choice of them.

use serde::Serialize;

use crate::error::RivalRefusal;

/// One free scalar of a law, shared by all joints.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scalar {
    /// Name, `snake_case`.
    pub name: &'static str,
    /// Unit; gains on torque are per unit of a joint's [`Tuning::units`], so that `1/s²` is `N·m/rad` per `kg·m²`.
    pub unit: &'static str,
    /// Meaning, in a few words.
    pub meaning: &'static str,
    /// The published value, or the one that ran first.
    pub default: f64,
    /// Smallest value that a tuner may try; above 0.
    pub low: f64,
    /// Largest value that a tuner may try.
    pub high: f64,
}

/// A choice of a law's free scalars for one arm and one sample period.
///
/// Joints differ by orders of magnitude in inertia. Every rival gets the same help with that: gains on torque
/// are multiplied by `units`, one nominal inertia per joint, in place of one free gain per joint. A law that
/// has the inertia in it says so by its type ([`Inertia`](crate::Inertia)).
#[derive(Debug, Clone, PartialEq)]
pub struct Tuning {
    values: Vec<f64>,
    units: Vec<f64>,
    period: f64,
}

impl Tuning {
    /// Values in the order of the law's scalars, a unit per joint \[kg·m²\], and the sample period \[s\].
    ///
    /// # Errors
    ///
    /// [`Refusal::Tuning`]: a number that is not positive and finite.
    pub fn new(values: &[f64], units: &[f64], period: f64) -> Result<Self, RivalRefusal> {
        let all = values.iter().chain(units).chain([&period]);
        if let Some(bad) = all.into_iter().find(|v| !(v.is_finite() && **v > 0.0)) {
            return Err(RivalRefusal::Tuning(format!(
                "{bad} is no gain: above 0 and finite is valid"
            )));
        }
        Ok(Self { values: values.to_vec(), units: units.to_vec(), period })
    }

    /// The published values.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn published(scalars: &[Scalar], units: &[f64], period: f64) -> Result<Self, RivalRefusal> {
        let values: Vec<_> = scalars.iter().map(|scalar| scalar.default).collect();
        Self::new(&values, units, period)
    }

    /// The scalars, in the law's order.
    ///
    /// # Errors
    ///
    /// [`Refusal::Tuning`] when there are not `N`.
    pub fn values<const N: usize>(&self) -> Result<[f64; N], RivalRefusal> {
        let found = self.values.len();
        self.values
            .as_slice()
            .try_into()
            .map_err(|_| RivalRefusal::Tuning(format!("{found} values for {N} scalars")))
    }

    /// The scalars, however many there are, in the law's order.
    pub fn all(&self) -> &[f64] {
        &self.values
    }

    /// Factor on the torque gains of each joint \[kg·m²\].
    pub fn units(&self) -> &[f64] {
        &self.units
    }

    /// A torque gain for every joint: `gain × units`.
    pub fn per_joint(&self, gain: f64) -> Vec<f64> {
        self.units.iter().map(|unit| gain * unit).collect()
    }

    /// Sample period \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.units.len()
    }
}
