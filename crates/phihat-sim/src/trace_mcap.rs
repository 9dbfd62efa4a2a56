//! The trace as a log for ROS tools and viewers: MCAP, with the messages that they know.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};

use mcap::records::MessageHeader;
use mcap::{Attachment, McapError, WriteOptions, Writer};

use crate::trace::{JointTrace, Trace};

/// A trace that is written as MCAP as it comes: ROS 2 messages (`ros2msg`, CDR), one per sample and topic, at
/// the sample's time since the start of the run.
///
/// | topic | message | position | velocity | effort |
/// |---|---|---|---|---|
/// | `/joint_states` | `sensor_msgs/msg/JointState` | measured q | measured q̇ | torque that acted |
/// | `/phihat/reference` | the same | q_d | q̇_d | – |
/// | `/phihat/error` | the same | e | ė | – |
/// | `/phihat/torque_command` | the same | – | – | commanded torque |
/// | `/phihat/phi` | the same | – | – | φ |
/// | `/phihat/phi_hat` | the same | – | – | φ̂ |
/// | `/phihat/error_share`, where there is a bound | the same | measured error as a share of its bound | – | – |
/// | `/phihat/mode` | `std_msgs/msg/String` | the supervisor's mode | | |
/// | `/phihat/events` | the same, where something happened | its events, and what stopped the arm | | |
///
/// Radians, metres for joints that slide, newton metres; every number with all its bits.
#[expect(missing_debug_implementations, reason = "the package's writer has none")]
pub struct McapTrace<W: Write> {
    file: Writer<Forward<W>>,
    joints: [u16; 6],
    share: u16,
    mode: u16,
    events: u16,
    sequence: u32,
    message: Vec<u8>,
}

/// The six messages about joints: topic, and what stands for position, velocity and effort.
type MessageSignal = fn(&JointTrace) -> &Vec<f64>;
const TOPICS: [(&str, [Option<MessageSignal>; 3]); 6] = [
    (
        "/joint_states",
        [Some(|j| &j.q_measured), Some(|j| &j.dq_measured), Some(|j| &j.tau_applied)],
    ),
    ("/phihat/reference", [Some(|j| &j.q_desired), Some(|j| &j.dq_desired), None]),
    ("/phihat/error", [Some(|j| &j.e), Some(|j| &j.de), None]),
    ("/phihat/torque_command", [None, None, Some(|j| &j.tau_command)]),
    ("/phihat/phi", [None, None, Some(|j| &j.phi)]),
    ("/phihat/phi_hat", [None, None, Some(|j| &j.phi_hat)]),
];

/// The message about the share of a bound.
const SHARE: [Option<MessageSignal>; 3] = [Some(|j| &j.error_share), None, None];

/// `sensor_msgs/msg/JointState` with what it is made of, as ROS 2 writes definitions into logs.
const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

impl<W: Write> McapTrace<W> {
    /// A writer before its first block.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn new(writer: W) -> Result<Self, McapError> {
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("phihat ", env!("CARGO_PKG_VERSION")))
            .compression(None)
            .disable_seeking(true);
        let mut file = options.create(Forward { writer, at: 0 })?;
        let state =
            file.add_schema("sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.as_bytes())?;
        let text = file.add_schema("std_msgs/msg/String", "ros2msg", b"string data\n")?;
        // Players of ROS 2 look for it; nothing is said of the quality of service.
        let none = BTreeMap::from([("offered_qos_profiles".to_owned(), String::new())]);
        let mut joints = [0; 6];
        for (channel, (topic, _)) in joints.iter_mut().zip(&TOPICS) {
            *channel = file.add_channel(state, topic, "cdr", &none)?;
        }
        let share = file.add_channel(state, "/phihat/error_share", "cdr", &none)?;
        let mode = file.add_channel(text, "/phihat/mode", "cdr", &none)?;
        let events = file.add_channel(text, "/phihat/events", "cdr", &none)?;
        Ok(Self { file, joints, share, mode, events, sequence: 0, message: Vec::new() })
    }

    /// Puts a document into the log.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) -> Result<(), McapError> {
        self.file.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(data),
        })
    }

    /// Writes the next samples.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn block(&mut self, trace: &Trace) -> Result<(), McapError> {
        for k in 0..trace.len() {
            let t_ns = trace.t_ns[k];
            for (channel, (_, signals)) in self.joints.into_iter().zip(&TOPICS) {
                joint_state(&mut self.message, trace, (k, t_ns), signals);
                self.write(channel, t_ns)?;
            }
            if trace.is_bounded() {
                joint_state(&mut self.message, trace, (k, t_ns), &SHARE);
                self.write(self.share, t_ns)?;
            }
            if let Some(supervision) = &trace.supervision {
                text(&mut self.message, supervision.mode[k].name());
                self.write(self.mode, t_ns)?;
                let mut words: Vec<&str> = supervision.events[k].names().collect();
                words.extend(supervision.fault[k].map(phihat::Fault::name));
                if !words.is_empty() {
                    text(&mut self.message, &words.join(" "));
                    self.write(self.events, t_ns)?;
                }
            }
            self.sequence = self.sequence.wrapping_add(1);
        }
        Ok(())
    }

    fn write(&mut self, channel_id: u16, t_ns: u64) -> Result<(), McapError> {
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time: t_ns,
            publish_time: t_ns,
        };
        self.file.write_to_known_channel(&header, &self.message)
    }

    /// Closes the file; the writer, back.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn finish(mut self) -> Result<W, McapError> {
        self.file.finish()?;
        Ok(self.file.into_inner().writer)
    }
}

/// A message of XCDR1, little-endian: numbers stand at multiples of their size, counted from behind its head.
struct Cdr<'a>(&'a mut Vec<u8>);

const HEAD: [u8; 4] = [0, 1, 0, 0];

impl<'a> Cdr<'a> {
    fn new(message: &'a mut Vec<u8>) -> Self {
        message.clear();
        message.extend(HEAD);
        Self(message)
    }

    fn align(&mut self, size: usize) {
        while !(self.0.len() - HEAD.len()).is_multiple_of(size) {
            self.0.push(0);
        }
    }

    fn count(&mut self, count: usize) {
        self.align(4);
        // A message of 4 GiB is none.
        self.0.extend(u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes());
    }

    /// With the zero byte that ends it.
    fn string(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.0.extend(text.bytes().chain([0]));
    }

    fn numbers(&mut self, count: usize, values: impl Iterator<Item = f64>) {
        self.count(count);
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
    }
}

fn text(message: &mut Vec<u8>, words: &str) {
    Cdr::new(message).string(words);
}

fn joint_state(
    message: &mut Vec<u8>,
    trace: &Trace,
    (k, t_ns): (usize, u64),
    signals: &[Option<MessageSignal>; 3],
) {
    let mut cdr = Cdr::new(message);
    let seconds = i32::try_from(t_ns / 1_000_000_000).unwrap_or(i32::MAX);
    let rest = u32::try_from(t_ns % 1_000_000_000).unwrap_or(0);
    cdr.0.extend(seconds.to_le_bytes());
    cdr.0.extend(rest.to_le_bytes());
    cdr.string("");
    cdr.count(trace.joints.len());
    for joint in &trace.joints {
        cdr.string(&joint.name);
    }
    for signal in signals {
        match signal {
            None => cdr.count(0),
            Some(signal) => {
                let values = trace.joints.iter().map(|joint| signal(joint)[k]);
                cdr.numbers(trace.joints.len(), values);
            }
        }
    }
}

/// A writer that knows where it is and goes nowhere else.
struct Forward<W> {
    writer: W,
    at: u64,
}

impl<W: Write> Write for Forward<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.writer.write(bytes)?;
        self.at += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl<W> Seek for Forward<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.at),
            SeekFrom::Start(at) if at == self.at => Ok(self.at),
            _ => Err(io::Error::new(ErrorKind::Unsupported, "a log is written in one go")),
        }
    }
}
