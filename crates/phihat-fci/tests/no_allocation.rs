//! No cycle allocates. Wrong if 72,000 cycles took one allocation more than 1,000 do, on either side of the
//! wire, with sockets or without.

use std::net::Ipv4Addr;
use std::thread;
use std::time::Duration;

use crate::support::{Masses, connect, start};
use allocation_counter::measure;
use phihat_fci::{
    Client, Ending, Host, Pace, Protocol, RobotCommand, RobotCycle, RobotRules, RobotSide,
    RobotState, StateSensed,
};

const CYCLES: u64 = 72_000;

#[test]
fn the_robots_side_and_the_codec_do_not_allocate() {
    for protocol in Protocol::ALL {
        let mut robot = RobotSide::new(RobotRules::NONE, String::new());
        let mut answers = Vec::with_capacity(1024);
        robot.tcp(&connect(protocol, 9), &mut answers);
        robot.tcp(&start(protocol, 1), &mut answers);
        let template = RobotCommand { id: 0, tau: [0.5; 7], finished: false }.to_bytes(protocol);
        let mut packet = template.clone();
        let mut acted = 0;
        let used = measure(|| {
            for _ in 0..CYCLES {
                let bytes = robot.state(&StateSensed::default(), &mut answers).unwrap();
                let state = RobotState::read(protocol, bytes).unwrap();
                packet[..8].copy_from_slice(&state.id.to_le_bytes());
                robot.command(&packet);
                acted +=
                    u64::from(robot.close(false, &mut answers) == RobotCycle::Torque([0.5; 7]));
            }
        });
        assert_eq!((acted, used.count_total), (CYCLES, 0));
    }
}

/// Allocations of client and robot in a motion of so many cycles.
fn both(protocol: Protocol, cycles: u64) -> (u64, u64) {
    let pace = Pace::LockStep { patience: Duration::from_secs(30) };
    let side = RobotSide::new(RobotRules::NONE, String::new());
    let mut host = Host::listen(Ipv4Addr::LOCALHOST.into(), 0, pace, side).unwrap();
    let address = host.address().to_string();
    let robot = thread::spawn(move || {
        let mut world = Masses::new(u64::MAX, 1);
        let used = measure(|| host.serve(&mut world).unwrap());
        assert_eq!((world.cycles, world.endings), (cycles, vec![Ending::Finished]));
        used.count_total
    });
    let mut client = Client::connect_patient(&address, protocol, Duration::from_mins(1)).unwrap();
    client.start_torque().unwrap();
    let used = measure(|| {
        for _ in 1..cycles {
            let state = client.receive().unwrap();
            client.send_torque(state.id, &[1e-3; 7]).unwrap();
        }
    });
    let state = client.receive().unwrap();
    client.finish(state.id, &[1e-3; 7]).unwrap();
    (used.count_total, robot.join().unwrap())
}

#[test]
fn neither_client_nor_host_allocates_in_a_cycle() {
    for protocol in Protocol::ALL {
        let (few, many) = (both(protocol, 1000), both(protocol, CYCLES));
        assert_eq!((few.0, many), (0, few));
    }
}
