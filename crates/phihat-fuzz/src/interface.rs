//! The Franka Control Interface under bytes that no client and no robot sends.

use phihat_fci::{
    Heard, InterfaceMode, Protocol, RobotCommand, RobotCycle, RobotRules, RobotSide, RobotState,
    StateSensed,
};

use crate::choices::Choices;

const STEP: f64 = 1.0;

const RULES: RobotRules = RobotRules {
    torque_step_max: Some(STEP),
    first_torque_max: Some(0.0),
    velocity_max: [2.0; 7],
    losses_max: Some(3),
};

/// A request to connect with a version, and one for a motion by torques.
fn opening(protocol: Protocol) -> Vec<u8> {
    let (generator, size) = if protocol == Protocol::V5 { (1_u32, 68_u32) } else { (4, 125) };
    let [low, high] = protocol.version().to_le_bytes();
    let mut bytes: Vec<u8> = [0, 0, 16].into_iter().flat_map(u32::to_le_bytes).collect();
    bytes.extend([low, high, 1, 1]);
    bytes.extend([1, 1, size, 2, generator].into_iter().flat_map(u32::to_le_bytes));
    bytes.resize(16 + size as usize, 0);
    bytes
}

/// Bytes as states, commands, requests and packets, whole and spoilt: nothing panics, torques that act
/// satisfy the rules, and answers are given to requests only.
///
/// # Panics
///
/// If a promise is broken.
pub fn fci(bytes: &[u8]) {
    let mut choices = Choices::of(bytes);
    let protocol = choices.of_all(&Protocol::ALL);
    let mut whole = bytes.to_vec();
    whole.resize(protocol.state_bytes(), choices.byte_or_0().to_le_bytes()[0]);
    let _ = (RobotState::read(protocol, bytes), RobotState::read(protocol, &whole));
    let _ = RobotCommand::read(protocol, bytes);
    let mut robot = RobotSide::new(RULES, "<robot/>".to_owned());
    let mut answers = Vec::new();
    let mut acted = [0.0; 7];
    let mut stream = |robot: &mut RobotSide, mut rest: &[u8]| {
        while !rest.is_empty() {
            let taken = robot.tcp(rest, &mut answers);
            assert!((1..=rest.len()).contains(&taken), "{taken} of {} bytes", rest.len());
            rest = &rest[taken..];
        }
        assert!(answers.len() <= 1024 * (bytes.len() + 64), "{} bytes of answers", answers.len());
    };
    while let Some(choice) = choices.byte() {
        let rest = choices.rest();
        let piece = &rest[..rest.len().min(choice % 32)];
        match choice / 32 {
            0 => robot.disconnected(),
            1 => stream(&mut robot, &opening(protocol)),
            2 => stream(&mut robot, piece),
            _ => acted = cycle(&mut robot, (protocol, acted), choice, piece),
        }
    }
}

/// One cycle with a packet of which some bytes are these; the torques that act from then on.
fn cycle(
    robot: &mut RobotSide,
    (protocol, acted): (Protocol, [f64; 7]),
    choice: usize,
    piece: &[u8],
) -> [f64; 7] {
    let mut answers = Vec::new();
    let sensed = StateSensed { tau_j_d: acted, ..StateSensed::default() };
    robot.state(&sensed, &mut answers);
    let tau = acted.map(|tau| tau + choice as f64 / 256.0 - 0.5);
    let told = RobotCommand {
        id: robot.id(),
        tau: if choice < 128 { acted } else { tau },
        finished: false,
    };
    let mut packet = told.to_bytes(protocol);
    if choice.is_multiple_of(4) {
        let at = 300 % (packet.len() - piece.len());
        packet[at..at + piece.len()].copy_from_slice(piece);
    }
    let heard = robot.command(&packet);
    let starts = robot.mode() == InterfaceMode::Starting;
    match robot.close(false, &mut answers) {
        RobotCycle::Torque(tau) | RobotCycle::Finished(tau) => {
            assert_eq!(heard, Heard::Taken, "a torque acts that nobody told");
            for (tau, before) in tau.iter().zip(acted) {
                // Protocol 10 has its echo in single precision.
                assert!(
                    (tau - before).abs() <= STEP + 1e-6 * (1.0 + before.abs()),
                    "{before} to {tau}"
                );
                assert!(!starts || tau.abs() <= 0.0, "a first torque of {tau}");
            }
            if robot.mode() == InterfaceMode::Moving { tau } else { [0.0; 7] }
        }
        RobotCycle::Lost(tau) => tau,
        RobotCycle::Still | RobotCycle::Reflex(_) => [0.0; 7],
    }
}
