//! One assumption of a certificate, held against a record.

use serde::Serialize;

/// Assumption of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Assumption {
    /// The bound on the error.
    ErrorBound,
    /// Size of φ.
    PhiSize,
    /// Rate and jump of φ.
    PhiChange,
    /// Inertia of a joint, by its rotor.
    Inertia,
    /// Transport delay of the torque.
    Delay,
    /// Equal times between samples.
    Jitter,
    /// No message is lost.
    Losses,
    /// Quantum of the encoder.
    Encoder,
    /// Noise on the position.
    Noise,
    /// Level of dry friction.
    Friction,
    /// Mass that the arm carries.
    Payload,
    /// The torque that acts is the one commanded.
    TorqueEcho,
    /// No limit acts.
    Limits,
    /// The motion, or its class.
    Reference,
}

impl Assumption {
    /// Its words.
    pub fn words(self) -> &'static str {
        match self {
            Self::ErrorBound => "bound on the error",
            Self::PhiSize => "φ, size",
            Self::PhiChange => "φ, rate and jump",
            Self::Inertia => "rotor inertia",
            Self::Delay => "delay",
            Self::Jitter => "jitter",
            Self::Losses => "lost samples",
            Self::Encoder => "encoder quantum",
            Self::Noise => "encoder noise",
            Self::Friction => "dry friction",
            Self::Payload => "payload",
            Self::TorqueEcho => "torque that acts",
            Self::Limits => "limits",
            Self::Reference => "reference",
        }
    }
}

/// Result of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// The record is as assumed.
    Held,
    /// The record contradicts it.
    Broken,
    /// The record does not say.
    NotTold,
}

/// One assumption about one joint, or about the arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AuditRow {
    /// The assumption.
    pub assumption: Assumption,
    /// Joint name; `None`: the arm.
    pub joint: Option<String>,
    /// Result.
    pub standing: Standing,
    /// Figure in the record, from and to; equal ends: one figure. `None`: there is none.
    pub recorded: Option<(f64, f64)>,
    /// Figure assumed, from and to.
    pub assumed: Option<(f64, f64)>,
    /// Unit of both.
    pub unit: &'static str,
    /// Time at which it broke, where it is of one sample \[s\].
    pub time_s: Option<f64>,
    /// Reason why the record does not say.
    pub why: Option<&'static str>,
    /// Lines of a study for which the record conforms.
    pub change: Option<String>,
}

impl AuditRow {
    /// A row about the arm that the record says nothing about.
    pub(super) fn not_told(assumption: Assumption, why: &'static str) -> Self {
        let (standing, why) = (Standing::NotTold, Some(why));
        let (joint, recorded, assumed, time_s, change) = (None, None, None, None, None);
        Self { assumption, joint, standing, recorded, assumed, unit: "", time_s, why, change }
    }

    /// A row with a figure that has to be at most the assumed one; `time` of the first sample beyond it.
    pub(super) fn at_most(
        assumption: Assumption,
        (recorded, assumed, unit): (f64, f64, &'static str),
        time_s: Option<f64>,
    ) -> Self {
        let standing = if time_s.is_some() { Standing::Broken } else { Standing::Held };
        Self {
            standing,
            recorded: Some((recorded, recorded)),
            assumed: Some((assumed, assumed)),
            unit,
            time_s,
            why: None,
            ..Self::not_told(assumption, "")
        }
    }

    /// A row with an interval by the record, which has a value in common with the assumed one, or not; `within` it, or
    /// so near to it, it is held.
    pub(super) fn of_interval(
        assumption: Assumption,
        (recorded, assumed, unit): ((f64, f64), (f64, f64), &'static str),
        near: f64,
    ) -> Self {
        let disjoint = recorded.1 < assumed.0 || recorded.0 > assumed.1;
        let within = recorded.0 >= assumed.0 - near && recorded.1 <= assumed.1 + near;
        let (standing, why) = match (disjoint, within) {
            (true, _) => (Standing::Broken, None),
            (false, true) => (Standing::Held, None),
            (false, false) => {
                (Standing::NotTold, Some("the record's interval is wider than the assumed one"))
            }
        };
        let row = Self::not_told(assumption, "");
        Self { standing, recorded: Some(recorded), assumed: Some(assumed), unit, why, ..row }
    }

    /// The same row about a joint.
    pub(super) fn on(self, joint: &str) -> Self {
        Self { joint: Some(joint.to_owned()), ..self }
    }

    /// The same row with the lines of a study that make the record conform, where it is broken.
    pub(super) fn with_change(self, change: impl FnOnce() -> String) -> Self {
        let change = (self.standing == Standing::Broken).then(change);
        Self { change, ..self }
    }
}

/// Largest size of values and the time of the first beyond a limit \[s\].
pub(super) fn largest_beyond(
    values: impl Iterator<Item = (f64, f64)>,
    limit: f64,
) -> (f64, Option<f64>) {
    let (mut most, mut time) = (0.0_f64, None);
    for (t, value) in values {
        let size = value.abs();
        if size > limit && time.is_none() {
            time = Some(t);
        }
        if size > most {
            most = size;
        }
    }
    (most, time)
}
