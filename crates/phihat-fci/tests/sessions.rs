//! A thousand random sessions: requests whole, cut, repeated and spoilt; commands lost, late, twice, cut,
//! spoilt; connections that end anywhere. Wrong if a mode followed another that the table of
//! docs/reliability.md does not have, if a torque acted that no command of that cycle had or that the rules
//! do not bear, if an answer were no answer, or if recovery did not lead to a motion again.

use std::collections::BTreeMap;

use crate::support::{connect, recovery, request, start, stop};
use phihat_fci::{
    Heard, InterfaceMode, Protocol, Reflex, RobotCommand, RobotCycle, RobotRules, RobotSide,
    StateSensed,
};

const RULES: RobotRules = RobotRules {
    torque_step_max: Some(1.0),
    first_torque_max: Some(0.5),
    velocity_max: [2.0; 7],
    losses_max: Some(5),
};

/// Numbers as a linear congruence has them.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn below(&mut self, most: u64) -> u64 {
        self.next() % most
    }

    fn bytes(&mut self, most: u64) -> Vec<u8> {
        (0..self.below(most)).map(|_| u8::try_from(self.below(256)).unwrap()).collect()
    }

    /// The same, whole, cut, or with a byte changed; whether it is whole.
    fn spoilt(&mut self, mut bytes: Vec<u8>) -> (Vec<u8>, bool) {
        if bytes.is_empty() {
            return (bytes, false);
        }
        match self.below(4) {
            0 => {
                let length = usize::try_from(self.below(bytes.len() as u64)).unwrap();
                bytes.truncate(length);
                (bytes, false)
            }
            1 => {
                let at = usize::try_from(self.below(bytes.len() as u64)).unwrap();
                bytes[at] ^= 1 << self.below(8);
                (bytes, false)
            }
            _ => (bytes, true),
        }
    }
}

/// State of a session so far.
struct Session {
    robot: RobotSide,
    answers: Vec<u8>,
    protocol: Protocol,
    /// The last torques that acted.
    acted: [f64; 7],
    /// Packets sent before, to be sent again.
    before: Vec<Vec<u8>>,
    speed: f64,
    seen: BTreeMap<String, u64>,
}

/// Modes that may follow another in one step, by what the step is.
fn may(step: &str, from: InterfaceMode, to: InterfaceMode) -> bool {
    use InterfaceMode::{Closed, Idle, Moving, Reflex, Starting};
    match (step, from, to) {
        _ if from == to => true,
        ("stream", Closed, Idle | Reflex | Starting)
        | ("stream", Idle | Reflex, Starting)
        | ("stream", Starting | Moving, Idle | Starting)
        | ("stream", Reflex, Idle)
        | ("state", Moving, Reflex)
        | ("close", Starting, Moving | Idle | Reflex)
        | ("close", Moving, Idle | Reflex)
        | ("disconnect", _, Closed) => true,
        _ => false,
    }
}

impl Session {
    fn note(&mut self, what: &str, step: &str, from: InterfaceMode) {
        let to = self.robot.mode();
        assert!(may(step, from, to), "{what}: {step} led from {from:?} to {to:?}");
        *self.seen.entry(format!("{what} in {from:?} → {to:?}")).or_default() += 1;
    }

    fn stream(&mut self, what: &str, bytes: &[u8]) {
        let from = self.robot.mode();
        let mut rest = bytes;
        while !rest.is_empty() {
            let taken = self.robot.tcp(rest, &mut self.answers);
            assert!(taken > 0 && taken <= rest.len());
            rest = &rest[taken..];
        }
        self.note(what, "stream", from);
        // Every answer is whole, and is one to a request that there is.
        let mut rest = &self.answers[..];
        while !rest.is_empty() {
            let size = u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize;
            assert!(rest[0] < 14 && size > 12 && size <= rest.len() && rest[12] <= 8, "{rest:?}");
            rest = &rest[size..];
        }
        self.answers.clear();
        if self.robot.hung_up().is_some() {
            self.disconnect("hung up");
        }
    }

    fn disconnect(&mut self, what: &str) {
        let from = self.robot.mode();
        self.robot.disconnected();
        self.note(what, "disconnect", from);
    }

    /// A packet whose torques may act: those, if so.
    fn packet(&mut self, dice: &mut Dice) -> Option<[f64; 7]> {
        let tau = match dice.below(12) {
            0 => [5.0; 7],
            1 => [f64::NAN; 7],
            _ => self.acted.map(|tau| tau + 0.01 * (dice.below(100) as f64 - 50.0)),
        };
        let finished = dice.below(40) == 0;
        let id = match dice.below(10) {
            0 => self.robot.id().wrapping_sub(dice.below(4)),
            1 => self.robot.id().wrapping_add(1 + dice.next()),
            _ => self.robot.id(),
        };
        let bytes = RobotCommand { id, tau, finished }.to_bytes(self.protocol);
        let (bytes, sent_whole) = match dice.below(8) {
            0 => (dice.bytes(600), false),
            1 if !self.before.is_empty() => {
                let k = usize::try_from(dice.below(self.before.len() as u64)).unwrap();
                (self.before[k].clone(), false)
            }
            _ => dice.spoilt(bytes),
        };
        self.before.push(bytes.clone());
        let mode = self.robot.mode();
        let heard = self.robot.command(&bytes);
        *self.seen.entry(format!("packet {heard:?}")).or_default() += 1;
        let length = self.robot.client().map(|(protocol, _)| protocol.command_bytes());
        match heard {
            Heard::Taken => {
                assert!(
                    matches!(mode, InterfaceMode::Starting | InterfaceMode::Moving)
                        && Some(bytes.len()) == length
                );
                let told = RobotCommand::read(self.protocol, &bytes).unwrap();
                assert_eq!(told.id, self.robot.id());
                assert!(!sent_whole || told.tau.map(f64::to_bits) == tau.map(f64::to_bits));
                Some(told.tau)
            }
            Heard::Malformed => {
                assert_ne!(Some(bytes.len()), length);
                None
            }
            Heard::Late | Heard::Twice | Heard::Unasked => None,
        }
    }

    fn cycle(&mut self, dice: &mut Dice) {
        let from = self.robot.mode();
        if dice.below(400) == 0 {
            self.speed = 3.0;
        }
        let sensed =
            StateSensed { tau_j_d: self.acted, dq: [self.speed; 7], ..StateSensed::default() };
        self.robot.state(&sensed, &mut self.answers);
        self.note("state", "state", from);
        let mut told = None;
        for _ in 0..dice.below(4) {
            let taken = self.packet(dice);
            assert!(told.is_none() || taken.is_none(), "two commands in one cycle");
            told = told.or(taken);
        }
        let lost = dice.below(10) == 0;
        let from = self.robot.mode();
        match self.robot.close(lost, &mut self.answers) {
            RobotCycle::Torque(tau) | RobotCycle::Finished(tau) => {
                assert_eq!(Some(tau), told);
                let first = from == InterfaceMode::Starting;
                for (tau, before) in tau.iter().zip(self.acted) {
                    assert!(tau.is_finite() && (tau - before).abs() <= 1.0 + 1e-6);
                    assert!(!first || tau.abs() <= 0.5);
                }
                self.acted = tau;
            }
            RobotCycle::Lost(tau) => {
                assert!((told.is_none() || lost) && from == InterfaceMode::Moving);
                assert_eq!(tau.map(f64::to_bits), self.acted.map(f64::to_bits));
            }
            RobotCycle::Still => assert_ne!(from, InterfaceMode::Moving),
            RobotCycle::Reflex(why) => {
                assert!(
                    self.robot.reflex_reason().has(why)
                        && self.robot.mode() == InterfaceMode::Reflex
                );
                *self.seen.entry(format!("reflex {}", why.name())).or_default() += 1;
            }
        }
        self.note("close", "close", from);
        if self.robot.mode() != InterfaceMode::Moving {
            (self.acted, self.speed) = ([0.0; 7], 0.0);
        }
    }

    fn requests(&mut self, dice: &mut Dice) {
        let id = u32::try_from(dice.below(1 << 20)).unwrap();
        let protocol = self.protocol;
        let (what, bytes) = match dice.below(8) {
            0 => ("connect", connect(protocol, 7)),
            1..=3 => ("start", start(protocol, id)),
            4 => ("stop", stop(id)),
            5 => ("recovery", recovery(protocol, id)),
            6 => ("setting", request(8, id, &[0; 128])),
            _ => ("noise", dice.bytes(80)),
        };
        let (bytes, whole) = if dice.below(20) == 0 { dice.spoilt(bytes) } else { (bytes, true) };
        self.stream(if whole { what } else { "spoilt request" }, &bytes);
    }

    /// However it went, the robot can be recovered, moved and left.
    fn end(&mut self) {
        self.disconnect("the end");
        assert_eq!(self.robot.mode(), InterfaceMode::Closed);
        let protocol = self.protocol;
        self.stream("connect", &connect(protocol, 7));
        assert!(matches!(self.robot.mode(), InterfaceMode::Idle | InterfaceMode::Reflex));
        self.stream("recovery", &recovery(protocol, 1));
        self.stream("start", &start(protocol, 2));
        assert_eq!(self.robot.mode(), InterfaceMode::Starting);
        self.robot.state(&StateSensed::default(), &mut self.answers);
        let id = self.robot.id();
        let bytes = RobotCommand { id, tau: [0.1; 7], finished: false }.to_bytes(protocol);
        assert_eq!(self.robot.command(&bytes), Heard::Taken);
        assert_eq!(self.robot.close(false, &mut self.answers), RobotCycle::Torque([0.1; 7]));
        self.disconnect("the end");
        self.stream("connect", &connect(protocol, 7));
        assert!(self.robot.reflex_reason().has(Reflex::Communication));
        assert_eq!(self.robot.mode(), InterfaceMode::Reflex);
    }
}

fn session(seed: u64) -> BTreeMap<String, u64> {
    let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1));
    let mut session = Session {
        robot: RobotSide::new(RULES, "<robot/>".to_owned()),
        answers: Vec::new(),
        protocol: Protocol::ALL[usize::try_from(seed % 2).unwrap()],
        acted: [0.0; 7],
        before: Vec::new(),
        speed: 0.0,
        seen: BTreeMap::new(),
    };
    for _ in 0..100 {
        match dice.below(12) {
            0 if session.robot.mode() == InterfaceMode::Closed => {
                session.stream("connect", &connect(session.protocol, 7));
            }
            0 | 1 => session.requests(&mut dice),
            2 if dice.below(8) == 0 => session.disconnect("the client went away"),
            _ => session.cycle(&mut dice),
        }
    }
    session.end();
    session.seen
}

#[test]
fn a_thousand_random_sessions_end_in_a_documented_mode() {
    let mut all = BTreeMap::<String, u64>::new();
    for seed in 0..1000 {
        for (what, count) in session(seed) {
            *all.entry(what).or_default() += count;
        }
    }
    for (what, count) in &all {
        println!("{count:>7}  {what}");
    }
    // What the table lists did happen.
    for what in [
        "packet Taken",
        "packet Late",
        "packet Twice",
        "packet Malformed",
        "packet Unasked",
        "reflex controller_torque_discontinuity",
        "reflex communication_constraints_violation",
        "state in Moving → Reflex",
        "close in Starting → Moving",
        "stop in Moving → Idle",
        "recovery in Reflex → Idle",
        "hung up in Moving → Closed",
        "the client went away in Moving → Closed",
        "close in Moving → Idle",
    ] {
        assert!(all.contains_key(what), "{what} never happened: {all:#?}");
    }
}
