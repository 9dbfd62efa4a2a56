//! `[[fault]]`: what goes wrong, when, and how badly.

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::NumberBounds;
use crate::node::Node;

/// Something that goes wrong for a while. Plain data: a list of these can be built by a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// When it begins \[s\].
    pub start: f64,
    /// Duration \[s\]; infinite: to the end of the run.
    pub duration: f64,
    /// The joint it is about; `None`: every joint.
    pub joint: Option<usize>,
    /// Size, in the unit of its kind; 1 where the kind has no size.
    pub size: f64,
}

impl Fault {
    /// Returns true if it acts at time `t` \[s\].
    pub fn active(&self, t: f64) -> bool {
        self.start <= t && t < self.start + self.duration
    }

    /// Returns true if it acts on this joint.
    pub fn concerns(&self, joint: usize) -> bool {
        self.joint.is_none_or(|j| j == joint)
    }
}

macro_rules! kinds {
    ($($kind:ident $word:literal, $joint:literal, $unit:literal, $bounds:expr, $default:expr, $doc:literal;)*) => {
        /// Kinds of fault that a study can request.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum FaultKind {
            $(#[doc = $doc] $kind,)*
        }

        impl FaultKind {
            /// All kinds.
            pub const ALL: &'static [Self] = &[$(Self::$kind),*];

            /// The kind's name in a study.
            pub fn word(self) -> &'static str {
                match self { $(Self::$kind => $word),* }
            }

            /// The unit of its size; empty for a ratio.
            pub fn unit(self) -> &'static str {
                match self { $(Self::$kind => $unit),* }
            }

            /// Returns true if it can act on a single joint.
            pub fn per_joint(self) -> bool {
                match self { $(Self::$kind => $joint),* }
            }

            /// Bounds on its size; `None`: it has no size.
            fn bounds(self) -> Option<NumberBounds> {
                match self { $(Self::$kind => $bounds),* }
            }

            /// The size it has unless the study states one.
            fn default_size(self) -> Option<f64> {
                match self { $(Self::$kind => $default),* }
            }
        }

        pub(crate) const WORDS: &[&str] = &[$($word),*];
        pub(crate) const DOC: &str =
            concat!("What goes wrong.", $(" `", $word, "`: ", $doc),*);
    };
}

kinds! {
    DriveGain "drive_gain", true, "", Some(NumberBounds::within(10.0)), None,
        "The drive gives so many times its torque: 0.5 weak, 0 dead, −1 wired the wrong way round.";
    DriveLimit "drive_limit", true, "N·m", Some(NumberBounds::closed(0.0, 1e5)), None,
        "The drive gives no more than so much torque, in N·m.";
    Friction "friction", true, "", Some(NumberBounds::closed(0.0, 1e3)), None,
        "All friction is so many times what it was.";
    Brake "brake", true, "N·m", Some(NumberBounds::closed(0.0, 1e5)), None,
        "A brake drags with so much dry friction, in N·m.";
    Push "push", true, "N·m", Some(NumberBounds::within(1e5)), None,
        "An external torque, in N·m.";
    Payload "payload", false, "kg", Some(NumberBounds::closed(0.0, 1e3)), None,
        "A point mass, in kg, at the robot's tip, picked up at the start and dropped at the end.";
    SensorFreeze "sensor_freeze", true, "", None, Some(1.0),
        "Position and velocity keep their last value, while messages keep coming.";
    SensorNan "sensor_nan", true, "", None, Some(1.0),
        "Position and velocity are not a number.";
    SensorBias "sensor_bias", true, "rad", Some(NumberBounds::within(100.0)), None,
        "The position is off by so much, in rad.";
    SensorNoise "sensor_noise", true, "rad", Some(NumberBounds::closed(0.0, 1.0)), None,
        "White noise of this standard deviation, in rad, on the position.";
    TorqueBias "torque_bias", true, "N·m", Some(NumberBounds::within(1e5)), None,
        "The measured torque is off by so much, in N·m.";
    JointOrder "joint_order", false, "places", Some(NumberBounds::integers(1.0, 100.0)), Some(1.0),
        "Measurements arrive in the wrong order, turned by so many places.";
    ClockJump "clock_jump", false, "s", Some(NumberBounds::closed(0.0, 86_400.0)), None,
        "Time stamps are ahead by so much, in s.";
    SampleLoss "sample_loss", false, "", Some(NumberBounds::closed(0.0, 1.0)), Some(1.0),
        "Each message of measurements is lost with this probability.";
    CommandLoss "command_loss", false, "", Some(NumberBounds::closed(0.0, 1.0)), Some(1.0),
        "Each command is lost, or late, with this probability; the drives keep the last one.";
    ControllerStop "controller_stop", false, "", None, Some(1.0),
        "The controller does not run: no update, no command.";
}

impl FaultKind {
    fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.word() == word)
    }
}

pub(crate) fn read(
    top: &Node<'_>,
    arm: &StudyArm,
    duration: f64,
) -> Result<Vec<Fault>, StudyError> {
    let faults = top.children("fault");
    top.source.found.each(faults.iter().map(|node| fault(node, arm, duration)))
}

fn fault(node: &Node<'_>, arm: &StudyArm, duration: f64) -> Result<Fault, StudyError> {
    let kind = FaultKind::named(node.word("kind")?).ok_or_else(|| node.missing("kind"))?;
    let start = node.number("start_s")?;
    if start >= duration {
        let message = format!("{start} s is not before the end of the run at {duration} s");
        return Err(node.error(Kind::Conflict, "start_s", message));
    }
    let joint = match node.text("joint") {
        Some(_) if !kind.per_joint() => {
            let message = format!("`{}` is about the whole arm, not about a joint", kind.word());
            return Err(node.error(Kind::Conflict, "joint", message));
        }
        Some(name) => Some(arm.joints.known(node, "joint", name)?),
        None => None,
    };
    let duration = node.number_if("duration_s").unwrap_or(f64::INFINITY);
    Ok(Fault { kind, start, duration, joint, size: size(node, kind)? })
}

fn size(node: &Node<'_>, kind: FaultKind) -> Result<f64, StudyError> {
    let word = kind.word();
    match (node.number_if("size"), kind.bounds()) {
        (Some(_), None) => {
            let message = format!("`{word}` has no size");
            Err(node.error(Kind::Conflict, "size", message))
        }
        (Some(size), Some(bounds))
            if !bounds.admit(size) || (bounds.integer && size.fract() != 0.0) =>
        {
            let unit = kind.unit();
            let what = if bounds.integer { "integer " } else { "" };
            let message = format!("{size}: `{word}` takes {what}{bounds} {unit}");
            Err(node.error(Kind::OutOfRange, "size", message.trim_end()))
        }
        (Some(size), _) => Ok(size),
        (None, _) => kind.default_size().ok_or_else(|| {
            node.missing("size").with_help(format!("`{word}` takes a size {}", kind.unit()))
        }),
    }
}
