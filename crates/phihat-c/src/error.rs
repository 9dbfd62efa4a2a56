//! Status codes, and the one structure that says what was wrong.

use core::ffi::{CStr, c_char};
use core::fmt::{self, Write};

use phihat::{Gain, GainError, OptionError};

/// Result of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// The sample held something that is not finite, or beyond +-2^32 (4.3e9), or led to what is not finite:
    /// the command holds the last torque of every joint, the controller's state is untouched.
    Refused = 1,
    /// A pointer that must not be null is.
    NullPointer = 2,
    /// A structure's `size` is not sizeof() of it, in this version of the header or in an older one that this
    /// library still reads.
    WrongSize = 3,
    /// The number of joints is 0, or not that of the controller.
    WrongJoints = 4,
    /// A gain or limit is not possible; phihat_error says which.
    BadGain = 5,
    /// There is no memory left.
    OutOfMemory = 6,
    /// A mistake of this library: please report it.
    Internal = 7,
    /// An option is not possible; phihat_error says which.
    BadOption = 8,
}

/// Description of an error, for people and programs.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_error {
    /// sizeof(phihat_error).
    pub size: usize,
    /// Joint of the error, from 0; SIZE_MAX where none is meant.
    pub joint: usize,
    /// The value that was refused; NAN where none is meant.
    pub value: f64,
    /// Name of the member that was refused; empty where none is meant.
    pub member: [c_char; 32],
    /// One line: what is wrong and what would be right.
    pub text: [c_char; 192],
}

/// A refusal on its way to the border.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RefusedCall {
    pub(crate) status: Status,
    pub(crate) joint: Option<usize>,
    member: Member,
    value: f64,
    why: Why,
}

#[derive(Debug, Clone, Copy)]
enum Why {
    Text(&'static str),
    Gain(GainError),
    Option(OptionError),
}

/// A member of a structure, by name and where it is an array by place.
#[derive(Debug, Clone, Copy)]
struct Member(&'static str, Option<usize>);

impl RefusedCall {
    pub(crate) fn new(status: Status, text: &'static str) -> Self {
        let (member, value) = (Member("", None), f64::NAN);
        Self { status, joint: None, member, value, why: Why::Text(text) }
    }

    /// Gains of a law with an estimator, and limits.
    pub(crate) fn gain(error: GainError) -> Self {
        let (member, value) = blamed(error, "a");
        Self { status: Status::BadGain, joint: None, member, value, why: Why::Gain(error) }
    }

    /// Gains of a law from positions.
    pub(crate) fn of_positions(error: GainError) -> Self {
        let (member, value) = blamed(error, "correction");
        Self { member, value, ..Self::gain(error) }
    }

    /// The innovation filter of a law from positions; `rates` are those of its sections.
    pub(crate) fn of_filter(error: GainError, rates: &[[f64; 2]]) -> Self {
        let refusal = Self::of_positions(error);
        let fine = |i: usize| rates.get(i).is_some_and(|of| of.iter().all(|rate| rate.is_finite()));
        match error {
            // The core names the section, and there are two members of it.
            GainError::NotFinite { gain: Gain::Section(i), .. } if fine(i) => {
                Self { member: Member("section_weights_per_s2", Some(i)), ..refusal }
            }
            _ => refusal,
        }
    }

    pub(crate) fn option(joint: Option<usize>, error: OptionError) -> Self {
        let (member, value) = match error {
            OptionError::Value { option, value, .. } => (Member(option, None), value),
            _ => (Member("", None), f64::NAN),
        };
        Self { status: Status::BadOption, joint, member, value, why: Why::Option(error) }
    }

    pub(crate) fn at(self, joint: usize) -> Self {
        Self { joint: Some(joint), ..self }
    }

    /// It is about this member's value.
    pub(crate) fn member(self, name: &'static str, value: f64) -> Self {
        Self { member: Member(name, None), value, ..self }
    }

    /// The error as the caller gets it.
    pub(crate) fn told(&self) -> phihat_error {
        let mut error = phihat_error {
            size: size_of::<phihat_error>(),
            joint: self.joint.unwrap_or(usize::MAX),
            value: self.value,
            member: [0; 32],
            text: [0; 192],
        };
        let mut text = MessageLine::new(&mut error.text);
        // A line that is too long is cut, which is no error here.
        let _ = match (self.joint, self.why) {
            (Some(joint), Why::Text(why)) => write!(text, "joint {joint}: {why}"),
            (None, Why::Text(why)) => write!(text, "{why}"),
            // These say the joint themselves.
            (_, Why::Option(why)) => write!(text, "{why}"),
            (Some(joint), Why::Gain(why)) => write!(text, "joint {joint}: {why}"),
            (None, Why::Gain(why)) => write!(text, "{why}"),
        };
        let mut member = MessageLine::new(&mut error.member);
        let _ = match self.member {
            Member(name, Some(index)) => write!(member, "{name}[{index}]"),
            Member(name, None) => member.write_str(name),
        };
        error
    }
}

/// Member that an error is about, and its value; `estimator` is the one with the estimator's coefficients.
fn blamed(error: GainError, estimator: &'static str) -> (Member, f64) {
    let none = f64::NAN;
    let (name, index, value) = match error {
        GainError::NotPositive { gain, value } | GainError::NotFinite { gain, value } => {
            let (name, index) = named(gain);
            (name, index, value)
        }
        GainError::Order { .. } | GainError::Corrections { .. } => ("order", None, none),
        GainError::UnstableEstimator { .. } => (estimator, None, none),
        GainError::Share { value } => ("share", None, value),
        GainError::Delay { samples } => ("delay_samples", None, samples as f64),
        GainError::Sections { count } => ("sections", None, count as f64),
        GainError::UnstableSection { index } => ("section_rates", Some(index), none),
        GainError::Form => ("form", None, none),
        // Of no member: `Overflow`, and what the core may add.
        _ => ("", None, none),
    };
    (Member(name, index), value)
}

fn named(gain: Gain) -> (&'static str, Option<usize>) {
    match gain {
        Gain::Inertia => ("inertia_kg_m2", None),
        Gain::Kp => ("kp_per_s2", None),
        Gain::Kd => ("kd_per_s", None),
        Gain::A(i) => ("a", Some(i)),
        Gain::Period => ("period_s", None),
        Gain::TorqueMax => ("torque_max_nm", None),
        Gain::TorqueRateMax => ("torque_rate_max_nm_s", None),
        Gain::EnergyMax => ("energy_max_j", None),
        Gain::EnergyWindow => ("energy_window_s", None),
        Gain::Share => ("share", None),
        Gain::Correction(i) => ("correction", Some(i)),
        Gain::VelocityCorrection(i) => ("velocity_correction", Some(i)),
        Gain::Section(i) => ("section_rates", Some(i)),
        // Of no structure here.
        _ => ("", None),
    }
}

/// Writes ASCII into a C string, cut to fit, always closed by a zero.
struct MessageLine<'a> {
    room: core::slice::IterMut<'a, c_char>,
}

impl<'a> MessageLine<'a> {
    fn new(text: &'a mut [c_char]) -> Self {
        let room = text.split_last_mut().map_or(&mut [][..], |(_, room)| room);
        Self { room: room.iter_mut() }
    }
}

impl Write for MessageLine<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            let Some(place) = self.room.next() else { return Err(fmt::Error) };
            *place = c_char::from_ne_bytes([byte]);
        }
        Ok(())
    }
}

/// One line about a status, in English; never null, never to be freed.
#[unsafe(no_mangle)]
pub extern "C" fn phihat_status_text(status: i32) -> *const c_char {
    let text: &CStr = match status {
        0 => c"done",
        1 => c"the sample is not finite or beyond 2^32; the last torque is held",
        2 => c"a pointer that must not be null is",
        3 => c"a structure's size is that of no header that this library reads",
        4 => c"the number of joints is 0, or not that of the controller",
        5 => c"a gain or limit is not possible",
        6 => c"there is no memory left",
        7 => c"a mistake of the library",
        8 => c"an option is not possible",
        _ => c"no status of this version",
    };
    text.as_ptr()
}

/// Version of this library, as in "1.2.3"; never null, never to be freed.
#[unsafe(no_mangle)]
pub extern "C" fn phihat_version() -> *const c_char {
    const TEXT: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    TEXT.as_ptr().cast()
}
