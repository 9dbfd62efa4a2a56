//! The node's thread.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use ros2_client::builtin_interfaces::Time;
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    Context, MessageTypeName, Name, NodeName, NodeOptions, Publisher, QosProfile, Subscription,
};
use rtrb::Consumer;
use serde::Serialize;

use super::asked::{NamedJoint, Refused, TimedPositions};
use super::messages::{
    Array, DiagnosticArray, DiagnosticStatus, Header, JointState, JointTrajectory, KeyValue, Text,
};
use super::told::{JointSample, RosCounts, RosError, RosOptions, Snapshot};
use crate::hooks::Targets;

/// Sleep of the node where there is nothing to do.
const REST: Duration = Duration::from_micros(500);

/// Time for which the node stays after the drive, so that sent messages arrive.
const LINGER: Duration = Duration::from_secs(1);

/// Time for which a drive waits for others to find its node: from then on they receive every message.
const DISCOVERY: Duration = Duration::from_secs(1);

/// Time from one message of diagnostics to the next \[ns\].
const DIAGNOSTICS_NS: u64 = 1_000_000_000;

/// Signal of a joint; below, each topic with its position, velocity and effort.
type JointSignal = fn(&JointSample) -> f64;
const STATES: [(&str, &str, [Option<JointSignal>; 3]); 6] = [
    ("/", "joint_states", [Some(|j| j.q), Some(|j| j.dq), Some(|j| j.tau)]),
    ("/phihat", "reference", [Some(|j| j.q_desired), Some(|j| j.dq_desired), None]),
    ("/phihat", "error", [Some(|j| j.q - j.q_desired), Some(|j| j.dq - j.dq_desired), None]),
    ("/phihat", "torque_command", [None, None, Some(|j| j.command)]),
    ("/phihat", "phi_hat", [None, None, Some(|j| j.phi_hat)]),
    ("/phihat", "error_share", [Some(|j| j.share), None, None]),
];

pub(super) struct DriveNode {
    /// Others know of what is published and received by it.
    _known: ros2_client::Node,
    joints: Vec<NamedJoint>,
    read: Consumer<Snapshot>,
    states: Vec<Publisher<JointState>>,
    modes: Publisher<Text>,
    diagnostics: Publisher<DiagnosticArray>,
    asked: Option<NodeSubscriptions>,
    counts: RosCounts,
    mode: Option<&'static str>,
    told_ns: Option<u64>,
    refusal: Option<Refused>,
}

/// Subscriptions, and the way that they request.
struct NodeSubscriptions {
    targets: Arc<Targets>,
    commands: Subscription<Array>,
    trajectories: Subscription<JointTrajectory>,
    /// Current way, its begin \[ns\], and the positions where it began.
    way: Option<(TimedPositions, u64, Vec<f64>)>,
}

fn failed(why: impl std::fmt::Display) -> RosError {
    RosError::Node(why.to_string())
}

fn qos() -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: 10 })
}

/// Quality of service of a latched topic: a later subscriber receives its last message.
fn kept() -> QosProfile {
    qos().durability(Durability::TransientLocal).history(History::KeepLast { depth: 1 })
}

impl DriveNode {
    pub(super) fn new(
        joints: Vec<NamedJoint>,
        options: &RosOptions,
        read: Consumer<Snapshot>,
        targets: Option<Arc<Targets>>,
    ) -> Result<Self, RosError> {
        let mut dds = DomainParticipantBuilder::new(options.domain);
        if !options.networks.is_empty() {
            dds = dds.with_only_networks(options.networks.iter().copied());
        }
        let context = Context::from_domain_participant(dds.build().map_err(failed)?);
        let context = context.map_err(failed)?;
        let name = NodeName::new("/", "phihat").map_err(failed)?;
        let mut node = context.new_node(name, NodeOptions::new()).map_err(failed)?;
        let mut states = Vec::new();
        for (space, name, _) in STATES {
            let kind = ("sensor_msgs", "JointState");
            states.push(publisher(&mut node, (space, name), kind, &qos())?);
        }
        let modes = publisher(&mut node, ("/phihat", "mode"), ("std_msgs", "String"), &kept())?;
        let array = ("diagnostic_msgs", "DiagnosticArray");
        let diagnostics = publisher(&mut node, ("/", "diagnostics"), array, &qos())?;
        let asked = match targets {
            None => None,
            Some(targets) => {
                let array = ("std_msgs", "Float64MultiArray");
                let commands = subscription(&mut node, "commands", array)?;
                let along = ("trajectory_msgs", "JointTrajectory");
                let trajectories = subscription(&mut node, "joint_trajectory", along)?;
                Some(NodeSubscriptions { targets, commands, trajectories, way: None })
            }
        };
        let (counts, mode, told_ns, refusal) = (RosCounts::default(), None, None, None);
        thread::sleep(DISCOVERY);
        Ok(Self {
            _known: node,
            joints,
            read,
            states,
            modes,
            diagnostics,
            asked,
            counts,
            mode,
            told_ns,
            refusal,
        })
    }

    /// Publishes what comes until the drive is over.
    pub(super) fn run(&mut self) -> RosCounts {
        loop {
            // Asked before the last look: what is written afterwards would be missed else.
            let ended = self.read.is_abandoned();
            let mut any = false;
            while let Ok(shown) = self.read.pop() {
                any = true;
                self.listen(&shown);
                self.show(&shown);
            }
            if !any {
                if ended {
                    break;
                }
                thread::sleep(REST);
            }
        }
        thread::sleep(LINGER);
        self.counts
    }

    fn show(&mut self, shown: &Snapshot) {
        let stamp = Time::now();
        let joints = &shown.joints[..self.joints.len().min(shown.joints.len())];
        for (publisher, (_, _, signals)) in self.states.iter().zip(STATES) {
            let [position, velocity, effort] = signals.map(|signal| {
                signal.map_or_else(Vec::new, |signal| joints.iter().map(signal).collect())
            });
            let name = self.joints.iter().map(|(name, _)| name.clone()).collect();
            let header = Header { stamp, frame_id: String::new() };
            // Whoever does not listen misses it; a drive goes on.
            let _ = publisher.publish(JointState { header, name, position, velocity, effort });
        }
        self.counts.states += 1;
        self.counts.dropped = shown.dropped;
        let mode = shown.cycle.report.map_or("bare law", |report| report.mode.name());
        if self.mode != Some(mode) {
            self.mode = Some(mode);
            let _ = self.modes.publish(Text { data: mode.to_owned() });
            self.counts.modes += 1;
        }
        let t_ns = shown.cycle.t_ns;
        if self.told_ns.is_none_or(|told| t_ns >= told + DIAGNOSTICS_NS) {
            self.told_ns = Some(t_ns);
            let _ = self.diagnostics.publish(self.diagnosed(shown, mode, stamp));
            self.counts.diagnostics += 1;
        }
    }

    fn diagnosed(&self, shown: &Snapshot, mode: &str, stamp: Time) -> DiagnosticArray {
        let fault = shown.cycle.report.and_then(|report| report.fault);
        let fault = fault.map(|(fault, _)| fault.name());
        let pair = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
        let refused = self.refusal.as_ref().map_or_else(String::new, ToString::to_string);
        let (share, joint) = shown.largest;
        let joint = self.joints.get(joint).filter(|_| share > 0.0);
        let largest =
            joint.map_or_else(String::new, |(name, _)| format!("{:.0} % ({name})", 100.0 * share));
        let values = vec![
            pair("mode", mode.to_owned()),
            pair("samples lost", shown.lost.to_string()),
            pair("samples not published", shown.dropped.to_string()),
            pair("refused", self.counts.refused.to_string()),
            pair("refused last", refused),
            pair("largest error as a share of its bound", largest),
        ];
        let level =
            if fault.is_some() || share > 1.0 { 2 } else { u8::from(self.counts.refused > 0) };
        let status = DiagnosticStatus {
            level,
            name: "phihat".to_owned(),
            message: fault.unwrap_or(mode).to_owned(),
            hardware_id: String::new(),
            values,
        };
        let header = Header { stamp, frame_id: String::new() };
        DiagnosticArray { header, status: vec![status] }
    }

    /// Takes the requests, and sends the requested position of this time to the control thread.
    fn listen(&mut self, shown: &Snapshot) {
        let Some(asked) = &mut self.asked else { return };
        let mut newest = None;
        while let Ok(Some((command, _))) = asked.commands.take() {
            self.counts.commands += 1;
            newest = Some(TimedPositions::to(&self.joints, command.data));
            self.counts.refused += u64::from(newest.as_ref().is_some_and(Result::is_err));
        }
        while let Ok(Some((along, _))) = asked.trajectories.take() {
            self.counts.trajectories += 1;
            newest = Some(TimedPositions::along(&self.joints, &along));
            self.counts.refused += u64::from(newest.as_ref().is_some_and(Result::is_err));
        }
        let t_ns = shown.cycle.t_ns;
        match newest {
            Some(Ok(way)) => {
                let joints = shown.joints.iter().take(self.joints.len());
                asked.way = Some((way, t_ns, joints.map(|joint| joint.q_desired).collect()));
            }
            Some(Err(why)) => self.refusal = Some(why),
            None => {}
        }
        let Some((way, begun, from)) = &asked.way else { return };
        let (q, done) = way.at(t_ns.saturating_sub(*begun), from);
        asked.targets.ask(&q);
        if done {
            asked.way = None;
        }
    }
}

fn publisher<M: Serialize>(
    node: &mut ros2_client::Node,
    (space, name): (&str, &str),
    (package, message): (&str, &str),
    qos: &QosProfile,
) -> Result<Publisher<M>, RosError> {
    let name = Name::new(space, name).map_err(failed)?;
    let topic = node.create_topic(&name, MessageTypeName::new(package, message), qos);
    node.create_publisher(&topic.map_err(failed)?, None).map_err(failed)
}

fn subscription<M: 'static>(
    node: &mut ros2_client::Node,
    name: &str,
    (package, message): (&str, &str),
) -> Result<Subscription<M>, RosError> {
    let name = Name::new("/phihat", name).map_err(failed)?;
    let topic = node.create_topic(&name, MessageTypeName::new(package, message), &qos());
    node.create_subscription(&topic.map_err(failed)?, None).map_err(failed)
}
