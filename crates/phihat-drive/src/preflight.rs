//! Checks before anything moves. A check that fails refuses the drive, unless a person accepted it by name.

use std::path::Path;

use phihat_design::{Gains, arm_inside_window};
use phihat_model::Joint;
use phihat_session::{Done, FirstStudy, SessionError, arm};
use phihat_sim::{Motion, SimError, overload};
use phihat_study::Study;
use serde::Serialize;

use crate::described::apart;
use crate::facts::{Clock, Facts};
use crate::finding::Finding;
use crate::link::{Link as _, LinkedRobot, Readiness, Standing};
use crate::machine::Machine;
use crate::order::Order;

/// A check, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckName {
    /// The gains carry a certificate, and every claim in it that the file can show holds.
    Certificate,
    /// The arm's inertia lies inside the window of the gains.
    Window,
    /// The motion needs no more than the drives have.
    Motion,
    /// The study's `[profile]` says of the robot what is true of the link.
    Profile,
    /// A supervisor is around the law.
    Supervisor,
    /// The robot takes torques, and stands where the motion begins.
    Robot,
    /// The robot's own description is of the arm that the study is about.
    Description,
    /// This machine keeps time.
    RealTime,
    /// The same gains and motion, simulated, keep what the study asks for.
    Rehearsal,
}

impl CheckName {
    /// All checks, in their order.
    pub const ALL: [Self; 9] = [
        Self::Certificate,
        Self::Window,
        Self::Motion,
        Self::Profile,
        Self::Supervisor,
        Self::Robot,
        Self::Description,
        Self::RealTime,
        Self::Rehearsal,
    ];

    /// The word for it on a command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Certificate => "certificate",
            Self::Window => "window",
            Self::Motion => "motion",
            Self::Profile => "profile",
            Self::Supervisor => "supervisor",
            Self::Robot => "robot",
            Self::Description => "description",
            Self::RealTime => "real-time",
            Self::Rehearsal => "rehearsal",
        }
    }

    /// The check of this word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|check| check.word() == word)
    }
}

/// Result of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// It holds.
    Passed,
    /// It does not hold.
    Failed,
    /// It does not hold, and a person goes on in spite of it.
    Accepted,
    /// It is not asked of this link.
    NotAsked,
}

/// A check and its result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// Name of the check.
    pub name: CheckName,
    /// Result.
    pub state: State,
    /// Finding.
    pub found: String,
    /// Valid alternative; `None`: the check passed or was not asked.
    pub valid: Option<String>,
}

impl Check {
    fn passed(name: CheckName, found: impl Into<String>) -> Self {
        Self { name, state: State::Passed, found: found.into(), valid: None }
    }

    fn not_asked(name: CheckName, found: impl Into<String>) -> Self {
        Self { state: State::NotAsked, ..Self::passed(name, found) }
    }

    fn failed(name: CheckName, found: impl Into<String>, valid: impl Into<String>) -> Self {
        let (found, valid) = (found.into(), Some(valid.into()));
        Self { name, state: State::Failed, found, valid }
    }

    /// The same, where a person may have accepted it.
    #[must_use]
    pub fn unless(self, accepted: &[CheckName]) -> Self {
        let gone_on = self.state == State::Failed && accepted.contains(&self.name);
        if gone_on { Self { state: State::Accepted, ..self } } else { self }
    }

    /// Returns true if the check failed and was not accepted: nothing may move.
    pub fn refuses(&self) -> bool {
        self.state == State::Failed
    }
}

/// Checks that the gains carry a certificate whose claims hold as far as the file can show.
pub(crate) fn certificate(study: &Study, gains: &Gains) -> Check {
    let name = CheckName::Certificate;
    let Some(certificate) = &gains.certificate else {
        let valid = "gains that `phihat design` leaves, by --gains FILE";
        return Check::failed(name, "these gains carry no certificate", valid);
    };
    match certificate.verified(gains) {
        Err(why) => Check::failed(name, why.to_string(), "gains that `phihat verify` accepts"),
        Ok(_) if gains.study_sha256 == study.sha256 => {
            Check::passed(name, "every claim that the file can show holds")
        }
        Ok(_) => Check::passed(
            name,
            "every claim that the file can show holds; it is about another study, so its tube says nothing of this \
                motion",
        ),
    }
}

/// Checks that the arm's inertia lies inside the window of the gains.
pub(crate) fn window(study: &Study, path: &Path, gains: &Gains) -> Result<Check, SessionError> {
    let arm = arm(study, path)?;
    Ok(match arm_inside_window(study, &arm, gains) {
        Ok(()) => Check::passed(CheckName::Window, "the arm's inertia lies inside"),
        Err(why) => {
            let valid = "gains that were designed for this arm: `phihat design`";
            Check::failed(CheckName::Window, why.to_string(), valid)
        }
    })
}

/// The first two checks of a first motion: its gains carry no certificate, but their window covers the error
/// of the guess.
pub(crate) fn cautious(first: &FirstStudy) -> (Check, Check) {
    let why = "of a first motion, whose gains are cautious and not certified";
    let certificate = Check::not_asked(CheckName::Certificate, why);
    let window = match &first.window {
        Ok(factor) => Check::passed(
            CheckName::Window,
            format!(
                "at {} rad/s it holds any inertia within a factor of {factor} of the guess",
                first.bandwidth
            ),
        ),
        Err(why) => {
            let valid = "a loop with less delay, or a better guess with --inertia-within";
            Check::failed(CheckName::Window, why.to_string(), valid)
        }
    };
    (certificate, window)
}

/// Checks that the motion needs no more torque and speed than the drives have.
pub(crate) fn motion(study: &Study, path: &Path) -> Result<Check, SessionError> {
    let name = CheckName::Motion;
    Ok(match overload(study).map_err(|e| SessionError::at(path, e))? {
        None => Check::passed(name, "it needs no more than the drives have"),
        Some(more) => Check::failed(name, more.to_string(), "a slower or smaller motion"),
    })
}

/// Checks that the study's `[profile]` agrees with the facts of the link.
pub(crate) fn profile(study: &Study, facts: &Facts) -> Check {
    let name = CheckName::Profile;
    let found = facts.against(study);
    if found.is_empty() {
        let words = format!("`{}` is what {} does", study.interface.profile.name, facts.name);
        return Check::passed(name, words);
    }
    let words: Vec<String> = found.iter().map(ToString::to_string).collect();
    let valid: Vec<String> = found.into_iter().map(|wrong| wrong.valid).collect();
    Check::failed(name, words.join("; "), valid.join("; "))
}

/// Checks that there is a supervisor; not asked of a simulated arm.
pub(crate) fn supervisor(study: &Study, facts: &Facts) -> Check {
    let name = CheckName::Supervisor;
    match (study.supervisor.is_some(), facts.tells.truth) {
        (true, _) => Check::passed(name, "it is around the law"),
        (false, true) => Check::not_asked(name, "of a simulated arm"),
        (false, false) => Check::failed(
            name,
            "nothing guards samples, limits and modes",
            "a section [supervisor] in the study",
        ),
    }
}

/// Largest distance of a joint from the start of the motion \[rad\], without a supervisor.
const START_MAX: f64 = 0.05;

/// Checks that a robot accepts torques and stands where the motion begins; `recovers`: a robot that stopped
/// is recovered first.
pub(crate) fn robot(
    study: &Study,
    (standing, order): (Option<&Standing>, &Order),
    recovers: bool,
) -> Result<Check, SimError> {
    let name = CheckName::Robot;
    let Some(Standing { q, readiness }) = standing else {
        return Ok(Check::not_asked(name, "of a simulated arm"));
    };
    match readiness {
        Readiness::Ready => {}
        Readiness::Stopped(_) if recovers => {}
        Readiness::Stopped(found) | Readiness::Busy(found) => {
            let valid = "a robot that is idle; `--recover` leads out of a reflex";
            return Ok(Check::failed(name, found, valid));
        }
    }
    let most = study.supervisor.as_ref().map_or(START_MAX, |asked| asked.start_mismatch_max);
    let motion = Motion::of(study)?;
    let off = study.robot.joints.iter().enumerate().map(|(i, joint)| {
        let [wanted, ..] = motion.told(i, 0.0);
        (joint, q.get(order.place(i)).copied().unwrap_or(f64::NAN), wanted)
    });
    let far: Vec<_> = off.filter(|(_, q, wanted)| beyond((q - wanted).abs(), most)).collect();
    if far.is_empty() {
        let found = format!("it is idle, each joint within {most} rad of where the motion begins");
        return Ok(Check::passed(name, found));
    }
    let words = |(joint, q, wanted): &(&Joint, f64, f64)| {
        format!("{} stands at {q:.3} rad, the motion begins at {wanted:.3}", joint.name)
    };
    let found = far.iter().map(words).collect::<Vec<_>>().join("; ");
    Ok(Check::failed(name, found, format!("within {most} rad: move the arm there by hand first")))
}

/// Returns true if a value exceeds a limit or is NaN.
fn beyond(figure: f64, most: f64) -> bool {
    figure.is_nan() || figure > most
}

/// Largest relative difference of the inertia of two descriptions of one arm: rounding and a flange cause it,
/// and the window of a certificate covers it.
const INERTIA_APART_MAX: f64 = 0.05;

/// Checks that the robot's own description is of the study's arm.
pub(crate) fn description(study: &Study, robot: Option<&mut LinkedRobot>) -> Check {
    let name = CheckName::Description;
    let Some(robot) = robot else { return Check::not_asked(name, "of a simulated arm") };
    let Some(told) = robot.description() else {
        return Check::not_asked(name, "of a robot that hands out none");
    };
    let valid = "a study about this arm, made of its description by `phihat new`";
    let told = match told {
        Ok(told) => told,
        Err(why) => return Check::failed(name, why.to_string(), valid),
    };
    match apart(study, &told) {
        Err(why) => Check::failed(name, why.to_string(), valid),
        Ok((low, high)) => {
            let found = format!(
                "the robot's inertia is {low:.3} … {high:.3} times that of `{}`",
                study.robot.name
            );
            let alike = low >= 1.0 - INERTIA_APART_MAX && high <= 1.0 + INERTIA_APART_MAX;
            if alike { Check::passed(name, found) } else { Check::failed(name, found, valid) }
        }
    }
}

/// Checks that this machine is set for real time; not asked in lock-step.
pub(crate) fn real_time(facts: &Facts) -> Check {
    let name = CheckName::RealTime;
    if facts.clock == Clock::LockStep {
        return Check::not_asked(name, "in lock-step");
    }
    let found = match Machine::look() {
        Err(why) => return Check::failed(name, why.to_string(), "Linux with PREEMPT_RT"),
        Ok(found) => found,
    };
    let bad: Vec<&Finding> = found.iter().filter(|finding| !finding.good).collect();
    if bad.is_empty() {
        return Check::passed(name, "kernel, scheduling, memory and frequency are set for it");
    }
    let words: Vec<String> = bad.iter().map(|f| format!("{}: {}", f.what, f.found)).collect();
    let valid: Vec<&str> = bad.iter().filter_map(|f| f.change.as_deref()).collect();
    Check::failed(name, words.join("; "), valid.join("; "))
}

/// Checks that a simulation of the same gains and motion ends within the specification; `None`: the drive is
/// that simulation.
pub(crate) fn rehearsal(done: Option<&Done>) -> Check {
    let name = CheckName::Rehearsal;
    let Some(done) = done else { return Check::not_asked(name, "of a simulation in lock-step") };
    if done.good() {
        return Check::passed(name, format!("simulated: {}", done.verdict()));
    }
    let valid = "a study that `phihat run` ends within spec";
    Check::failed(name, format!("simulated: {}", done.verdict()), valid)
}
