//! `franka-rs` and this project's client under one law against one robot. Wrong if a torque that acted, or
//! what was measured of it, differed in a bit.

#[path = "../../tests/support/mod.rs"]
mod support;

use std::net::Ipv4Addr;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use franka::{FciVersion, RealtimeConfig, Robot, RobotOptions, Torques, VersionPolicy};
use phihat_fci::{Client, Ending, Host, Pace, Protocol, Reflex, RobotSide, Rules};
use support::Masses;

const CYCLES: u32 = 10_000;

const RULES: Rules = Rules {
    torque_step_max: Some(1.0),
    first_torque_max: Some(0.0),
    velocity_max: [2.0; 7],
    losses_max: Some(20),
};

/// An arm as far as clients read it: seven joints with their limits.
fn description() -> String {
    let joint = |n: usize| {
        format!(
            "<joint name=\"arm_joint{n}\" type=\"revolute\"><parent link=\"link{}\"/><child link=\"link{n}\"/><axis \
             xyz=\"0 0 1\"/><limit lower=\"-9\" upper=\"9\" effort=\"87\" velocity=\"2.5\"/>\
             <position_based_velocity_limits velocity_offset=\"-100\" deceleration_limit=\"0\"/></joint><link \
             name=\"link{n}\"/>",
            n - 1
        )
    };
    let joints: String = (1..=7).map(joint).collect();
    format!("<robot name=\"arm\"><link name=\"link0\"/>{joints}</robot>")
}

fn robot(motions: usize) -> (String, JoinHandle<Masses>) {
    let pace = Pace::LockStep { patience: Duration::from_secs(30) };
    let side = RobotSide::new(RULES, description());
    let mut host = Host::listen(Ipv4Addr::LOCALHOST.into(), 0, pace, side).unwrap();
    let address = host.address().to_string();
    let served = thread::spawn(move || {
        let mut world = Masses::new(u64::MAX, motions);
        host.serve(&mut world).unwrap();
        world
    });
    (address, served)
}

/// A spring and a damper to a target that grows slowly; zero at first.
fn law(k: u32, q: &[f64; 7], dq: &[f64; 7]) -> [f64; 7] {
    let target = 1e-5 * f64::from(k.min(5000));
    core::array::from_fn(|i| if k == 0 { 0.0 } else { 20.0 * (target - q[i]) - 8.0 * dq[i] })
}

fn ours(address: &str, protocol: Protocol) {
    let mut client = Client::connect(address, protocol).unwrap();
    client.start_torque().unwrap();
    for k in 0..CYCLES {
        let state = client.receive().unwrap();
        let tau = law(k, &state.q, &state.dq);
        if k + 1 == CYCLES {
            client.finish(state.id, &tau).unwrap();
        } else {
            client.send_torque(state.id, &tau).unwrap();
        }
    }
}

fn connected(address: &str, protocol: Protocol) -> Robot {
    let version = if protocol == Protocol::V5 { FciVersion::V5 } else { FciVersion::V10 };
    let options = RobotOptions::new(RealtimeConfig::Ignore).with_version(VersionPolicy::Exact(version));
    Robot::with_options(address, options).unwrap()
}

fn theirs(address: &str, protocol: Protocol) {
    let robot = connected(address, protocol);
    let mut control = robot.start_torque_control().unwrap();
    for k in 0..CYCLES {
        let (state, _) = control.read_once().unwrap();
        let mut torques = Torques::new(law(k, &state.q, &state.dq));
        torques.motion_finished = k + 1 == CYCLES;
        control.write_once(&torques).unwrap();
    }
}

#[test]
fn ten_thousand_cycles_of_both_leave_the_same_world() {
    for protocol in Protocol::ALL {
        let worlds = [ours as fn(&str, Protocol), theirs].map(|run| {
            let (address, served) = robot(1);
            run(&address, protocol);
            served.join().unwrap()
        });
        let [a, b] = &worlds;
        assert_eq!((a.cycles, b.cycles), (u64::from(CYCLES), u64::from(CYCLES)));
        assert_eq!(a.endings, [Ending::Finished]);
        assert_eq!((a.sum, &a.endings), (b.sum, &b.endings), "version {}", protocol.version());
        assert_eq!(a.q.map(f64::to_bits), b.q.map(f64::to_bits));
        assert!(a.q[0] > 0.01, "it moved");
    }
}

#[test]
fn a_jump_is_a_reflex_to_both_and_both_recover() {
    for protocol in Protocol::ALL {
        let (address, served) = robot(1);
        let robot = connected(&address, protocol);
        let mut control = robot.start_torque_control().unwrap();
        let mut told = None;
        for k in 0..100 {
            let answer = control.read_once().and_then(|_| {
                control.write_once(&Torques::new([if k == 20 { 1.5 } else { 0.0 }; 7]))
            });
            if let Err(why) = answer {
                told = Some(why.to_string());
                break;
            }
        }
        let told = told.unwrap();
        assert!(told.contains("controller_torque_discontinuity"), "{told}");
        drop(control);
        robot.automatic_error_recovery().unwrap();
        drop(robot);
        assert_eq!(served.join().unwrap().endings, [Ending::Reflex(Reflex::TorqueJump)]);
    }
}
