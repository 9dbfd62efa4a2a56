//! A log for ROS tools. Wrong if a message of it, read by its layout on the wire and not by its writer, held
//! another number than the trace, or if one were missing. Other readers read one in the Python step.
#![cfg(feature = "mcap")]

use std::collections::BTreeMap;

use crate::support::{gains, read};
use mcap::MessageStream;
use phihat_sim::{ErrorShares, McapTrace, Simulation};

const STUDY: &str = "duration_s = 0.5\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.2\n[gains]\norder = 1\n\
    bandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n[supervisor]\n\
    [reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 0.2\n[[reference.sine]]\namplitude_rad = 0.2\n\
    frequency_hz = 0.3\n";

/// Reads CDR from its bytes.
struct Bytes<'a>(&'a [u8], usize);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let at = (self.1 - 4).next_multiple_of(N) + 4;
        self.1 = at + N;
        self.0[at..at + N].try_into().unwrap()
    }
    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }
    fn string(&mut self) -> String {
        let size = self.u32() as usize;
        let text = &self.0[self.1..self.1 + size];
        self.1 += size;
        assert_eq!(text.last(), Some(&0));
        String::from_utf8(text[..size - 1].to_vec()).unwrap()
    }
    fn numbers(&mut self) -> Vec<f64> {
        (0..self.u32()).map(|_| f64::from_le_bytes(self.take())).collect()
    }
}

#[test]
fn every_message_holds_the_bits_of_the_trace() {
    let study = read(STUDY);
    let mut trace = Simulation::new(&study, &gains(&study)).unwrap().run(|_| ()).trace;
    ErrorShares::new(vec![0.01, 0.02, 0.03]).fill(&mut trace);
    let mut log = McapTrace::new(Vec::new()).unwrap();
    log.attach("gains.json", "application/json", b"{}").unwrap();
    log.block(&trace).unwrap();
    let bytes = log.finish().unwrap();
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = message.channel.topic.clone();
        let k = usize::try_from(message.sequence).unwrap();
        *seen.entry(topic.clone()).or_default() += 1;
        assert_eq!(message.log_time, trace.t_ns[k]);
        let mut bytes = Bytes(&message.data, 4);
        assert_eq!(message.data[..4], [0, 1, 0, 0]);
        if topic == "/phihat/mode" {
            assert_eq!(bytes.string(), trace.supervision.as_ref().unwrap().mode[k].name());
            continue;
        }
        if topic == "/phihat/events" {
            continue;
        }
        let stamp = u64::from(bytes.u32()) * 1_000_000_000 + u64::from(bytes.u32());
        assert_eq!((stamp, bytes.string()), (trace.t_ns[k], String::new()));
        let names: Vec<String> = (0..bytes.u32()).map(|_| bytes.string()).collect();
        assert_eq!(names, ["joint1", "joint2", "joint3"]);
        let found = [bytes.numbers(), bytes.numbers(), bytes.numbers()];
        assert_eq!(bytes.1, message.data.len(), "{topic}: bytes are left over");
        let of = |signal: fn(&phihat_sim::JointTrace) -> &Vec<f64>| -> Vec<f64> {
            trace.joints.iter().map(|joint| signal(joint)[k]).collect()
        };
        let expected = match topic.as_str() {
            "/joint_states" => {
                [of(|j| &j.q_measured), of(|j| &j.dq_measured), of(|j| &j.tau_applied)]
            }
            "/phihat/reference" => [of(|j| &j.q_desired), of(|j| &j.dq_desired), vec![]],
            "/phihat/error" => [of(|j| &j.e), of(|j| &j.de), vec![]],
            "/phihat/torque_command" => [vec![], vec![], of(|j| &j.tau_command)],
            "/phihat/phi" => [vec![], vec![], of(|j| &j.phi)],
            "/phihat/error_share" => [of(|j| &j.error_share), vec![], vec![]],
            "/phihat/phi_hat" => [vec![], vec![], of(|j| &j.phi_hat)],
            other => unreachable!("{other}"),
        };
        assert_eq!(found, expected, "{topic} at {k}");
    }
    let events =
        trace.supervision.as_ref().unwrap().events.iter().filter(|e| !e.is_empty()).count();
    assert_eq!(seen.remove("/phihat/events").unwrap_or(0), events);
    assert_eq!(seen.len(), 8);
    assert!(seen.values().all(|count| *count == trace.len()), "{seen:?}");
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.attachment_indexes.len(), 1);
    assert!(!summary.chunk_indexes.is_empty());
}
