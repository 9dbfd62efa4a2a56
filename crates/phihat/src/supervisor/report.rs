//! Report on a sample: values, never a panic and never a log line.

use core::ops::{BitOr, BitOrAssign};

use crate::{Mode, Refusal};

/// A set of things that happened at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct Events(u32);

macro_rules! events {
    ($($(#[doc = $text:literal])* $name:ident = $bit:literal, $word:literal;)*) => {
        impl Events {
            $($(#[doc = $text])* pub const $name: Self = Self(1 << $bit);)*
            /// Every event with its name in files.
            pub const ALL: &'static [(Self, &'static str)] = &[$((Self::$name, $word)),*];
        }
    };
}

events! {
    /// No fresh, plausible sample: torque is held, then faded to `φ̂`.
    MISSED = 0, "missed";
    /// The sequence number was there before.
    DUPLICATE = 1, "duplicate";
    /// The sequence number is older than, or implausibly far from, the last one.
    REORDERED = 2, "reordered";
    /// The sample is older than the age limit.
    AGED = 3, "aged";
    /// The time since the last sample is negative, less than a twentieth of the period or beyond three: nothing
    /// is integrated.
    TIME_JUMP = 4, "time-jump";
    /// A measured value is not finite or beyond ±2³² (4.3e9), or the number of joints is wrong.
    NOT_FINITE = 5, "not-finite";
    /// A position step or a velocity is beyond what the joint can do.
    IMPLAUSIBLE = 6, "implausible";
    /// The reference is not finite or beyond ±2³², or the number of joints is wrong: the last one is held.
    REFERENCE_REFUSED = 7, "reference-refused";
    /// A torque limit acted.
    SATURATED = 8, "saturated";
    /// A torque-rate limit acted.
    RATE_LIMITED = 9, "rate-limited";
    /// A soft joint limit acted on torque, integral or reference.
    RANGE = 10, "range";
    /// The reference governor changed the reference.
    SHAPED = 11, "shaped";
    /// The funnel acts in place of the estimator.
    FUNNEL = 12, "funnel";
    /// An error left the funnel.
    FUNNEL_LEFT = 13, "funnel-left";
    /// The schedule went from the start gains to the running gains.
    RAISED = 14, "raised";
    /// The schedule went back to the start gains.
    LOWERED = 15, "lowered";
    /// The integral dead zone holds an estimate.
    DEAD_ZONE = 16, "dead-zone";
    /// A request was not granted; see [`Report::refusal`].
    REFUSED = 17, "refused";
    /// The estimator has taken over from a funnel.
    FUNNEL_OVER = 18, "funnel-over";
    /// In a stop: the law would have given the joint energy, and its torque was held back.
    HELD_BACK = 19, "held-back";
    /// A measured torque is none that the drive can give: the last command counts in its place.
    TORQUE_REFUSED = 20, "torque-refused";
    /// In a stop: a drive does not follow its command, and its joint gets no torque.
    LET_GO = 21, "let-go";
}

impl Events {
    /// The empty set: nothing happened.
    pub const NONE: Self = Self(0);

    /// Returns true if all of `other` are in the set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The names of what is in the set, in the order of [`Self::ALL`].
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::ALL.iter().filter(move |(event, _)| self.contains(*event)).map(|(_, name)| *name)
    }

    /// Returns true if the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The set as bits, for records.
    pub fn bits(self) -> u32 {
        self.0
    }

    /// `self` if `condition`, else nothing.
    pub(crate) fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::NONE }
    }
}

impl BitOr for Events {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Events {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// Why a supervisor stops the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fault {
    /// Too many samples in a row were missed.
    LinkLost,
    /// Too many of the last 64 samples were missed.
    LinkQuality,
    /// Samples came, but not finite or not plausible, several times in a row.
    BadSample,
    /// The reference was not finite, several times in a row.
    BadReference,
    /// A position does not change while the joint moves.
    Frozen,
    /// A joint is beyond its range.
    JointLimit,
    /// The tracking error is beyond its limit.
    TrackingError,
    /// The measured error was beyond its certified bound in three samples in a row: something acts that the
    /// certificate does not count.
    ErrorBound,
    /// A joint is faster than its limit.
    Overspeed,
    /// The torque demand oscillates near the sample rate, or the law drives a joint that it should stop.
    Oscillation,
    /// The joint does not accelerate the way the torque pushes.
    Actuation,
    /// The torque was at its limit for longer than a motion explains.
    Saturation,
    /// The clock of the samples is wrong in many of them.
    Clock,
    /// The law's torque was not finite.
    NotFinite,
}

impl Fault {
    /// All faults.
    pub const ALL: [Self; 14] = [
        Self::LinkLost,
        Self::LinkQuality,
        Self::BadSample,
        Self::BadReference,
        Self::Frozen,
        Self::JointLimit,
        Self::TrackingError,
        Self::ErrorBound,
        Self::Overspeed,
        Self::Oscillation,
        Self::Actuation,
        Self::Saturation,
        Self::Clock,
        Self::NotFinite,
    ];

    /// The fault's name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::LinkLost => "link-lost",
            Self::LinkQuality => "link-quality",
            Self::BadSample => "bad-sample",
            Self::BadReference => "bad-reference",
            Self::Frozen => "frozen-sensor",
            Self::JointLimit => "joint-limit",
            Self::TrackingError => "tracking-error",
            Self::ErrorBound => "error-bound",
            Self::Overspeed => "overspeed",
            Self::Oscillation => "oscillation",
            Self::Actuation => "actuation",
            Self::Saturation => "saturation",
            Self::Clock => "clock",
            Self::NotFinite => "not-finite",
        }
    }
}

/// Report of a supervisor on one sample, in addition to the torques.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Report {
    /// The mode from this sample on.
    pub mode: Mode,
    /// Fault that stopped the arm, and the joint (0 where it is the whole arm); stored until the arm is armed
    /// again.
    pub fault: Option<(Fault, usize)>,
    /// Why the request was not granted.
    pub refusal: Option<Refusal>,
    /// Events at this sample.
    pub events: Events,
    /// The brakes should be closed.
    pub brake: bool,
    /// Samples missed in a row.
    pub misses: u32,
    /// Samples missed of the last 64.
    pub lost: u32,
    /// Largest measured |e| of a joint as a share of its [bound](crate::JointOptions::error_bound), in holding and
    /// tracking; 0 where there is none.
    pub error_share: f32,
}
