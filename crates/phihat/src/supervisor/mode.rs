//! The modes of an arm, and the only way from one to another.

/// Mode of the supervisor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Mode {
    /// No torque. The brakes are on, or the robot holds itself.
    #[default]
    Idle,
    /// Ready: the pose is known and at rest; the held torque and damping act.
    Armed,
    /// The law holds a pose.
    Holding,
    /// The law follows the reference.
    Tracking,
    /// Latched: the law brings the arm to rest and holds it there, then the brakes. Left by an explicit request.
    SafeStop,
}

impl Mode {
    /// All modes.
    pub const ALL: [Self; 5] =
        [Self::Idle, Self::Armed, Self::Holding, Self::Tracking, Self::SafeStop];

    /// The mode's name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Armed => "armed",
            Self::Holding => "holding",
            Self::Tracking => "tracking",
            Self::SafeStop => "safe-stop",
        }
    }
}

/// Mode that the caller requests at this sample: a level, not an edge, except that [`Self::Arm`] counts only
/// when it is new, so that nothing moves again by itself after a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum ModeRequest {
    /// No torque; from [`Mode::Armed`] and [`Mode::SafeStop`] only.
    #[default]
    Idle,
    /// Get ready; from [`Mode::Idle`] and [`Mode::SafeStop`].
    Arm,
    /// Hold the pose.
    Hold,
    /// Follow the reference; from [`Mode::Holding`].
    Track,
    /// Safe stop; always granted while torque is on.
    Stop,
}

/// Inputs of [`next_mode`]: the request, and the conditions at this sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[allow(clippy::struct_excessive_bools, reason = "a set of independent facts")]
pub struct ModeEvents {
    /// Mode that the caller requests.
    pub request: ModeRequest,
    /// True if the request of the last sample was another one.
    pub request_is_new: bool,
    /// Something is wrong at this sample.
    pub fault: bool,
    /// This sample is fresh and plausible.
    pub fresh: bool,
    /// Every joint is at rest.
    pub at_rest: bool,
    /// The reference starts near the pose.
    pub start_matches: bool,
    /// The pose is outside of the box that references are kept in.
    pub outside_box: bool,
}

/// Action on entering a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Action {
    /// Nothing changes.
    #[default]
    None,
    /// Take the measured pose as home; the held torque, or the preset, becomes `φ̂`.
    Capture,
    /// Start the law on the captured pose.
    Engage,
    /// Blend from the held pose to the reference.
    Follow,
    /// Blend from the reference to a pose that is reached without a jolt.
    Settle,
    /// Bring the arm to rest and hold it there; latch.
    Stop,
    /// Torque off.
    Release,
}

/// Why a request for a mode is not granted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Refusal {
    /// The arm is not armed: ask for [`ModeRequest::Arm`] first.
    NotArmed,
    /// The arm does not hold a pose: ask for [`ModeRequest::Hold`] first.
    NotHolding,
    /// Stop first: torque is not switched off under a moving arm.
    NotStopped,
    /// The arm is in a later mode already.
    AlreadyActive,
    /// After a stop, ask for [`ModeRequest::Arm`]; the stop stays latched until then.
    Latched,
    /// [`ModeRequest::Arm`] was already there before: release it and ask again.
    NotNew,
    /// A fault is there still.
    Fault,
    /// There is no fresh sample.
    NotFresh,
    /// The arm moves.
    NotAtRest,
    /// The reference is too far from the pose.
    StartMismatch,
    /// The pose is outside of the box that references are kept in.
    OutsideBox,
}

impl Refusal {
    /// The refusal's name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotArmed => "not-armed",
            Self::NotHolding => "not-holding",
            Self::NotStopped => "not-stopped",
            Self::AlreadyActive => "already-active",
            Self::Latched => "latched",
            Self::NotNew => "not-new",
            Self::Fault => "fault",
            Self::NotFresh => "not-fresh",
            Self::NotAtRest => "not-at-rest",
            Self::StartMismatch => "start-mismatch",
            Self::OutsideBox => "outside-box",
        }
    }
}

/// The mode from now on, and the action on entering it: the result of [`next_mode`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Transition {
    /// The mode from now on.
    pub mode: Mode,
    /// Action on entering it.
    pub action: Action,
    /// Why the request was not granted, if it was not.
    pub refusal: Option<Refusal>,
}

/// The mode machine: a pure function. A fault or a stop wins over everything; every other way is one step.
///
/// # Example
///
/// ```
/// use phihat::{Mode, ModeEvents, ModeRequest, Refusal, next_mode};
///
/// // A tracking arm that meets a fault stops, whatever is asked for.
/// let fault = ModeEvents { request: ModeRequest::Track, fault: true, ..ModeEvents::default() };
/// assert_eq!(next_mode(Mode::Tracking, fault).mode, Mode::SafeStop);
///
/// // The stop is latched: to track again, arm first.
/// let again = ModeEvents { request: ModeRequest::Track, fresh: true, ..ModeEvents::default() };
/// let answer = next_mode(Mode::SafeStop, again);
/// assert_eq!((answer.mode, answer.refusal), (Mode::SafeStop, Some(Refusal::Latched)));
/// ```
#[must_use]
pub fn next_mode(mode: Mode, events: ModeEvents) -> Transition {
    let go = |mode, action| Transition { mode, action, refusal: None };
    let stay = Transition { mode, action: Action::None, refusal: None };
    let refuse = |why| Transition { refusal: Some(why), ..stay };
    let active = matches!(mode, Mode::Armed | Mode::Holding | Mode::Tracking);
    if active && (events.fault || events.request == ModeRequest::Stop) {
        return go(Mode::SafeStop, Action::Stop);
    }
    match (mode, events.request) {
        (_, ModeRequest::Stop)
        | (Mode::Idle, ModeRequest::Idle)
        | (Mode::Armed, ModeRequest::Arm)
        | (Mode::Holding, ModeRequest::Hold)
        | (Mode::Tracking, ModeRequest::Track) => stay,
        (Mode::Idle | Mode::SafeStop, ModeRequest::Arm) => match blocked(mode, events) {
            Some(why) => refuse(why),
            None => go(Mode::Armed, Action::Capture),
        },
        (Mode::Idle, ModeRequest::Hold | ModeRequest::Track) => refuse(Refusal::NotArmed),
        (Mode::SafeStop, ModeRequest::Hold | ModeRequest::Track) => refuse(Refusal::Latched),
        (Mode::Armed | Mode::SafeStop, ModeRequest::Idle) => go(Mode::Idle, Action::Release),
        (Mode::Armed, ModeRequest::Track) => refuse(Refusal::NotHolding),
        (Mode::Armed, ModeRequest::Hold) | (Mode::Holding, ModeRequest::Track) if !events.fresh => {
            refuse(Refusal::NotFresh)
        }
        (Mode::Armed, ModeRequest::Hold) if events.outside_box => refuse(Refusal::OutsideBox),
        (Mode::Armed, ModeRequest::Hold) => go(Mode::Holding, Action::Engage),
        (Mode::Holding, ModeRequest::Track) if !events.start_matches => {
            refuse(Refusal::StartMismatch)
        }
        (Mode::Holding, ModeRequest::Track) => go(Mode::Tracking, Action::Follow),
        (Mode::Tracking, ModeRequest::Hold) => go(Mode::Holding, Action::Settle),
        (Mode::Holding | Mode::Tracking, ModeRequest::Idle) => refuse(Refusal::NotStopped),
        (Mode::Holding | Mode::Tracking, ModeRequest::Arm) => refuse(Refusal::AlreadyActive),
    }
}

/// Reason why the arm cannot be armed; `None`: it can be.
fn blocked(mode: Mode, events: ModeEvents) -> Option<Refusal> {
    // From idle a caller may ask until the arm is ready; after a stop it has to ask anew.
    if mode == Mode::SafeStop && !events.request_is_new {
        Some(Refusal::NotNew)
    } else if events.fault {
        Some(Refusal::Fault)
    } else if !events.fresh {
        Some(Refusal::NotFresh)
    } else if !events.at_rest {
        Some(Refusal::NotAtRest)
    } else {
        None
    }
}
