//! Faults that may be applied to an arm while it runs, each with the sizes that are taken.

use phihat_study::FaultKind;
use serde::Serialize;

use crate::error::StudioError;

/// One kind of fault on offer.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Offer {
    #[serde(skip)]
    pub(crate) kind: FaultKind,
    /// Its word in a study.
    pub(crate) word: &'static str,
    /// Label on the page.
    pub(crate) label: &'static str,
    /// Unit of its size; empty: a ratio.
    pub(crate) unit: &'static str,
    /// The least and the largest size that are taken.
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The size at which nothing happens; `None`: it acts or it does not.
    pub(crate) neutral: Option<f64>,
    /// Step of its slider.
    pub(crate) step: f64,
    /// True if it acts on the joint that is picked.
    pub(crate) per_joint: bool,
}

const fn sized(
    (kind, word, label): (FaultKind, &'static str, &'static str),
    unit: &'static str,
    (low, high, neutral, step): (f64, f64, f64, f64),
    per_joint: bool,
) -> Offer {
    Offer { kind, word, label, unit, low, high, neutral: Some(neutral), step, per_joint }
}

const fn switch(
    (kind, word, label): (FaultKind, &'static str, &'static str),
    per_joint: bool,
) -> Offer {
    Offer { kind, word, label, unit: "", low: 1.0, high: 1.0, neutral: None, step: 1.0, per_joint }
}

/// All faults on offer. Those that hide an arm's state from its controller for good (a reading that is no number,
/// joints in the wrong order) are left to `phihat faults`.
pub(crate) const OFFERS: [Offer; 11] = [
    sized((FaultKind::Push, "push", "push"), "N·m", (-200.0, 200.0, 0.0, 0.1), true),
    sized(
        (FaultKind::Payload, "payload", "payload at the tip"),
        "kg",
        (0.0, 20.0, 0.0, 0.1),
        false,
    ),
    sized(
        (FaultKind::Friction, "friction", "all friction, times"),
        "",
        (0.0, 10.0, 1.0, 0.1),
        false,
    ),
    sized((FaultKind::Brake, "brake", "dragging brake"), "N·m", (0.0, 20.0, 0.0, 0.1), true),
    sized(
        (FaultKind::DriveGain, "drive_gain", "drive gives, times"),
        "",
        (-1.0, 2.0, 1.0, 0.05),
        true,
    ),
    sized(
        (FaultKind::SensorBias, "sensor_bias", "position is off by"),
        "rad",
        (-0.1, 0.1, 0.0, 0.001),
        true,
    ),
    sized(
        (FaultKind::SensorNoise, "sensor_noise", "noise of positions"),
        "rad",
        (0.0, 0.01, 0.0, 0.000_01),
        false,
    ),
    sized(
        (FaultKind::SampleLoss, "sample_loss", "measurements lost"),
        "of all",
        (0.0, 1.0, 0.0, 0.01),
        false,
    ),
    sized(
        (FaultKind::CommandLoss, "command_loss", "commands lost"),
        "of all",
        (0.0, 1.0, 0.0, 0.01),
        false,
    ),
    switch((FaultKind::SensorFreeze, "sensor_freeze", "sensor keeps its last value"), true),
    switch((FaultKind::ControllerStop, "controller_stop", "controller does not run"), false),
];

/// The offer of that name.
pub(crate) fn offered(word: &str) -> Option<&'static Offer> {
    OFFERS.iter().find(|offer| offer.word == word)
}

impl Offer {
    /// The size that is taken of what was asked; `None`: nothing acts. Wrong sizes are an error.
    pub(crate) fn size(&self, asked: Option<f64>) -> Result<Option<f64>, StudioError> {
        let Some(size) = asked else { return Ok(None) };
        if !(self.low..=self.high).contains(&size) {
            let (word, low, high, unit) = (self.word, self.low, self.high, self.unit);
            return Err(StudioError::refused(format!("{word}: {low} to {high} {unit} is taken")));
        }
        let nothing = self.neutral.is_some_and(|neutral| (size - neutral).abs() < 1e-12);
        Ok((!nothing).then_some(size))
    }
}

#[cfg(test)]
mod tests {
    use super::{OFFERS, offered};

    #[test]
    fn words_are_those_of_a_study_and_no_size_is_taken_that_is_no_number() {
        for offer in &OFFERS {
            assert_eq!(offer.word, offer.kind.word());
            for not in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
                assert!(offer.size(Some(not)).is_err(), "{}: {not}", offer.word);
            }
            assert_eq!(offer.size(None).unwrap(), None);
        }
        assert_eq!(offered("push").unwrap().size(Some(0.0)).unwrap(), None);
        assert!(offered("sensor_nan").is_none());
    }
}
