//! Bytes of anybody. Wrong if any made a reader panic, if memory were taken by what a message claims, or if a
//! client took an answer for what it is not.

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, UdpSocket};
use std::thread;
use std::time::Duration;

use crate::support::{connect, request, start};
use allocation_counter::measure;
use phihat_fci::{
    Client, FciError, InterfaceMode, Protocol, RobotCommand, RobotRules, RobotSide, RobotState,
    StateSensed,
};
use proptest::collection::vec;
use proptest::prelude::{ProptestConfig, any, prop_assert, proptest};
use proptest::test_runner::RngSeed;

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 2000,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in vec(any::<u8>(), 0..3000)) {
        for protocol in Protocol::ALL {
            let _ = RobotState::read(protocol, &bytes);
            let _ = RobotCommand::read(protocol, &bytes);
            let mut whole = bytes.clone();
            whole.resize(protocol.state_bytes(), 0x5a);
            let _ = RobotState::read(protocol, &whole);
            whole.truncate(protocol.command_bytes());
            prop_assert!(RobotCommand::read(protocol, &whole).is_ok());
        }
    }

    #[test]
    fn no_stream_takes_memory_by_what_it_claims(
        bytes in vec(any::<u8>(), 0..400),
        claims in vec(any::<u32>(), 3),
        cut in 0_usize..40,
    ) {
        let mut robot = RobotSide::new(RobotRules::NONE, String::new());
        let mut answers = Vec::with_capacity(4096);
        let mut stream = connect(Protocol::V10, 7);
        stream.extend(start(Protocol::V10, 1));
        stream.extend(claims.iter().flat_map(|claim| claim.to_le_bytes()));
        stream.extend(&bytes);
        stream.drain(cut.min(12)..cut);
        let used = measure(|| {
            let mut rest = &stream[..];
            while !rest.is_empty() {
                let taken = robot.tcp(rest, &mut answers);
                assert!(taken > 0);
                rest = &rest[taken..];
                robot.state(&StateSensed::default(), &mut answers);
                robot.command(&bytes);
                robot.close(false, &mut answers);
            }
        });
        // The state's bytes, laid out once.
        prop_assert!(used.bytes_max <= 1377, "{used:?}");
        prop_assert!(answers.len() <= 200);
    }
}

#[test]
fn requests_of_any_size_end_the_connection_and_take_nothing() {
    for protocol in Protocol::ALL {
        for command in 0..20 {
            for size in [0, 11, 13, 429, 1 << 20, u32::MAX] {
                let mut robot = RobotSide::new(RobotRules::NONE, String::new());
                let mut answers = Vec::new();
                robot.tcp(&connect(protocol, 7), &mut answers);
                let mut bytes = request(command, 3, &[]);
                bytes[8..12].copy_from_slice(&size.to_le_bytes());
                assert_eq!(robot.tcp(&bytes, &mut answers), 12);
                let why = robot.hung_up().unwrap().to_string();
                assert_eq!(why, format!("a request {command} of {size} bytes, which there is not"));
                assert_eq!((robot.mode(), answers.len()), (InterfaceMode::Idle, 15));
                // What comes after it is left out.
                assert_eq!(robot.tcp(&[0; 500], &mut answers), 500);
            }
        }
    }
}

#[test]
fn a_version_that_is_not_spoken_is_told_which_is() {
    let mut robot = RobotSide::new(RobotRules::NONE, String::new());
    let mut answers = Vec::new();
    let words = [8_u16, 7].into_iter().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    robot.tcp(&request(0, 5, &words), &mut answers);
    // Status 1, version 10.
    assert_eq!(answers, [0, 0, 0, 0, 5, 0, 0, 0, 15, 0, 0, 0, 1, 10, 0]);
    let why = robot.hung_up().unwrap().to_string();
    assert_eq!(why, "version 8 of the interface; spoken are 5 and 10");
}

/// A robot that answers the request to connect, sends one state, and answers the next request with these
/// bytes; without any, it sends that state for ever.
fn liar(answer: Vec<u8>, state: usize) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    thread::spawn(move || {
        let (mut tcp, _) = listener.accept().unwrap();
        let mut bytes = [0; 16];
        tcp.read_exact(&mut bytes).unwrap();
        let port = u16::from_le_bytes([bytes[14], bytes[15]]);
        tcp.write_all(&[0, 0, 0, 0, 0, 0, 0, 0, 15, 0, 0, 0, 0, 10, 0]).unwrap();
        let udp = UdpSocket::bind("127.0.0.1:0").unwrap();
        let mut message = vec![0; state];
        if let Some(first) = message.first_mut() {
            *first = 1;
        }
        udp.send_to(&message, ("127.0.0.1", port)).unwrap();
        if answer.is_empty() {
            // The same state again and again, until the client is gone.
            tcp.set_nonblocking(true).unwrap();
            while !matches!(tcp.read(&mut [0]), Ok(0)) {
                let _ = udp.send_to(&message, ("127.0.0.1", port));
                thread::sleep(Duration::from_millis(1));
            }
        }
        let mut request = [0; 12];
        if tcp.read_exact(&mut request).is_ok() {
            let _ = tcp.write_all(&answer);
        }
    });
    address
}

fn connected(answer: Vec<u8>, state: usize) -> Result<Client, FciError> {
    Client::connect_patient(&liar(answer, state), Protocol::V10, Duration::from_mins(1))
}

#[test]
fn a_client_refuses_a_robot_that_lies() {
    let why = connected(Vec::new(), 1376).unwrap_err().to_string();
    assert_eq!(why, "a state with a length of 1376; valid: 1377 bytes");
    // An answer that claims nearly nothing, nearly everything, and one that ends before it does.
    let head = |size: u32| {
        let words = [11, 1, size].into_iter().flat_map(u32::to_le_bytes);
        words.chain([0, b'<']).collect::<Vec<u8>>()
    };
    let asked = |answer: Vec<u8>| {
        let mut client = connected(answer, 1377).unwrap();
        let mut told = Ok(String::new());
        let used = measure(|| told = client.model());
        assert!(used.bytes_max < 10_000, "{used:?}");
        told
    };
    let why = asked(head(12)).unwrap_err().to_string();
    assert_eq!(why, "an answer with a size of 12; valid: at least 13");
    let why = asked(head(u32::MAX)).unwrap_err().to_string();
    assert_eq!(why, "a description with a length of 4294967295; valid: at most 16 MiB");
    // What came is what there is.
    assert_eq!(asked(head(1 << 20)).unwrap(), "<");
    let refused = asked([11, 1, 13].into_iter().flat_map(u32::to_le_bytes).chain([1]).collect());
    assert!(matches!(refused, Err(FciError::Refused { status: 1, .. })), "{refused:?}");
}

/// States that are old come in time for ever: to the client the robot is silent.
#[test]
fn a_robot_whose_number_stands_still_is_silent() {
    let patience = Duration::from_millis(100);
    let address = liar(Vec::new(), Protocol::V10.state_bytes());
    let mut client = Client::connect_patient(&address, Protocol::V10, patience).unwrap();
    let told = client.receive();
    assert!(matches!(told, Err(FciError::Silent(waited)) if waited == patience), "{told:?}");
}
