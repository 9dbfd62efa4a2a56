//! Layout of numbers on the wire. Wrong if the place of a field differs from that in the headers of
//! libfranka-common: the fields are listed here in their order, and places are sums of what comes before.

use crate::support::{connect, start};
use phihat_fci::{
    Protocol, Reflex, RobotCommand, RobotMode, RobotRules, RobotSide, RobotState, StateSensed,
};

/// `RobotState` of `rbk_types.h` after its number, in order.
const FIELDS: [(&str, usize); 39] = [
    ("O_T_EE", 16),
    ("O_T_EE_d", 16),
    ("F_T_EE", 16),
    ("EE_T_K", 16),
    ("F_T_NE", 16),
    ("NE_T_EE", 16),
    ("m_ee", 1),
    ("I_ee", 9),
    ("F_x_Cee", 3),
    ("m_load", 1),
    ("I_load", 9),
    ("F_x_Cload", 3),
    ("elbow", 2),
    ("elbow_d", 2),
    ("tau_J", 7),
    ("tau_J_d", 7),
    ("dtau_J", 7),
    ("q", 7),
    ("q_d", 7),
    ("dq", 7),
    ("dq_d", 7),
    ("ddq_d", 7),
    ("joint_contact", 7),
    ("cartesian_contact", 6),
    ("joint_collision", 7),
    ("cartesian_collision", 6),
    ("tau_ext_hat_filtered", 7),
    ("O_F_ext_hat_K", 6),
    ("K_F_ext_hat_K", 6),
    ("O_dP_EE_d", 6),
    ("O_ddP_O", 3),
    ("elbow_c", 2),
    ("delbow_c", 2),
    ("ddelbow_c", 2),
    ("O_T_EE_c", 16),
    ("O_dP_EE_c", 6),
    ("O_ddP_EE_c", 6),
    ("theta", 7),
    ("dtheta", 7),
];

/// Place of a field, and the tail's.
fn place(protocol: Protocol, name: &str) -> usize {
    let before =
        FIELDS.iter().take_while(|(field, _)| *field != name).map(|(_, n)| n).sum::<usize>();
    let width = if protocol == Protocol::V5 { 8 } else { 4 };
    // Version 10 has 36 numbers more behind those of version 5.
    let more = if protocol == Protocol::V10 && name == "tail" { 36 } else { 0 };
    8 + width * (before + more)
}

fn number(protocol: Protocol, bytes: &[u8], place: usize) -> f64 {
    match protocol {
        Protocol::V5 => f64::from_le_bytes(bytes[place..place + 8].try_into().unwrap()),
        Protocol::V10 => f32::from_le_bytes(bytes[place..place + 4].try_into().unwrap()).into(),
    }
}

#[test]
fn sizes_are_those_of_the_headers() {
    for (protocol, width) in [(Protocol::V5, 8), (Protocol::V10, 4)] {
        let tail = place(protocol, "tail");
        assert_eq!(tail + 2 + 41 + 41 + 1 + width, protocol.state_bytes());
    }
    assert_eq!(place(Protocol::V5, "tail"), 2280);
    assert_eq!((place(Protocol::V10, "tau_J_d"), place(Protocol::V10, "theta")), (540, 1088));
    // Number, motion (7 + 7 + 16 + 6 + 2 doubles, two flags), torques; version 10 has a flag behind them.
    assert_eq!(Protocol::V5.command_bytes(), 8 + 38 * 8 + 2 + 56);
    assert_eq!(Protocol::V10.command_bytes(), 8 + 38 * 8 + 2 + 56 + 1);
}

#[test]
fn a_state_is_read_from_where_the_headers_have_it() {
    for protocol in Protocol::ALL {
        let mut bytes = vec![0; protocol.state_bytes()];
        bytes[..8].copy_from_slice(&77_u64.to_le_bytes());
        for (k, name) in ["tau_J", "tau_J_d", "q", "dq"].into_iter().enumerate() {
            for joint in 0..7 {
                let value = (10 * k + joint) as f64 / 8.0;
                let width = if protocol == Protocol::V5 { 8 } else { 4 };
                let at = place(protocol, name) + width * joint;
                #[expect(clippy::cast_possible_truncation, reason = "eighths are exact")]
                let single = (value as f32).to_le_bytes();
                match protocol {
                    Protocol::V5 => bytes[at..at + 8].copy_from_slice(&value.to_le_bytes()),
                    Protocol::V10 => bytes[at..at + 4].copy_from_slice(&single),
                }
            }
        }
        let tail = place(protocol, "tail");
        (bytes[tail], bytes[tail + 1]) = (5, 2);
        bytes[tail + 2 + 25] = 1;
        bytes[tail + 43 + 32] = 1;
        bytes[tail + 84] = 4;
        match protocol {
            Protocol::V5 => bytes[tail + 85..].copy_from_slice(&0.75_f64.to_le_bytes()),
            Protocol::V10 => bytes[tail + 85..].copy_from_slice(&0.75_f32.to_le_bytes()),
        }
        let state = RobotState::read(protocol, &bytes).unwrap();
        let eighths = |k: usize| core::array::from_fn(|joint| (10 * k + joint) as f64 / 8.0);
        assert_eq!((state.id, state.tau_j, state.tau_j_d), (77, eighths(0), eighths(1)));
        assert_eq!((state.q, state.dq), (eighths(2), eighths(3)));
        assert_eq!((state.generator, state.controller, state.mode), (5, 2, RobotMode::Reflex));
        assert!(state.errors.has(Reflex::Communication) && !state.errors.has(Reflex::TorqueJump));
        assert_eq!(state.reflex_reason.to_string(), "controller_torque_discontinuity");
        assert_eq!(state.success_rate.to_bits(), 0.75_f64.to_bits());
        for length in [0, 8, bytes.len() - 1] {
            assert!(RobotState::read(protocol, &bytes[..length]).is_err());
        }
        bytes[tail + 84] = 7;
        let why = RobotState::read(protocol, &bytes).unwrap_err().to_string();
        assert_eq!(why, "a state with a mode of 7; valid: 0 … 6");
    }
}

#[test]
fn the_robot_writes_where_the_headers_have_it() {
    for protocol in Protocol::ALL {
        let mut robot = RobotSide::new(RobotRules::NONE, String::new());
        let mut answers = Vec::new();
        robot.tcp(&connect(protocol, 9), &mut answers);
        robot.tcp(&start(protocol, 1), &mut answers);
        let values = |k: usize| core::array::from_fn(|joint| (10 * k + joint) as f64 / 8.0);
        let sensed = StateSensed {
            q: values(1),
            dq: values(2),
            tau_j: values(3),
            tau_j_d: values(4),
            pose: core::array::from_fn(|i| i as f64),
            arrives: true,
        };
        let bytes = robot.state(&sensed, &mut answers).unwrap().to_vec();
        assert_eq!(bytes.len(), protocol.state_bytes());
        let width = if protocol == Protocol::V5 { 8 } else { 4 };
        let fields = [
            ("q", 1),
            ("q_d", 1),
            ("theta", 1),
            ("dq", 2),
            ("dq_d", 2),
            ("dtheta", 2),
            ("tau_J", 3),
            ("tau_J_d", 4),
        ];
        for (name, k) in fields {
            for joint in 0..7 {
                let found = number(protocol, &bytes, place(protocol, name) + width * joint);
                let told: [f64; 7] = values(k);
                assert_eq!(found.to_bits(), told[joint].to_bits(), "{name}");
            }
        }
        for i in 0..16 {
            let found = number(protocol, &bytes, place(protocol, "O_T_EE") + width * i);
            assert_eq!(found.to_bits(), (i as f64).to_bits());
        }
        // A frame that is nobody's does not turn.
        let one = number(protocol, &bytes, place(protocol, "NE_T_EE") + width * 5);
        assert_eq!(one.to_bits(), 1.0_f64.to_bits());
        let tail = place(protocol, "tail");
        let generator = if protocol == Protocol::V5 { 2 } else { 5 };
        assert_eq!(bytes[tail..tail + 2], [generator, 2]);
        assert_eq!(bytes[tail + 84], 2);
    }
}

#[test]
fn a_command_reads_back_and_stands_where_the_headers_have_it() {
    for protocol in Protocol::ALL {
        let tau = core::array::from_fn(|i| 0.1 * i as f64 - 0.3);
        for finished in [false, true] {
            let command = RobotCommand { id: 1 << 40, tau, finished };
            let bytes = command.to_bytes(protocol);
            assert_eq!(bytes.len(), protocol.command_bytes());
            assert_eq!(RobotCommand::read(protocol, &bytes).unwrap(), command);
            assert_eq!(bytes[8 + 306..8 + 314], tau[0].to_le_bytes());
            assert_eq!(bytes[8 + 305], u8::from(finished));
            assert!(RobotCommand::read(protocol, &bytes[1..]).is_err());
        }
    }
}
