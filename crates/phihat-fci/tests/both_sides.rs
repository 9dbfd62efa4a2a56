//! Client and robot, with sockets between them, in lock-step. Wrong if a motion did not end as the interface
//! says, if the same torques did not act twice, or if a client that comes second got no answer that says so.

use std::net::Ipv4Addr;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::support::Masses;
use phihat_fci::{
    Client, Ending, FciError, Host, Pace, Protocol, Reflex, RobotMode, RobotRules, RobotSide,
};

const RULES: RobotRules = RobotRules {
    torque_step_max: Some(1.0),
    first_torque_max: Some(0.0),
    velocity_max: [2.0; 7],
    losses_max: Some(20),
};

/// Action that makes a robot stop.
type Provoke = fn(&mut Client);

/// A robot that serves so many motions; its address, and the thread that returns its world.
fn robot(
    rules: RobotRules,
    patience_ms: u64,
    length: u64,
    motions: usize,
) -> (String, JoinHandle<Masses>) {
    let pace = Pace::LockStep { patience: Duration::from_millis(patience_ms) };
    let side = RobotSide::new(rules, "<robot/>".to_owned());
    let mut host = Host::listen(Ipv4Addr::LOCALHOST.into(), 0, pace, side).unwrap();
    let address = host.address().to_string();
    let served = thread::spawn(move || {
        let mut world = Masses::new(length, motions);
        host.serve(&mut world).unwrap();
        world
    });
    (address, served)
}

/// A client that waits a minute for a state: libfranka's 1 s would fail a test whose other thread does not
/// get a processor for that long.
fn connected(address: &str, protocol: Protocol) -> Client {
    Client::connect_patient(address, protocol, Duration::from_mins(1)).unwrap()
}

/// Begins a motion; returns true if it runs. It does not where the robot stopped for want of commands before
/// the client saw it begin.
fn begins(client: &mut Client) -> bool {
    match client.start_torque() {
        Ok(()) => true,
        Err(FciError::Aborted { reasons, .. }) if reasons.has(Reflex::Communication) => false,
        Err(why) => panic!("{why}"),
    }
}

/// So many cycles of a torque that rises slowly from zero.
fn cycles(client: &mut Client, count: u32) {
    for k in 0..count {
        let state = client.receive().unwrap();
        assert!(state.takes_torque() && state.success_rate > 0.99);
        client.send_torque(state.id, &[1e-3 * f64::from(k); 7]).unwrap();
    }
}

fn whole(protocol: Protocol) -> Masses {
    let (address, served) = robot(RULES, 30_000, u64::MAX, 1);
    let mut client = connected(&address, protocol);
    client.start_torque().unwrap();
    cycles(&mut client, 1000);
    let state = client.receive().unwrap();
    client.finish(state.id, &state.tau_j_d).unwrap();
    served.join().unwrap()
}

#[test]
fn a_motion_runs_and_ends_and_runs_again_to_the_same_bits() {
    for protocol in Protocol::ALL {
        let (once, again) = (whole(protocol), whole(protocol));
        assert_eq!((once.cycles, once.sum), (1001, again.sum));
        assert_eq!(once.endings, [Ending::Finished]);
        // Torque 0, 1e-3 … 0.999 N·m on 1 kg·m², and the last once more.
        let speed = 1e-3 * (1e-3 * (999.0 * 1000.0 / 2.0) + 0.999);
        assert!((once.dq[0] - speed).abs() < 1e-6, "{}", once.dq[0]);
    }
}

#[test]
fn every_reflex_is_told_and_recovery_leads_out_of_it() {
    for protocol in Protocol::ALL {
        let (address, served) = robot(RULES, 30_000, u64::MAX, 3);
        let mut client = connected(&address, protocol);
        // A jump of more than 1 N·m, of a first torque; then speed.
        let provoked: [(Reflex, Provoke); 2] = [
            (Reflex::TorqueJump, |client| {
                cycles(client, 10);
                let id = client.receive().unwrap().id;
                client.send_torque(id, &[1.1; 7]).unwrap();
            }),
            (Reflex::TorqueJump, |client| {
                let id = client.receive().unwrap().id;
                client.send_torque(id, &[0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.0]).unwrap();
            }),
        ];
        for (reflex, provoke) in provoked {
            client.start_torque().unwrap();
            provoke(&mut client);
            let state = loop {
                let state = client.receive().unwrap();
                if state.mode != RobotMode::Move {
                    break state;
                }
            };
            assert_eq!((state.mode, state.is_still()), (RobotMode::Reflex, true));
            assert!(state.errors.has(reflex) && state.reflex_reason.has(reflex));
            let status = if protocol == Protocol::V5 { 3 } else { 5 };
            match client.start_torque().unwrap_err() {
                FciError::Refused { status: found, reasons, .. } => {
                    assert_eq!((found, reasons.has(reflex)), (status, true));
                }
                other => panic!("{other}"),
            }
            client.recover().unwrap();
        }
        client.start_torque().unwrap();
        let mut tau = 0.0;
        let state = loop {
            let state = client.receive().unwrap();
            if state.mode != RobotMode::Move {
                break state;
            }
            client.send_torque(state.id, &[tau; 7]).unwrap();
            tau += 0.9;
        };
        assert!(state.errors.has(Reflex::Velocity) && state.dq[0] > 2.0);
        let world = served.join().unwrap();
        let reflexes = [Reflex::TorqueJump, Reflex::TorqueJump, Reflex::Velocity];
        assert_eq!(world.endings, reflexes.map(Ending::Reflex));
    }
}

#[test]
fn silence_stops_the_robot_after_as_many_cycles_as_its_rules_say() {
    for protocol in Protocol::ALL {
        let (address, served) = robot(RULES, 3, u64::MAX, 1);
        let mut client = connected(&address, protocol);
        if begins(&mut client) {
            let first = client.receive().unwrap();
            client.send_torque(first.id, &[0.0; 7]).unwrap();
        }
        let mut state = *client.last().unwrap();
        while state.mode == RobotMode::Move {
            state = client.receive().unwrap();
        }
        assert!(state.errors.has(Reflex::Communication));
        let world = served.join().unwrap();
        assert_eq!(world.endings, [Ending::Reflex(Reflex::Communication)]);
        // However late the first command was taken, the world went on for the losses that the rules bear, and no more.
        assert!(world.cycles <= 20, "{}", world.cycles);
    }
}

#[test]
fn a_client_stops_goes_away_and_meets_the_end_of_the_world() {
    for protocol in Protocol::ALL {
        let (address, served) = robot(RULES, 30_000, 200, 3);
        let mut client = connected(&address, protocol);
        client.start_torque().unwrap();
        cycles(&mut client, 5);
        client.stop().unwrap();
        client.start_torque().unwrap();
        cycles(&mut client, 5);
        drop(client);
        // Whoever comes next finds the robot stopped for want of commands.
        let mut client = connected(&address, protocol);
        assert!(client.last().unwrap().errors.has(Reflex::Communication));
        client.recover().unwrap();
        client.start_torque().unwrap();
        cycles(&mut client, 200);
        let world = served.join().unwrap();
        assert_eq!(world.endings, [Ending::Stopped, Ending::Disconnected, Ending::Over]);
    }
}

#[test]
fn a_second_client_is_told_that_there_is_one() {
    let (address, served) = robot(RULES, 30_000, u64::MAX, 1);
    let mut client = connected(&address, Protocol::V10);
    assert_eq!(client.model().unwrap(), "<robot/>");
    let why = Client::connect(&address, Protocol::V5).unwrap_err().to_string();
    assert_eq!(why, "the robot refused Connect (status 2)");
    client.start_torque().unwrap();
    cycles(&mut client, 300);
    let state = client.receive().unwrap();
    client.finish(state.id, &state.tau_j_d).unwrap();
    assert_eq!(served.join().unwrap().cycles, 301);
}

#[test]
fn in_real_time_a_motion_ends_with_the_world_or_for_want_of_commands() {
    // Which of the two is the machine's affair.
    let side = RobotSide::new(RULES, String::new());
    let mut host = Host::listen(Ipv4Addr::LOCALHOST.into(), 0, Pace::RealTime, side).unwrap();
    let address = host.address().to_string();
    let served = thread::spawn(move || {
        let mut world = Masses::new(200, 1);
        host.serve(&mut world).unwrap();
        world
    });
    let mut client = connected(&address, Protocol::V10);
    let mut answered = 0;
    if begins(&mut client) {
        loop {
            let state = client.receive().unwrap();
            if state.mode != RobotMode::Move {
                break;
            }
            client.send_torque(state.id, &[0.0; 7]).unwrap();
            answered += 1;
        }
    }
    let world = served.join().unwrap();
    match world.endings[..] {
        [Ending::Over] => assert!(world.cycles == 200 && answered > 0),
        [Ending::Reflex(Reflex::Communication)] => assert!(world.cycles < 200),
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn nobody_at_the_address_is_one_error() {
    let why = Client::connect("127.0.0.1:1", Protocol::V10).unwrap_err().to_string();
    assert!(why.starts_with("connecting to 127.0.0.1:1: "), "{why}");
}
