//! A robot that lies in the bytes of its messages, over the sockets of the Franka Control Interface, in both
//! of its versions: every number, counter and byte of a state, once or for good, and states that are cut,
//! doubled or random. Wrong if a command that the robot reads were not finite, beyond a torque limit, or
//! farther from the command before than the rate limit allows in the samples between them; if the robot
//! stopped on a torque jump although its echo was true; if a joint without a valid position or velocity were
//! driven on; or if a drive did not end.
//!
//! `PHIHAT_MESSAGES=1000000` for as many states; `cargo xtask test --all` has them.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::support::served::Served;
use crate::support::{Dice, PANDA, names, study};
use phihat::{JointGains, Mode as Supervision};
use phihat_design::requested_gains;
use phihat_drive::{
    Desk, End, FrankaAddress, FrankaLink, Link as _, LinkFault, Order, Plan, Tally, cycles, ring,
};
use phihat_fci::{
    Ending, Heard, InterfaceMode, Protocol, Reflex, RobotCycle, RobotRules, RobotSide, World as _,
};
use phihat_sim::{Simulation, WorldSide};
use phihat_study::Study;

/// Samples of a drive, and the state from which on its lie is told.
const SAMPLES: u64 = 1000;
const FROM: u64 = 300;

/// States after which a drive has to be over: those of its samples, of the stop, and as many as the client waits for.
const MOST: u64 = 8000;

/// Time for which the robot waits for a command that may be missing; a required command is awaited this many
/// times as long, on a machine that does other work.
const CYCLE: Duration = Duration::from_millis(3);
const CYCLES: u32 = 10_000;

/// Time for which a client waits for a state, where lies may silence the robot.
const PATIENCE: Duration = Duration::from_millis(100);

/// A Panda that adds gravity and bears steps of 1 N·m, under a supervisor.
const REST: &str = r#"
[spec]
settle_s = 0.3
error_bound_rad = 0.5
[supervisor]
error_stop_rad = 0.5
brake_closing_s = 0.1
[reference]
kind = "sines"
center = "ready"
fade_in_s = 0.2
[[reference.sine]]
amplitude_rad = 0.05
frequency_hz = 0.5
"#;

/// Numbers that are none, too large, or almost right.
const WILD: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e6,
    -1e6,
    1e300,
    f64::MAX,
    80.0,
    -11.0,
    0.9,
    5e-324,
    1e-40,
    -0.0,
    0.0,
];

/// Layout of a state: bytes of a number, number of numbers, and offset of the tail (generator, controller, 41
/// errors, 41 reasons, mode, success rate).
fn layout(protocol: Protocol) -> (usize, usize, usize) {
    match protocol {
        Protocol::V5 => (8, 284, 2280),
        Protocol::V10 => (4, 320, 1288),
    }
}

/// Numbers that decide something: accepted torque, position and velocity of each joint.
const ECHO: core::ops::Range<usize> = 133..140;
const POSITION: core::ops::Range<usize> = 147..154;
const VELOCITY: core::ops::Range<usize> = 161..168;

/// Kind of a lie.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Lie {
    /// A number, the success rate last, says this.
    Number(usize, f64),
    /// A byte of the tail says this.
    Byte(usize, u8),
    /// The state's number says this.
    Id(u64),
    /// The state's number is that of so many states later, or before.
    Shifted(i64),
    /// So many bytes come; none, or more than there are, among them.
    Length(usize),
    /// The same state comes twice.
    Twice,
    /// All of it is random.
    Random,
    /// All numbers are random, their order and the tail are right.
    RandomNumbers,
}

impl Lie {
    /// Every lie, in another order for each round of all: one of each kind first, then every field with every value.
    fn all(protocol: Protocol, dice: &mut Dice) -> Vec<Self> {
        let (_, numbers, tail) = layout(protocol);
        let whole = protocol.state_bytes();
        let joint = dice.below(7);
        let ids = [0, 1, u64::MAX, u64::MAX - 1, 1 << 32, 1 << 63].map(Self::Id);
        let shifts = [-1, -2, -40, 1, 2, 30, 900, 1002].map(Self::Shifted);
        let lengths = [0, 8, tail, whole - 1, whole + 1, 2 * whole].map(Self::Length);
        let modes = (0..8).map(|mode| Self::Byte(84, mode));
        let wholes = [Self::Twice, Self::Random, Self::RandomNumbers];
        let blocks = [POSITION, VELOCITY, ECHO].map(|block| block.start + joint);
        let each = blocks.iter().flat_map(|place| WILD.map(|says| Self::Number(*place, says)));
        let mut first: Vec<_> =
            ids.into_iter().chain(shifts).chain(lengths).chain(wholes).chain(modes).collect();
        first.extend([0, 1, 3, 255].map(|says| Self::Byte(1, says)));
        first.extend(each);
        dice.shuffle(&mut first);
        // What decides nothing has one value in each round.
        let decides =
            |place: usize| [ECHO, POSITION, VELOCITY].iter().any(|block| block.contains(&place));
        let mut rest: Vec<_> = (0..=numbers)
            .flat_map(|place| {
                let one = WILD[dice.below(WILD.len())];
                let all = WILD.iter().copied().filter(|_| decides(place));
                all.chain([one]).map(move |says| Self::Number(place, says)).collect::<Vec<_>>()
            })
            .collect();
        let bytes = [0, 1, 84].iter().flat_map(|place| (0..=255).map(|says| (*place, says)));
        rest.extend(
            bytes
                .chain((2..84).map(|place| (place, 1)))
                .map(|(place, says)| Self::Byte(place, says)),
        );
        rest.extend((0..40).map(|_| Self::Length(dice.below(whole))));
        dice.shuffle(&mut rest);
        first.extend(rest);
        first
    }

    /// One that a drive survives.
    fn mild(dice: &mut Dice, protocol: Protocol) -> Self {
        let (_, numbers, _) = layout(protocol);
        let says = WILD[dice.below(WILD.len())];
        match dice.below(12) {
            0..3 => Self::Number(POSITION.start + dice.below(7), says),
            3 | 4 => Self::Number(VELOCITY.start + dice.below(7), says),
            5..8 => Self::Number(ECHO.start + dice.below(7), says),
            8 => Self::Number(dice.below(numbers + 1), says),
            9 => Self::Shifted([-1, -40, 1, 3][dice.below(4)]),
            10 => Self::Byte([0, 2 + dice.below(82)][dice.below(2)], dice.byte()),
            _ => Self::Twice,
        }
    }

    /// Returns true if it changes the reported accepted torques.
    fn touches_echo(self) -> bool {
        match self {
            Self::Number(place, _) => ECHO.contains(&place),
            // What it says of an older state was true then.
            Self::Shifted(_) | Self::Id(_) | Self::Random | Self::RandomNumbers => true,
            _ => false,
        }
    }

    /// Returns true if the client may leave this state or the next ones unanswered.
    fn silences(self) -> bool {
        match self {
            Self::Byte(place, _) => [0, 1, 84].contains(&place),
            Self::Id(_) | Self::Shifted(_) | Self::Length(_) | Self::Random => true,
            Self::Number(..) | Self::Twice | Self::RandomNumbers => false,
        }
    }

    /// Returns true if a joint has no valid position or velocity with it.
    fn blinds(self) -> bool {
        let Self::Number(place, says) = self else { return false };
        (POSITION.contains(&place) || VELOCITY.contains(&place))
            && (says.is_nan() || says.abs() > 1e5)
    }

    /// The state with the lie in it.
    fn told(self, protocol: Protocol, bytes: &mut Vec<u8>, dice: &mut Dice) {
        let (width, numbers, tail) = layout(protocol);
        let truth = u64::from_le_bytes(bytes[..8].try_into().unwrap());
        match self {
            Self::Number(place, says) => {
                let at = if place < numbers { 8 + width * place } else { tail + 85 };
                #[expect(clippy::cast_possible_truncation, reason = "as the wire has it")]
                match protocol {
                    Protocol::V5 => bytes[at..at + 8].copy_from_slice(&says.to_le_bytes()),
                    Protocol::V10 => {
                        bytes[at..at + 4].copy_from_slice(&(says as f32).to_le_bytes());
                    }
                }
            }
            Self::Byte(place, says) => bytes[tail + place] = says,
            Self::Id(says) => bytes[..8].copy_from_slice(&says.to_le_bytes()),
            Self::Shifted(by) => {
                let says = truth.saturating_add_signed(by);
                bytes[..8].copy_from_slice(&says.to_le_bytes());
            }
            Self::Length(length) => {
                let again = bytes.clone();
                bytes.extend_from_slice(&again);
                bytes.resize(length, 0x5a);
            }
            Self::Twice => {}
            Self::Random => bytes.iter_mut().for_each(|byte| *byte = dice.byte()),
            Self::RandomNumbers => bytes[8..tail].iter_mut().for_each(|byte| *byte = dice.byte()),
        }
    }
}

/// Record of the robot about one drive.
#[derive(Debug, Default)]
struct Seen {
    states: u64,
    commands: u64,
    /// True if a lie changed the echo.
    echo: bool,
    /// The largest torque that came \[N·m\].
    largest: f64,
    /// The lie that the drive is about, where it came so far.
    last: Option<Lie>,
    /// States and commands since it was told first.
    since: (u64, u64),
    ended: Option<Ending>,
}

/// Plan of the lies in a drive.
#[derive(Debug, Clone, Copy)]
struct Plot {
    lie: Lie,
    /// The state from which on it is told, and for how many.
    from: u64,
    states: u64,
    /// True if mild lies, which a drive survives, come before it.
    mild: bool,
}

/// The robot: honest in what it does, and a liar in what it says.
struct Robot {
    protocol: Protocol,
    side: RobotSide,
    world: Served,
    dice: Dice,
    plot: Plot,
    /// The lie and how many states more it is told.
    lie: Option<(Lie, u64)>,
    /// Limits of each joint \[N·m\], and the greatest step \[N·m\].
    most: Vec<f64>,
    step: f64,
    /// The last command that came, and the number of the state that it answers.
    sent: ([f64; 7], u64),
    /// True if a lie was sent that may silence the client, and no command came since.
    quiet: bool,
    seen: Seen,
}

impl Robot {
    /// The lie of this state, if it is none of the true ones: mild ones for a state or a few, then that of the drive.
    fn lies(&mut self) -> Option<Lie> {
        let Self { dice, protocol, seen, plot, .. } = self;
        if seen.states == plot.from {
            seen.last = Some(plot.lie);
            self.lie = Some((plot.lie, plot.states));
        } else if plot.mild && seen.states < plot.from && self.lie.is_none() {
            // The first states of a motion are where a torque is taken over.
            let begins = (3..12).contains(&seen.states);
            if dice.below(if begins { 3 } else { 25 }) == 0 {
                let states = [1, 1, 1, 2, 12][dice.below(5)];
                self.lie = Some((Lie::mild(dice, *protocol), states));
            }
        }
        let (lie, left) = self.lie.take()?;
        self.lie = (left > 1).then(|| (lie, left - 1));
        self.seen.echo |= lie.touches_echo();
        Some(lie)
    }

    /// Reads a command by the layout of the interface, and checks it.
    fn reads(&mut self, bytes: &[u8]) {
        assert_eq!(bytes.len(), self.protocol.command_bytes());
        let about = (self.lie, self.seen.last);
        let (sent, answered) = &mut self.sent;
        let id = u64::from_le_bytes(bytes[..8].try_into().unwrap());
        // Samples between both commands, in the numbers that this robot tells.
        let samples = id.saturating_sub(*answered).max(1) as f64;
        *answered = id;
        for (i, last) in sent.iter_mut().enumerate() {
            let at = 314 + 8 * i;
            let tau = f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
            let most = self.most[i];
            assert!(tau.is_finite() && tau.abs() <= most, "joint {i}: {tau} N·m at {about:?}");
            let step = (tau - *last).abs();
            assert!(
                step <= samples * self.step + 1e-9,
                "joint {i}: {last} to {tau} N·m at {about:?}"
            );
            *last = tau;
            self.seen.largest = self.seen.largest.max(tau.abs());
        }
        self.seen.commands += 1;
        self.seen.since.1 += u64::from(self.seen.last.is_some());
    }

    /// Serves one client until it goes away.
    fn serve(mut self, listener: &TcpListener, over: &AtomicBool) -> Seen {
        let (mut tcp, from) = listener.accept().unwrap();
        tcp.set_nonblocking(true).unwrap();
        let udp = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        udp.set_read_timeout(Some(CYCLE)).unwrap();
        let mut answers = Vec::new();
        while !over.load(Ordering::Relaxed) && self.requests(&mut tcp, &mut answers) {
            let Some((_, port)) = self.side.client() else {
                thread::sleep(Duration::from_micros(100));
                continue;
            };
            self.state(&udp, SocketAddr::new(from.ip(), port), &mut answers);
            let mut waited = 0;
            while !self.commanded(&udp) && self.awaits() && waited < CYCLES {
                waited += 1;
                let gone = over.load(Ordering::Relaxed) || !self.requests(&mut tcp, &mut answers);
                if gone {
                    break;
                }
            }
            self.close(&mut answers);
            let _ = tcp.write_all(&answers);
            answers.clear();
            assert!(self.seen.states < MOST, "no end: {:?}", self.seen);
        }
        self.seen
    }

    /// Answers what is asked; `false`: the client went away.
    fn requests(&mut self, tcp: &mut TcpStream, answers: &mut Vec<u8>) -> bool {
        let mut bytes = [0; 512];
        let length = match tcp.read(&mut bytes) {
            Ok(0) => return false,
            Ok(length) => length,
            Err(why) => return why.kind() == ErrorKind::WouldBlock,
        };
        let mut rest = &bytes[..length];
        while !rest.is_empty() {
            let taken = self.side.tcp(rest, answers);
            rest = &rest[taken.max(1)..];
        }
        let _ = tcp.write_all(answers);
        answers.clear();
        true
    }

    /// Sends a state, with a lie in it or none.
    fn state(&mut self, udp: &UdpSocket, client: SocketAddr, answers: &mut Vec<u8>) {
        let sensed = self.world.sensed();
        let lie = self.lies();
        let Some(state) = self.side.state(&sensed, answers) else { return };
        let mut bytes = state.to_vec();
        if let Some(lie) = lie {
            lie.told(self.protocol, &mut bytes, &mut self.dice);
        }
        for _ in 0..if lie == Some(Lie::Twice) { 2 } else { 1 } {
            let _ = udp.send_to(&bytes, client);
        }
        self.seen.states += 1;
        self.seen.since.0 += u64::from(self.seen.last.is_some());
        self.quiet |= lie.is_some_and(Lie::silences);
    }

    /// Returns true if this state has to be answered.
    fn awaits(&self) -> bool {
        let runs = match self.side.mode() {
            InterfaceMode::Moving => true,
            // The first state that shows a motion is not answered.
            InterfaceMode::Starting => self.side.unanswered() != Some(0),
            _ => false,
        };
        runs && !self.quiet
    }

    /// Waits a little for the command; returns true if it came.
    fn commanded(&mut self, udp: &UdpSocket) -> bool {
        let mut command = [0; 512];
        let Ok((length, _)) = udp.recv_from(&mut command) else { return false };
        self.reads(&command[..length]);
        self.quiet &= self.side.command(&command[..length]) != Heard::Taken;
        true
    }

    /// Moves the arm at the end of the cycle.
    fn close(&mut self, answers: &mut Vec<u8>) {
        match self.side.close(false, answers) {
            RobotCycle::Torque(tau) | RobotCycle::Finished(tau) | RobotCycle::Lost(tau) => {
                self.world.step(&tau);
            }
            RobotCycle::Still | RobotCycle::Reflex(_) => {}
        }
        if let Some(ending) = self.side.ended() {
            self.seen.ended = Some(ending);
        }
    }
}

/// Result of a drive.
struct Drive {
    /// `None`: it did not come to the first sample.
    tally: Option<Tally>,
    /// Samples in which the supervisor stopped the arm.
    stopped: u64,
    seen: Seen,
}

/// An arm and its gains, made once.
struct Arm {
    study: Study,
    law: Vec<JointGains<f64>>,
}

impl Arm {
    fn new(supervised: bool) -> Self {
        let rest = if supervised {
            REST.to_owned()
        } else {
            let (before, after) = REST.split_once("[supervisor]").unwrap();
            let (_, after) = after.split_once("[reference]").unwrap();
            format!("{before}[reference]{after}")
        };
        let study = study(&format!("duration_s = 3.0\nseed = 3\n{PANDA}{rest}"));
        let gains = requested_gains(&study).unwrap();
        let (period, form) = (study.control.period_ns, study.control.form);
        let law = gains.joint_gains(&names(&study), period, form).unwrap();
        Self { study, law }
    }

    fn robot(&self, protocol: Protocol, side: WorldSide, (plot, seed): (Plot, u64)) -> Robot {
        let limits: Vec<_> = (0..7).map(|i| self.study.limits(i)).collect();
        let rules = RobotRules {
            torque_step_max: Some(1.0),
            first_torque_max: Some(0.0),
            losses_max: Some(20),
            ..RobotRules::NONE
        };
        Robot {
            protocol,
            side: RobotSide::new(rules, String::new()),
            world: Served::of(side),
            dice: Dice(seed),
            plot,
            lie: None,
            most: limits.iter().map(|(torque, _)| torque.unwrap()).collect(),
            step: limits[0].1.unwrap() * 1e-3,
            sent: ([0.0; 7], 0),
            quiet: false,
            seen: Seen::default(),
        }
    }

    /// One drive, by the client that a Franka is driven with.
    fn driven(&self, protocol: Protocol, plot: (Plot, u64)) -> Drive {
        let (mut control, world) = Simulation::new(&self.study, &self.law).unwrap().apart();
        let patience =
            if plot.0.mild || plot.0.lie.silences() { PATIENCE } else { Duration::from_mins(1) };
        let robot = self.robot(protocol, world, plot);
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let host = listener.local_addr().unwrap().to_string();
        let over = AtomicBool::new(false);
        let address = FrankaAddress { host, protocol: Some(protocol), patience };
        let mut drives = || {
            let facts = FrankaLink::facts_of(&address).unwrap();
            let mut link = FrankaLink::connect(&address, facts, &self.study).ok()?;
            link.start().ok()?;
            let mut desk = Desk::new(Order::new(&names(&self.study), None, 7).unwrap(), 7);
            let (mut tape, mut reader) = ring(7, usize::try_from(SAMPLES).unwrap(), false);
            let plan = Plan {
                samples: SAMPLES,
                stop_samples: 1000,
                stop: &over,
                fault_samples: Some(500),
                targets: None,
                park: None,
            };
            let tally = cycles(&mut link, &mut control, &mut tape, &mut desk, &plan);
            drop(tape);
            let (mut rows, mut stopped) = (Vec::new(), 0);
            while let Some(cycle) = reader.next(&mut rows) {
                let stops = cycle.report.is_some_and(|r| r.mode == Supervision::SafeStop);
                stopped += u64::from(stops);
            }
            Some((tally, stopped))
        };
        let (driven, seen) = thread::scope(|scope| {
            let serving = scope.spawn(|| robot.serve(&listener, &over));
            let driven = drives();
            over.store(true, Ordering::Relaxed);
            (driven, serving.join().unwrap())
        });
        let (tally, stopped) = driven.map_or((None, 0), |(t, stopped)| (Some(t), stopped));
        Drive { tally, stopped, seen }
    }
}

/// A word for how a drive ended.
fn word(tally: Option<&Tally>) -> &'static str {
    match tally.map(|tally| tally.end) {
        None => "not begun",
        Some(End::Fault(LinkFault::Silent(_))) => "silent",
        Some(End::Fault(LinkFault::Garbled(_))) => "garbled",
        Some(End::Fault(LinkFault::Stopped(_))) => "stopped by the robot",
        Some(End::Fault(_)) => "another fault of the link",
        Some(end) => end.word(),
    }
}

#[test]
fn f33_whatever_the_bytes_of_a_robot_say_no_torque_beyond_a_limit_is_sent() {
    let all = if std::env::var_os("PHIHAT_ALL").is_some() { 1_000_000 } else { 30_000 };
    let all = std::env::var("PHIHAT_MESSAGES").map_or(all, |n| n.parse().unwrap());
    let arms = [Arm::new(true), Arm::new(false)];
    let mut lies = Protocol::ALL.map(|_| Vec::new().into_iter());
    let (mut states, mut commands, mut round) = (0, 0, 0_u64);
    let (mut ends, mut jumps) = (BTreeMap::new(), 0);
    while states < all {
        let which = usize::from(round % 2 == 1);
        let (protocol, mut dice) = (Protocol::ALL[which], Dice(round));
        let lie = lies[which].next().unwrap_or_else(|| {
            lies[which] = Lie::all(protocol, &mut dice).into_iter();
            Lie::Twice
        });
        // For good, or once, with a supervisor; and without one.
        let (supervised, once) = (round % 6 < 4, dice.below(4) == 0);
        let plot = Plot { lie, from: FROM, states: if once { 1 } else { u64::MAX }, mild: true };
        let arm = &arms[usize::from(!supervised)];
        let Drive { tally, stopped, seen } = arm.driven(protocol, (plot, round));
        let context = || format!("round {round}, {protocol:?}: {tally:?}, {seen:?}, {plot:?}");
        // A robot that stops on a torque that jumps was told one that its own echo does not explain.
        let jumped = seen.ended == Some(Ending::Reflex(Reflex::TorqueJump));
        assert!(!jumped || seen.echo, "{}", context());
        jumps += u32::from(jumped);
        if supervised && !once && lie.blinds() && seen.last.is_some() && tally.is_some() {
            let ended = tally.is_some_and(|tally| tally.end != End::Complete);
            // Twenty samples that are none stop the arm, and half a second later the drive ends.
            let before = seen.since.1.saturating_sub(stopped);
            assert!(ended && before < 40 && seen.since.1 < 600, "driven on: {}", context());
        }
        *ends.entry(word(tally.as_ref())).or_insert(0) += 1;
        *ends.entry("stopped by the supervisor").or_insert(0) += u32::from(stopped > 0);
        (states, commands, round) = (states + seen.states, commands + seen.commands, round + 1);
    }
    println!("{states} states, {commands} commands, {round} drives, {jumps} jumps: {ends:?}");
    for must in ["complete", "faulted", "garbled", "silent", "stopped by the supervisor"] {
        assert!(ends.get(must).is_some_and(|count| *count > 0), "no drive ended so: {must}");
    }
}

/// A wrong torque that the robot reports once at the start of a motion: no command follows it.
#[test]
fn a_first_echo_that_lies_moves_no_torque() {
    let arm = Arm::new(true);
    let driven = |from, says| {
        let plot = Plot { lie: Lie::Number(ECHO.start + 1, says), from, states: 1, mild: false };
        let Drive { tally, seen, .. } = arm.driven(Protocol::V5, (plot, 0));
        assert_eq!(tally.map(|tally| tally.end), Some(End::Complete), "{seen:?}");
        seen.largest
    };
    let honest = driven(u64::MAX, 0.0);
    for from in 0..12 {
        let told = driven(from, 80.0);
        assert!(told < honest + 2.0, "state {from}: {told} N·m, {honest} N·m without the lie");
    }
}

/// The greatest number that there is, where a motion begins: there is none after it, and the drive ends.
#[test]
fn a_number_without_a_next_one_ends_the_drive() {
    let arm = Arm::new(true);
    for from in 0..12 {
        let plot = Plot { lie: Lie::Id(u64::MAX), from, states: 1, mild: false };
        let Drive { tally, seen, .. } = arm.driven(Protocol::V10, (plot, 0));
        let ended = tally.is_none_or(|tally| matches!(tally.end, End::Fault(LinkFault::Silent(_))));
        assert!(ended, "state {from}: {tally:?}, {seen:?}");
    }
}
