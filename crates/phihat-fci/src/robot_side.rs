//! The robot's side of the wire: bytes in, bytes out.

use core::fmt;

use crate::command::RobotCommand;
use crate::fault::{Faults, Reflex};
use crate::numbers::at;
use crate::protocol::{JOINTS, Protocol};
use crate::request::{
    ClientRequest, HEADER, MOTION_STARTED, MoveStatus, NOT_POSSIBLE, PREEMPTED, REQUEST_MOST,
    RequestHeader, SUCCESS, asked, header_of, number,
};
use crate::state::{EXTERNAL, NO_CONTROLLER, RobotMode, Said, StateBytes, StateSensed};

/// States at the start of a motion that need no answer: libfranka looks at one, to see the motion run, before
/// its loop begins.
const UNANSWERED: u32 = 2;

/// Slack of a rule on torque \[relative\]: what rounding leaves.
const ROUNDING: f64 = 1e-9;

/// Slack that the echo's single precision needs in protocol 10 \[relative\].
const SINGLE: f64 = 1.2e-7;

/// On what the robot stops by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotRules {
    /// Change of a torque from one command to the next \[N·m\].
    pub torque_step_max: Option<f64>,
    /// First torque of a motion \[N·m\].
    pub first_torque_max: Option<f64>,
    /// Speed of each joint \[rad/s\]; infinite where there is no limit.
    pub velocity_max: [f64; JOINTS],
    /// Cycles in a row without a command.
    pub losses_max: Option<u32>,
}

impl RobotRules {
    /// The robot stops on nothing but torques that are no numbers.
    pub const NONE: Self = Self {
        torque_step_max: None,
        first_torque_max: None,
        velocity_max: [f64::INFINITY; JOINTS],
        losses_max: None,
    };
}

/// The mode that the robot's side is in. There is no other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InterfaceMode {
    /// Nobody is connected.
    Closed,
    /// Connected, no motion.
    Idle,
    /// A motion was requested, its first command is awaited; the world stands.
    Starting,
    /// Commands act.
    Moving,
    /// Stopped by itself; only recovery leads out, for this client or the next.
    Reflex,
}

/// Why a connection was ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HangUp {
    /// A request that there is not, one of another size than it has, or one before the connection is agreed on.
    Request {
        /// Its number.
        command: u32,
        /// The size that it claims.
        size: u32,
    },
    /// A version of the interface that is not spoken here.
    Version(u16),
}

impl fmt::Display for HangUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Request { command, size } => {
                write!(f, "a request {command} of {size} bytes, which there is not")
            }
            Self::Version(version) => {
                write!(f, "version {version} of the interface; spoken are 5 and 10")
            }
        }
    }
}

/// Use of a packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heard {
    /// It is the command of this cycle.
    Taken,
    /// It does not answer the newest state: left out.
    Late,
    /// This cycle has its command already: left out.
    Twice,
    /// It is no command: left out.
    Malformed,
    /// There is no motion: left out.
    Unasked,
}

/// Result of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RobotCycle {
    /// No motion, or none that has begun: the world stands.
    Still,
    /// These torques act \[N·m\].
    Torque([f64; JOINTS]),
    /// These act, and the motion ends with them.
    Finished([f64; JOINTS]),
    /// No command came; the last accepted torques go on.
    Lost([f64; JOINTS]),
    /// The robot stopped; nothing of this cycle acts.
    Reflex(Reflex),
}

/// End of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The client finished it.
    Finished,
    /// The client stopped it.
    Stopped,
    /// The robot stopped.
    Reflex(Reflex),
    /// The connection ended while it ran.
    Disconnected,
    /// The world has come to its end.
    Over,
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finished => f.write_str("finished by the client"),
            Self::Stopped => f.write_str("stopped by the client"),
            Self::Reflex(reflex) => write!(f, "reflex: {}", reflex.name()),
            Self::Disconnected => f.write_str("the client went away"),
            Self::Over => f.write_str("the end of the study"),
        }
    }
}

/// Numbers of packets, by their use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Packets {
    /// Those that acted.
    pub taken: u64,
    /// Those that answered an older state.
    pub late: u64,
    /// Second ones of a cycle.
    pub twice: u64,
    /// Those that are no commands.
    pub malformed: u64,
    /// Those outside of a motion.
    pub unasked: u64,
    /// Cycles of a motion without a command.
    pub lost: u64,
}

/// A motion that was requested.
#[derive(Debug, Clone, Copy)]
struct RequestedMotion {
    /// Number of its request.
    id: u32,
    /// As states show it.
    generator: u8,
    /// States that nobody answered yet; `None`: its first command came.
    unanswered: Option<u32>,
    /// True if a state has shown it: before, there is nothing to answer.
    shown: bool,
}

/// The robot's side of the interface, without sockets, clock or world.
///
/// # Cycle
///
/// [`state`](Self::state) gives the bytes of the next state; [`command`](Self::command) takes packets;
/// [`close`](Self::close) gives the result of the cycle. [`tcp`](Self::tcp) takes the stream's bytes between
/// cycles. Answers go into the buffer that the caller passes: a motion ends with one that nobody requests.
/// Nothing in a cycle allocates but what that buffer has no room for.
///
/// # Guarantee
///
/// Whatever bytes come, nothing panics, the stored data do not grow, and [`mode`](Self::mode) is one of five.
#[derive(Debug)]
pub struct RobotSide {
    rules: RobotRules,
    /// URDF that protocol 10 hands out.
    model: String,
    connection: Option<Connection>,
    hung_up: Option<HangUp>,
    /// A request whose end has not come.
    begun: [u8; REQUEST_MOST],
    begun_bytes: usize,
    id: u64,
    motion: Option<RequestedMotion>,
    /// True if it takes no motion any more.
    retired: bool,
    ended: Option<Ending>,
    errors: Faults,
    reflex_reason: Faults,
    fresh: Option<RobotCommand>,
    accepted: [f64; JOINTS],
    losses: u32,
    /// One bit per cycle, the newest the lowest: 1 if it had a command.
    heard: u128,
    packets: Packets,
}

#[derive(Debug)]
struct Connection {
    protocol: Protocol,
    udp_port: u16,
    state: StateBytes,
}

/// Cycles that the success rate is about.
const WINDOW: u32 = 100;

impl RobotSide {
    /// A robot that nobody is connected to. `model` is the URDF that it hands out.
    #[must_use]
    pub fn new(rules: RobotRules, model: String) -> Self {
        Self {
            rules,
            model,
            connection: None,
            hung_up: None,
            begun: [0; REQUEST_MOST],
            begun_bytes: 0,
            id: 0,
            motion: None,
            retired: false,
            ended: None,
            errors: Faults::default(),
            reflex_reason: Faults::default(),
            fresh: None,
            accepted: [0.0; JOINTS],
            losses: 0,
            heard: 0,
            packets: Packets::default(),
        }
    }

    /// The mode it is in.
    #[must_use]
    pub fn mode(&self) -> InterfaceMode {
        match (&self.connection, self.motion) {
            (None, _) => InterfaceMode::Closed,
            (Some(_), Some(RequestedMotion { unanswered: Some(_), .. })) => InterfaceMode::Starting,
            (Some(_), Some(_)) => InterfaceMode::Moving,
            (Some(_), None) if !self.errors.is_empty() => InterfaceMode::Reflex,
            (Some(_), None) => InterfaceMode::Idle,
        }
    }

    /// Version and UDP port of the client, once they are agreed on.
    #[must_use]
    pub fn client(&self) -> Option<(Protocol, u16)> {
        self.connection.as_ref().map(|c| (c.protocol, c.udp_port))
    }

    /// Number of the newest state.
    #[must_use]
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Why the connection is to be ended, if it is.
    #[must_use]
    pub fn hung_up(&self) -> Option<HangUp> {
        self.hung_up
    }

    /// Numbers of the packets so far, by their use.
    #[must_use]
    pub fn packets(&self) -> Packets {
        self.packets
    }

    /// Faults of its last stop.
    #[must_use]
    pub fn reflex_reason(&self) -> Faults {
        self.reflex_reason
    }

    /// End of a motion since the last call, if one ended.
    pub fn ended(&mut self) -> Option<Ending> {
        self.ended.take()
    }

    /// Number of states at the start of a motion that are not answered yet; `None`: no motion starts.
    #[must_use]
    pub fn unanswered(&self) -> Option<u32> {
        self.motion.and_then(|motion| motion.unanswered)
    }

    /// From here on, it takes no motion.
    pub fn retire(&mut self) {
        self.retired = true;
    }

    /// The client went away: a motion ends as one whose commands stopped coming.
    pub fn disconnected(&mut self) {
        if self.motion.take().is_some() {
            self.ended = Some(Ending::Disconnected);
            self.fail(Reflex::Communication);
        }
        self.connection = None;
        self.hung_up = None;
        self.begun_bytes = 0;
        self.fresh = None;
    }

    /// Takes bytes of the stream, up to the end of one request; its answer is put behind `answers`. Returns
    /// the number of bytes taken: all of them after a hang-up.
    pub fn tcp(&mut self, bytes: &[u8], answers: &mut Vec<u8>) -> usize {
        if self.hung_up.is_some() {
            return bytes.len();
        }
        let mut taken = 0;
        let mut whole = if self.begun_bytes < HEADER { HEADER } else { self.size_of_begun() };
        while self.begun_bytes < whole {
            let Some(byte) = bytes.get(taken) else { return taken };
            let Some(room) = self.begun.get_mut(self.begun_bytes) else { return taken };
            *room = *byte;
            taken += 1;
            self.begun_bytes += 1;
            if self.begun_bytes == HEADER {
                whole = self.size_of_begun();
            }
        }
        if self.hung_up.is_none() {
            self.answer(answers);
        }
        self.begun_bytes = 0;
        taken
    }

    /// The size of the request whose header is there; one that there is not ends the connection.
    fn size_of_begun(&mut self) -> usize {
        let protocol = self.connection.as_ref().map(|c| c.protocol);
        let Some(header) = RequestHeader::read(&self.begun) else { return HEADER };
        if let Some((_, size)) = asked(protocol, header) {
            return size;
        }
        self.hung_up = Some(HangUp::Request { command: header.command, size: header.size });
        HEADER
    }

    /// Answers the request that is whole.
    fn answer(&mut self, answers: &mut Vec<u8>) {
        let protocol = self.connection.as_ref().map(|c| c.protocol);
        let Some(header) = RequestHeader::read(&self.begun) else { return };
        let Some((request, _)) = asked(protocol, header) else { return };
        let still = self.motion.is_none();
        let status = match request {
            ClientRequest::Connect => return self.connect(header, answers),
            ClientRequest::Move => return self.start(header, answers),
            ClientRequest::StopMove => {
                self.end(Ending::Stopped, PREEMPTED, answers);
                SUCCESS
            }
            ClientRequest::Recovery if still => {
                self.errors = Faults::default();
                SUCCESS
            }
            ClientRequest::Setting | ClientRequest::Model if still => SUCCESS,
            _ => NOT_POSSIBLE,
        };
        let limit = [0; 153];
        let more: &[u8] = match request {
            ClientRequest::Model if still => self.model.as_bytes(),
            ClientRequest::CartesianLimit => &limit,
            _ => &[],
        };
        reply(header, status, more, answers);
    }

    fn connect(&mut self, header: RequestHeader, answers: &mut Vec<u8>) {
        let word = |place| at(&self.begun, place).map_or(0, u16::from_le_bytes);
        let (version, udp_port) = (word(HEADER), word(HEADER + 2));
        let again = self.connection.is_some() || udp_port == 0;
        match Protocol::of_version(version) {
            _ if again => {
                let (command, size) = (header.command, header.size);
                self.hung_up = Some(HangUp::Request { command, size });
            }
            None => {
                reply(header, 1, &Protocol::V10.version().to_le_bytes(), answers);
                self.hung_up = Some(HangUp::Version(version));
            }
            Some(protocol) => {
                let state = StateBytes::new(protocol);
                self.connection = Some(Connection { protocol, udp_port, state });
                reply(header, SUCCESS, &version.to_le_bytes(), answers);
            }
        }
    }

    /// Begins a motion that is commanded by torques; any other is refused.
    fn start(&mut self, header: RequestHeader, answers: &mut Vec<u8>) {
        let Some((protocol, _)) = self.client() else { return };
        let word = |place| at(&self.begun, place).map_or(u32::MAX, u32::from_le_bytes);
        let (controller, generator) = (word(HEADER), word(HEADER + 4));
        let generators = if protocol == Protocol::V5 { 0..=3 } else { 0..=4 };
        let possible = controller == u32::from(EXTERNAL) && generators.contains(&generator);
        let free = self.motion.is_none() && self.errors.is_empty() && !self.retired;
        let generator = u8::try_from(generator).ok().filter(|_| possible && free);
        let Some(generator) = generator else {
            return reply(header, protocol.status(MoveStatus::NotPossible), &[], answers);
        };
        let (id, generator) = (header.id, generator + 1);
        self.motion = Some(RequestedMotion { id, generator, unanswered: Some(0), shown: false });
        self.reflex_reason = Faults::default();
        self.losses = 0;
        self.heard = u128::MAX;
        reply(header, MOTION_STARTED, &[], answers);
    }

    /// Ends a motion, if there is one, with the second answer to its request.
    fn end(&mut self, ending: Ending, status: u8, answers: &mut Vec<u8>) {
        let (Some(motion), Some((protocol, _))) = (self.motion.take(), self.client()) else {
            return;
        };
        self.ended = Some(ending);
        self.fresh = None;
        reply(header_of(protocol, ClientRequest::Move, motion.id), status, &[], answers);
    }

    /// Ends a motion whose world has come to its end.
    pub fn over(&mut self, answers: &mut Vec<u8>) {
        self.end(Ending::Over, PREEMPTED, answers);
    }

    fn fail(&mut self, reflex: Reflex) {
        self.errors = Faults::of(reflex);
        self.reflex_reason = Faults::of(reflex);
    }

    fn reflex(&mut self, reflex: Reflex, answers: &mut Vec<u8>) -> RobotCycle {
        if let Some((protocol, _)) = self.client() {
            self.end(Ending::Reflex(reflex), protocol.status(MoveStatus::Reflex), answers);
        }
        self.fail(reflex);
        RobotCycle::Reflex(reflex)
    }

    /// The next state; `None` where nobody is connected. A joint that is too fast stops the robot here, and
    /// the state says so.
    pub fn state(&mut self, sensed: &StateSensed, answers: &mut Vec<u8>) -> Option<&[u8]> {
        self.id = self.id.wrapping_add(1);
        self.fresh = None;
        if self.mode() == InterfaceMode::Starting {
            self.accepted = sensed.tau_j_d;
        }
        let too_fast = |(dq, most): (&f64, &f64)| dq.is_nan() || dq.abs() > *most;
        let moves = self.mode() == InterfaceMode::Moving;
        if moves && sensed.dq.iter().zip(&self.rules.velocity_max).any(too_fast) {
            self.reflex(Reflex::Velocity, answers);
        }
        if let Some(motion) = &mut self.motion {
            motion.shown = true;
        }
        let said = self.said();
        self.connection.as_mut().map(|connection| connection.state.fill(sensed, &said))
    }

    fn said(&self) -> Said {
        let (generator, controller, mode) = match self.motion {
            Some(motion) => (motion.generator, EXTERNAL, RobotMode::Move),
            None if self.errors.is_empty() => (0, NO_CONTROLLER, RobotMode::Idle),
            None => (0, NO_CONTROLLER, RobotMode::Reflex),
        };
        let heard = (self.heard & ((1 << WINDOW) - 1)).count_ones();
        Said {
            id: self.id,
            generator,
            controller,
            mode,
            errors: self.errors,
            reflex_reason: self.reflex_reason,
            success_rate: if self.motion.is_some() {
                f64::from(heard) / f64::from(WINDOW)
            } else {
                0.0
            },
        }
    }

    /// Takes a packet; says what became of it.
    pub fn command(&mut self, bytes: &[u8]) -> Heard {
        let heard = self.heard_as(bytes);
        let count = match heard {
            Heard::Taken => &mut self.packets.taken,
            Heard::Late => &mut self.packets.late,
            Heard::Twice => &mut self.packets.twice,
            Heard::Malformed => &mut self.packets.malformed,
            Heard::Unasked => &mut self.packets.unasked,
        };
        *count = count.wrapping_add(1);
        heard
    }

    fn heard_as(&mut self, bytes: &[u8]) -> Heard {
        let Some((protocol, _)) = self.client() else { return Heard::Unasked };
        let Some(command) = RobotCommand::parse(protocol, bytes) else { return Heard::Malformed };
        if self.motion.is_none_or(|motion| !motion.shown) {
            return Heard::Unasked;
        }
        if command.id != self.id {
            return Heard::Late;
        }
        if self.fresh.is_some() {
            return Heard::Twice;
        }
        self.fresh = Some(command);
        Heard::Taken
    }

    /// Closes the cycle. `lost`: the command, if one came, is taken for lost on its way.
    pub fn close(&mut self, lost: bool, answers: &mut Vec<u8>) -> RobotCycle {
        let fresh = self.fresh.take().filter(|_| !lost);
        let Some(motion) = self.motion.as_mut().filter(|motion| motion.shown) else {
            return RobotCycle::Still;
        };
        let Some(command) = fresh else {
            let mut counts = true;
            if let Some(unanswered) = &mut motion.unanswered {
                *unanswered = unanswered.saturating_add(1);
                counts = *unanswered > UNANSWERED;
            }
            let starts = motion.unanswered.is_some();
            return self.missed(counts, starts, answers);
        };
        let first = motion.unanswered.take().is_some();
        if !self.bears(&command, first) {
            return self.reflex(Reflex::TorqueJump, answers);
        }
        self.losses = 0;
        self.heard = self.heard << 1 | 1;
        self.accepted = command.tau;
        if command.finished {
            self.end(Ending::Finished, SUCCESS, answers);
            return RobotCycle::Finished(command.tau);
        }
        RobotCycle::Torque(command.tau)
    }

    /// A cycle of a motion without a command.
    fn missed(&mut self, counts: bool, starts: bool, answers: &mut Vec<u8>) -> RobotCycle {
        if counts {
            self.packets.lost = self.packets.lost.wrapping_add(1);
            self.losses = self.losses.saturating_add(1);
            self.heard <<= 1;
            if self.rules.losses_max.is_some_and(|most| self.losses >= most) {
                return self.reflex(Reflex::Communication, answers);
            }
        }
        if starts { RobotCycle::Still } else { RobotCycle::Lost(self.accepted) }
    }

    /// Returns true if the rules allow a command.
    fn bears(&self, command: &RobotCommand, first: bool) -> bool {
        let single = match self.client() {
            Some((Protocol::V10, _)) => SINGLE,
            _ => 0.0,
        };
        command.tau.iter().zip(&self.accepted).all(|(tau, accepted)| {
            let step = (tau - accepted).abs();
            let within = |most: f64| step <= most * (1.0 + ROUNDING) + single * accepted.abs();
            tau.is_finite()
                && self.rules.torque_step_max.is_none_or(within)
                && (!first || self.rules.first_torque_max.is_none_or(|most| tau.abs() <= most))
        })
    }
}

/// An answer: header, status, and more.
fn reply(header: RequestHeader, status: u8, more: &[u8], answers: &mut Vec<u8>) {
    let size = number(HEADER + 1 + more.len());
    answers.extend_from_slice(&RequestHeader { size, ..header }.bytes());
    answers.push(status);
    answers.extend_from_slice(more);
}
