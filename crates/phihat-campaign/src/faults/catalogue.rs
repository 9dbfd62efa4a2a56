//! Faults of the matrix: one row per fault, with three severities and the required outcome of each.

use serde::{Deserialize, Serialize};

/// One fault of the matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CatalogueFault {
    /// Its name in runs and reports.
    pub name: &'static str,
    /// The failure mode it stands for (docs/reliability.md).
    pub row: &'static str,
    /// Description for reports; the value of the severity is appended.
    pub what: &'static str,
    /// Change of the study by a severity.
    pub(crate) effect: Effect,
    /// The three severities, mild to severe, in `unit`.
    pub levels: [f64; 3],
    /// The unit of the levels, for people.
    pub unit: &'static str,
    /// Required outcome of each severity.
    pub bars: [Bar; 3],
}

/// Required outcome of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bar {
    /// Required end of the run.
    pub end: RequiredEnd,
    /// Largest excursion \[rad\]: the error while the arm follows, and how far outside of the planned path it
    /// comes while it stops. `None`: listed, not judged.
    pub excursion_rad: Option<f64>,
    /// Latest time from the onset to the stop's reason \[ms\].
    pub noticed_ms: Option<f64>,
}

/// Required end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RequiredEnd {
    /// On the reference, without a stop.
    Following,
    /// In a safe stop.
    Stopped,
    /// In either way.
    Either,
}

/// Kind of change that a severity makes to a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Effect {
    /// An entry `[[fault]]`.
    Entry { kind: &'static str, size: Size, lasts: Lasts, on: AffectedPart },
    /// Other values of keys, for the whole run.
    Keys(&'static [(&'static [&'static str], Size)]),
    /// A stop is requested at the onset, and a restart after the level, in seconds.
    StopAndRestart,
    /// The arm starts away from its reference: every joint by the level, with a sign drawn for the run.
    StartBeside,
}

/// The size of a fault or the value of a key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Size {
    /// The kind has none.
    None,
    /// Always this.
    Fixed(f64),
    /// The level, as it is.
    Level,
    /// The level, as a whole number.
    Whole,
    /// The level, with a sign drawn for the run.
    Signed,
    /// The level times the joint's torque limit, with a sign drawn for the run.
    TorqueSigned,
    /// The level times the joint's torque limit.
    Torque,
    /// The level times the heaviest payload of the design.
    Payload,
    /// The level times the sample period.
    Periods,
    /// True.
    True,
}

/// Duration of a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Lasts {
    /// So many seconds, at least one sample.
    Seconds(f64),
    /// The level, in seconds, at least one sample.
    Level,
    /// To the end of the run.
    Rest,
    /// From the start of the run to the onset, which is when it ends.
    Before,
}

/// Part of the arm that a fault affects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AffectedPart {
    /// The whole arm.
    Arm,
    /// One joint, drawn for the run.
    Joint,
}

const fn follows(excursion_rad: f64) -> Bar {
    Bar { end: RequiredEnd::Following, excursion_rad: Some(excursion_rad), noticed_ms: None }
}

const fn stops(noticed_ms: f64, excursion_rad: f64) -> Bar {
    Bar {
        end: RequiredEnd::Stopped,
        excursion_rad: Some(excursion_rad),
        noticed_ms: Some(noticed_ms),
    }
}

const fn either(excursion_rad: f64) -> Bar {
    Bar { end: RequiredEnd::Either, excursion_rad: Some(excursion_rad), noticed_ms: None }
}

/// Whatever the fault makes of the arm is listed.
const LISTED: Bar = Bar { end: RequiredEnd::Either, excursion_rad: None, noticed_ms: None };

const fn entry(kind: &'static str, size: Size, lasts: Lasts, on: AffectedPart) -> Effect {
    Effect::Entry { kind, size, lasts, on }
}

const fn keys(keys: &'static [(&'static [&'static str], Size)]) -> Effect {
    Effect::Keys(keys)
}

/// All faults of the matrix.
pub const FAULTS: &[CatalogueFault] = &[
    CatalogueFault {
        name: "nothing",
        row: "F5",
        what: "nothing goes wrong; encoder of so many bits",
        effect: keys(&[(&["sensor", "encoder_bits"], Size::Whole)]),
        levels: [24.0, 22.0, 20.0],
        unit: "bit",
        bars: [follows(0.004); 3],
    },
    CatalogueFault {
        name: "torque_limit",
        row: "F1",
        what: "a joint's drive gives no more than this share of its torque for 0.2 s",
        effect: entry("drive_limit", Size::Torque, Lasts::Seconds(0.2), AffectedPart::Joint),
        levels: [0.5, 0.2, 0.1],
        unit: "τ_max",
        bars: [either(0.1), either(0.3), either(0.5)],
    },
    CatalogueFault {
        name: "rate_limit",
        row: "F2",
        what: "the controller may change the torque no faster than this",
        effect: keys(&[(&["loop", "torque_rate_max_nm_s"], Size::Level)]),
        levels: [800.0, 500.0, 300.0],
        unit: "N·m/s",
        bars: [follows(0.01), either(0.01), either(0.02)],
    },
    CatalogueFault {
        name: "coarse_encoder",
        row: "F3",
        what: "the encoder has so many bits",
        effect: keys(&[(&["sensor", "encoder_bits"], Size::Whole)]),
        levels: [19.0, 18.0, 16.0],
        unit: "bit",
        bars: [follows(0.006), follows(0.01), LISTED],
    },
    CatalogueFault {
        name: "position_noise",
        row: "F3",
        what: "white noise of this standard deviation on a position, for the rest of the run",
        effect: entry("sensor_noise", Size::Level, Lasts::Rest, AffectedPart::Joint),
        levels: [1e-6, 1e-5, 1e-4],
        unit: "rad",
        bars: [follows(0.006), follows(0.006), either(0.02)],
    },
    CatalogueFault {
        name: "torque_noise",
        row: "F3",
        what: "white noise of this standard deviation on the torque that the law is fed",
        effect: keys(&[(&["sensor", "torque_noise_nm"], Size::Level)]),
        levels: [0.05, 0.2, 0.5],
        unit: "N·m",
        bars: [follows(0.006), either(0.02), either(0.06)],
    },
    CatalogueFault {
        name: "jitter",
        row: "F4",
        what: "samples are taken early by a random time up to this",
        effect: keys(&[(&["sensor", "sample_jitter_s"], Size::Periods)]),
        levels: [0.1, 0.5, 0.9],
        unit: "periods",
        bars: [follows(0.006), either(0.02), either(0.05)],
    },
    CatalogueFault {
        name: "controller_stop",
        row: "F4",
        what: "the controller does not run for",
        effect: entry("controller_stop", Size::None, Lasts::Level, AffectedPart::Arm),
        levels: [0.003, 0.01, 0.1],
        unit: "s",
        bars: [follows(0.01), either(0.02), either(0.1)],
    },
    CatalogueFault {
        name: "commands_down",
        row: "F4",
        what: "no command gets through for",
        effect: entry("command_loss", Size::Fixed(1.0), Lasts::Level, AffectedPart::Arm),
        levels: [0.003, 0.01, 0.1],
        unit: "s",
        bars: [follows(0.01), either(0.02), either(0.1)],
    },
    CatalogueFault {
        name: "freeze",
        row: "F5",
        what: "all positions and velocities freeze for",
        effect: entry("sensor_freeze", Size::None, Lasts::Level, AffectedPart::Arm),
        levels: [0.005, 0.02, 0.2],
        unit: "s",
        bars: [either(0.03), either(0.03), stops(30.0, 0.2)],
    },
    CatalogueFault {
        name: "freeze_joint",
        row: "F5",
        what: "one joint's position and velocity freeze for",
        effect: entry("sensor_freeze", Size::None, Lasts::Level, AffectedPart::Joint),
        levels: [0.005, 0.02, 0.2],
        unit: "s",
        bars: [either(0.03), either(0.03), either(0.2)],
    },
    CatalogueFault {
        name: "not_a_number",
        row: "F6",
        what: "all positions and velocities are not a number for",
        effect: entry("sensor_nan", Size::None, Lasts::Level, AffectedPart::Arm),
        levels: [0.0, 0.005, 0.05],
        unit: "s",
        bars: [follows(0.006), either(0.01), stops(30.0, 0.05)],
    },
    CatalogueFault {
        name: "not_a_number_joint",
        row: "F6",
        what: "one joint's position and velocity are not a number for",
        effect: entry("sensor_nan", Size::None, Lasts::Level, AffectedPart::Joint),
        levels: [0.0, 0.005, 0.05],
        unit: "s",
        bars: [follows(0.006), either(0.01), stops(30.0, 0.05)],
    },
    CatalogueFault {
        name: "huge_position",
        row: "F6",
        what: "a joint's position is off by 100 rad for",
        effect: entry("sensor_bias", Size::Fixed(100.0), Lasts::Level, AffectedPart::Joint),
        levels: [0.0, 0.005, 0.05],
        unit: "s",
        bars: [either(0.006), either(0.01), stops(30.0, 0.05)],
    },
    CatalogueFault {
        name: "huge_torque",
        row: "F6",
        what: "a joint's measured torque is off by 100,000 N·m for",
        effect: entry("torque_bias", Size::Fixed(1e5), Lasts::Level, AffectedPart::Joint),
        levels: [0.0, 0.005, 0.05],
        unit: "s",
        bars: [either(0.01), either(0.02), either(0.2)],
    },
    CatalogueFault {
        name: "torque_off",
        row: "F6",
        what: "a joint's measured torque is off, for the rest of the run, by this share of the joint's torque",
        effect: entry("torque_bias", Size::TorqueSigned, Lasts::Rest, AffectedPart::Joint),
        levels: [0.01, 0.05, 0.2],
        unit: "τ_max",
        bars: [follows(0.02), either(0.1), either(0.3)],
    },
    CatalogueFault {
        name: "wrong_order",
        row: "F7",
        what: "measurements arrive one joint off for",
        effect: entry("joint_order", Size::Fixed(1.0), Lasts::Level, AffectedPart::Arm),
        levels: [0.0, 0.005, 0.5],
        unit: "s",
        bars: [follows(0.006), either(0.01), stops(30.0, 0.05)],
    },
    CatalogueFault {
        name: "turn_off",
        row: "F8",
        what: "a joint's position is a whole turn off for",
        effect: entry(
            "sensor_bias",
            Size::Fixed(core::f64::consts::TAU),
            Lasts::Level,
            AffectedPart::Joint,
        ),
        levels: [0.0, 0.005, 0.5],
        unit: "s",
        bars: [either(0.006), either(0.01), stops(30.0, 0.05)],
    },
    CatalogueFault {
        name: "position_jump",
        row: "F8",
        what: "a joint's position is off, for the rest of the run, by",
        effect: entry("sensor_bias", Size::Signed, Lasts::Rest, AffectedPart::Joint),
        levels: [0.001, 0.01, 0.1],
        unit: "rad",
        bars: [follows(0.006), either(0.05), either(0.2)],
    },
    CatalogueFault {
        name: "payload_beyond",
        row: "F11",
        what: "a payload beyond the design's is picked up: so many times its heaviest",
        effect: entry("payload", Size::Payload, Lasts::Rest, AffectedPart::Arm),
        levels: [1.2, 1.5, 2.0],
        unit: "m_max",
        bars: [either(0.1), either(0.15), either(0.2)],
    },
    CatalogueFault {
        name: "payload_pick",
        row: "F12",
        what: "a payload is picked up: this share of the design's heaviest",
        effect: entry("payload", Size::Payload, Lasts::Rest, AffectedPart::Arm),
        levels: [0.25, 0.5, 1.0],
        unit: "m_max",
        bars: [follows(0.03), follows(0.05), follows(0.1)],
    },
    CatalogueFault {
        name: "payload_drop",
        row: "F12",
        what: "a payload is dropped: this share of the design's heaviest",
        effect: entry("payload", Size::Payload, Lasts::Before, AffectedPart::Arm),
        levels: [0.25, 0.5, 1.0],
        unit: "m_max",
        bars: [follows(0.03), follows(0.05), follows(0.1)],
    },
    CatalogueFault {
        name: "push",
        row: "F12",
        what: "something pushes a joint for 0.2 s with this share of its torque",
        effect: entry("push", Size::TorqueSigned, Lasts::Seconds(0.2), AffectedPart::Joint),
        levels: [0.05, 0.1, 0.2],
        unit: "τ_max",
        bars: [follows(0.05), either(0.1), either(0.2)],
    },
    CatalogueFault {
        name: "clock_ahead",
        row: "F19",
        what: "time stamps are ahead, for the rest of the run, by",
        effect: entry("clock_jump", Size::Level, Lasts::Rest, AffectedPart::Arm),
        levels: [0.01, 1.0, 3600.0],
        unit: "s",
        bars: [follows(0.006), follows(0.006), follows(0.006)],
    },
    CatalogueFault {
        name: "clock_back",
        row: "F19",
        what: "time stamps go back, at the onset, by",
        effect: entry("clock_jump", Size::Level, Lasts::Before, AffectedPart::Arm),
        levels: [0.01, 1.0, 3600.0],
        unit: "s",
        bars: [follows(0.006), follows(0.006), follows(0.006)],
    },
    CatalogueFault {
        name: "samples_lost",
        row: "F20",
        what: "samples are lost, for the rest of the run, with probability",
        effect: entry("sample_loss", Size::Level, Lasts::Rest, AffectedPart::Arm),
        levels: [0.01, 0.1, 0.5],
        unit: "",
        bars: [follows(0.006), follows(0.01), either(0.03)],
    },
    CatalogueFault {
        name: "samples_down",
        row: "F20",
        what: "no sample gets through for",
        effect: entry("sample_loss", Size::Fixed(1.0), Lasts::Level, AffectedPart::Arm),
        levels: [0.003, 0.01, 0.1],
        unit: "s",
        bars: [follows(0.01), either(0.02), stops(50.0, 0.05)],
    },
    CatalogueFault {
        name: "commands_lost",
        row: "F20",
        what: "commands are lost, for the rest of the run, with probability",
        effect: entry("command_loss", Size::Level, Lasts::Rest, AffectedPart::Arm),
        levels: [0.01, 0.1, 0.5],
        unit: "",
        bars: [follows(0.006), follows(0.01), either(0.03)],
    },
    CatalogueFault {
        name: "drive_weak",
        row: "F22",
        what: "a drive gives, for the rest of the run, only this share of its torque",
        effect: entry("drive_gain", Size::Level, Lasts::Rest, AffectedPart::Joint),
        levels: [0.9, 0.7, 0.5],
        unit: "",
        bars: [follows(0.03), either(0.06), LISTED],
    },
    CatalogueFault {
        name: "drive_strong",
        row: "F22",
        what: "a drive gives, for the rest of the run, so many times its torque",
        effect: entry("drive_gain", Size::Level, Lasts::Rest, AffectedPart::Joint),
        levels: [1.1, 1.3, 1.5],
        unit: "",
        bars: [follows(0.03), either(0.06), LISTED],
    },
    CatalogueFault {
        name: "drive_dead",
        row: "F22",
        what: "a drive gives no torque for",
        effect: entry("drive_gain", Size::Fixed(0.0), Lasts::Level, AffectedPart::Joint),
        levels: [0.005, 0.05, 1.0],
        unit: "s",
        bars: [either(0.02), LISTED, LISTED],
    },
    CatalogueFault {
        name: "drive_reversed",
        row: "F22",
        what: "a drive gives its torque the wrong way round for",
        effect: entry("drive_gain", Size::Fixed(-1.0), Lasts::Level, AffectedPart::Joint),
        levels: [0.005, 0.05, 1.0],
        unit: "s",
        bars: [either(0.02), LISTED, LISTED],
    },
    CatalogueFault {
        name: "brake",
        row: "F22",
        what: "a brake drags, for the rest of the run, with this share of the joint's torque",
        effect: entry("brake", Size::Torque, Lasts::Rest, AffectedPart::Joint),
        levels: [0.02, 0.1, 0.5],
        unit: "τ_max",
        bars: [either(0.05), either(0.1), either(0.3)],
    },
    CatalogueFault {
        name: "friction",
        row: "F23",
        what: "all friction is, for the rest of the run, so many times what it was",
        effect: entry("friction", Size::Level, Lasts::Rest, AffectedPart::Arm),
        levels: [2.0, 5.0, 10.0],
        unit: "",
        bars: [follows(0.01), follows(0.02), either(0.05)],
    },
    CatalogueFault {
        name: "drive_slow",
        row: "F24",
        what: "the drives' torque loops have this bandwidth",
        effect: keys(&[(&["world", "drive_bandwidth_hz"], Size::Level)]),
        levels: [300.0, 150.0, 80.0],
        unit: "Hz",
        bars: [follows(0.006), either(0.01), either(0.03)],
    },
    CatalogueFault {
        name: "samples_late",
        row: "F24",
        what: "measurements arrive late by",
        effect: keys(&[(&["sensor", "sample_delay_samples"], Size::Whole)]),
        levels: [1.0, 2.0, 3.0],
        unit: "samples",
        bars: [follows(0.006), either(0.01), either(0.03)],
    },
    CatalogueFault {
        name: "stop_and_restart",
        row: "F15",
        what: "a stop is asked for, and to start again after",
        effect: Effect::StopAndRestart,
        levels: [1.0, 0.5, 0.2],
        unit: "s",
        bars: [either(0.08); 3],
    },
    CatalogueFault {
        name: "rising_order",
        row: "F16",
        what: "the estimator starts at first order and rises when the mismatch stays below",
        effect: keys(&[
            (&["supervisor", "start_first_order"], Size::True),
            (&["supervisor", "settled_nm"], Size::Level),
            // From no knowledge at all, first order is off by more at the start.
            (&["supervisor", "error_stop_rad"], Size::Fixed(0.5)),
        ]),
        levels: [1.0, 3.0, 10.0],
        unit: "N·m",
        bars: [follows(0.006); 3],
    },
    CatalogueFault {
        name: "start_beside",
        row: "F21",
        what: "the arm starts beside its reference, every joint by",
        effect: Effect::StartBeside,
        levels: [0.01, 0.04, 0.2],
        unit: "rad",
        bars: [follows(0.006), follows(0.006), either(0.006)],
    },
    CatalogueFault {
        name: "stiction",
        row: "F23",
        what: "joints stick; they break away at so many times their Coulomb friction",
        effect: keys(&[(&["world", "stiction", "breakaway_ratio"], Size::Level)]),
        levels: [1.2, 1.5, 2.5],
        unit: "",
        bars: [follows(0.01), follows(0.01), either(0.02)],
    },
    CatalogueFault {
        name: "elastic",
        row: "F24",
        what: "the transmissions are springs of",
        effect: keys(&[
            (&["world", "flexibility", "stiffness_nm_rad"], Size::Level),
            (&["world", "flexibility", "damping_nm_s_rad"], Size::Fixed(5.0)),
        ]),
        levels: [50_000.0, 20_000.0, 5_000.0],
        unit: "N·m/rad",
        bars: [follows(0.01), either(0.02), LISTED],
    },
    CatalogueFault {
        name: "gain_error",
        row: "F22",
        what: "every drive's gain is off by a constant, drawn up to",
        effect: keys(&[(&["world", "drive", "gain_error"], Size::Level)]),
        levels: [0.02, 0.05, 0.1],
        unit: "",
        bars: [follows(0.006); 3],
    },
    CatalogueFault {
        name: "ripple",
        row: "F3",
        what: "the drives' torque ripples over the turn by this share",
        effect: keys(&[(&["world", "drive", "ripple"], Size::Level)]),
        levels: [0.01, 0.03, 0.1],
        unit: "",
        bars: [follows(0.006), follows(0.006), follows(0.01)],
    },
];

/// Severities of every fault.
pub const SEVERITIES: usize = 3;

#[cfg(test)]
mod tests {
    use super::FAULTS;

    #[test]
    fn there_are_thirty_faults_and_each_has_its_own_name() {
        let mut names: Vec<_> = FAULTS.iter().map(|fault| fault.name).collect();
        names.sort_unstable();
        names.dedup();
        assert!(names.len() == FAULTS.len() && names.len() > 30, "{}", names.len());
    }
}
