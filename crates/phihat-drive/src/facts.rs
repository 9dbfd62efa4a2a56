//! Facts about the other end of a link, as data.

use phihat_study::Study;
use serde::Serialize;
use thiserror::Error;

/// Owner of the clock, which determines when a sample is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// Nobody: each side waits for the other. Time is counted.
    LockStep,
    /// This machine, by an absolute sleep.
    Host,
    /// The robot: time and sequence come from the numbers of its messages.
    Robot,
}

/// Torques that a robot adds to its command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Adds {
    /// True if it adds the gravity torque of the arm without payload.
    pub gravity: bool,
    /// Share of its own friction, 0 … 1; `None`: not known.
    pub friction: Option<f64>,
}

/// Conditions on which a robot stops.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Stops {
    /// Torque rate beyond which it stops \[N·m/s\].
    pub torque_rate_max_nm_s: Option<f64>,
    /// First torque beyond which it does not start \[N·m\].
    pub first_torque_max_nm: Option<f64>,
    /// Lost commands in a row on which it stops.
    pub losses_max: Option<u32>,
}

/// Data that a link reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Tells {
    /// True if it reports the torque that was accepted last.
    pub echo: bool,
    /// True if it reports lost messages.
    pub losses: bool,
    /// True if it reports the true state, which no robot knows: the arm is simulated.
    pub truth: bool,
}

/// Facts of the other end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// Name in messages.
    pub name: String,
    /// Owner of the clock.
    pub clock: Clock,
    /// Time from one sample to the next \[ns\].
    pub period_ns: u64,
    /// Number of joints in its messages.
    pub width: usize,
    /// Their names, in the order of its messages; `None`: they have none, and are taken in the study's order.
    pub joints: Option<Vec<String>>,
    /// Torques that it adds to a command.
    pub adds: Adds,
    /// Conditions on which it stops.
    pub stops: Stops,
    /// Data that it reports.
    pub tells: Tells,
}

/// A figure of a study that is not that of the robot.
#[derive(Debug, Clone, PartialEq, Eq, Error, Serialize)]
#[error("{key}: the study says {study}, {link}")]
pub struct Mismatch {
    /// The key of the study.
    pub key: &'static str,
    /// Statement of the study.
    pub study: String,
    /// Fact of the link.
    pub link: String,
    /// Valid value.
    pub valid: String,
}

impl Facts {
    /// Mismatches of the study with the link: period of the loop, number of joints, and `[profile]`.
    ///
    /// A study may be stricter than a robot, never laxer: the law, its certificate and the rehearsal are
    /// about the study's values.
    pub fn against(&self, study: &Study) -> Vec<Mismatch> {
        let mut found = Vec::new();
        let mut wrong = |key, study: String, link: String, valid: String| {
            found.push(Mismatch { key, study, link: format!("{} {link}", self.name), valid });
        };
        let hertz = |ns: u64| 1e9 / ns as f64;
        let (own, theirs) = (hertz(study.control.period_ns), hertz(self.period_ns));
        if study.control.period_ns != self.period_ns {
            let valid = format!("`rate_hz = {theirs:?}` in [loop]");
            wrong("loop.rate_hz", format!("{own} Hz"), format!("runs at {theirs} Hz"), valid);
        }
        let joints = study.robot.joints.len();
        if self.joints.is_none() && joints != self.width {
            let valid = format!("a study of {} joints", self.width);
            wrong("robot", format!("{joints} joints"), format!("has {}", self.width), valid);
        }
        let profile = &study.interface.profile;
        if profile.adds_gravity != self.adds.gravity {
            let (study, link) = if self.adds.gravity {
                ("that the robot adds no gravity torque", "adds it")
            } else {
                ("that the robot adds gravity torque", "adds none")
            };
            let valid = format!("`adds_gravity = {}` in [profile]", self.adds.gravity);
            wrong("profile.adds_gravity", study.to_owned(), link.to_owned(), valid);
        }
        if let Some(share) = self.adds.friction
            && (profile.adds_friction - share).abs() > 0.0
        {
            let study = format!("{} of the friction", profile.adds_friction);
            let valid = format!("`adds_friction = {share:?}` in [profile]");
            wrong("profile.adds_friction", study, format!("adds {share}"), valid);
        }
        self.stops_against(study, &mut wrong);
        found
    }

    fn stops_against(
        &self,
        study: &Study,
        wrong: &mut dyn FnMut(&'static str, String, String, String),
    ) {
        let profile = &study.interface.profile;
        let said = |own: Option<f64>, unit: &str| {
            own.map_or("nothing of one".to_owned(), |own| format!("{own} {unit}"))
        };
        let laxer = |own: Option<f64>, link: f64| own.is_none_or(|own| own > link);
        let rate = (profile.torque_rate_max, self.stops.torque_rate_max_nm_s);
        let first = (profile.first_torque_max, self.stops.first_torque_max_nm);
        let losses = (profile.losses_max.map(f64::from), self.stops.losses_max.map(f64::from));
        for (key, (own, link), unit, what) in [
            (
                "profile.torque_rate_max_nm_s",
                rate,
                "N·m/s",
                "stops on torques that change faster than",
            ),
            (
                "profile.first_torque_max_nm",
                first,
                "N·m",
                "does not start on a first torque beyond",
            ),
            ("profile.losses_max", losses, "in a row", "stops on lost commands, as many as"),
        ] {
            let Some(limit) = link.filter(|link| laxer(own, *link)) else { continue };
            let name = key.trim_start_matches("profile.");
            let valid = format!("`{name} = {limit}` in [profile], or less");
            wrong(key, said(own, unit), format!("{what} {limit} {unit}"), valid);
        }
        let keeps =
            self.stops.torque_rate_max_nm_s.is_some() || self.stops.first_torque_max_nm.is_some();
        if keeps && !study.interface.kept {
            let valid = "`controller_keeps = true` in [profile]".to_owned();
            let link = "stops when nobody does".to_owned();
            wrong(
                "profile.controller_keeps",
                "that nobody keeps the rules".to_owned(),
                link,
                valid,
            );
        }
    }
}
