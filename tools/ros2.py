"""`phihat drive --ros2` beside another DDS (PyPI's cyclonedds), on the loopback without multicast: every kind of message is received and sent, and
the counts of both sides are compared.

    python ros2.py FOLDER PHIHAT
"""

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

os.environ["CYCLONEDDS_URI"] = (
    '<CycloneDDS><Domain id="any"><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<MaxAutoParticipantIndex>30</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>'
)

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

DOMAIN = 41

STUDY = """
duration_s = 14.0
[robot]
name = "planar3r"
[spec]
settle_s = 1.0
[gains]
order = 1
bandwidth_rad_s = 15.0
estimator_bandwidth_rad_s = 40.0
inertia_kg_m2 = [0.42, 0.18, 0.14]
[world]
gravity_m_s2 = [0.0, 0.0, 0.0]
[supervisor]
error_stop_rad = 0.3
reference_velocity_max_rad_s = 0.5
reference_acceleration_max_rad_s2 = 2.0
reference_jerk_max_rad_s3 = 20.0
[reference]
kind = "hold"
pose = "ready"
"""


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Span(IdlStruct, typename="builtin_interfaces::msg::dds_::Duration_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclass
class Dimension(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayDimension_"):
    label: str
    size: uint32
    stride: uint32


@dataclass
class Layout(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayLayout_"):
    dim: sequence[Dimension]
    data_offset: uint32


@dataclass
class Array(IdlStruct, typename="std_msgs::msg::dds_::Float64MultiArray_"):
    layout: Layout
    data: sequence[float64]


@dataclass
class Point(IdlStruct, typename="trajectory_msgs::msg::dds_::JointTrajectoryPoint_"):
    positions: sequence[float64]
    velocities: sequence[float64]
    accelerations: sequence[float64]
    effort: sequence[float64]
    time_from_start: Span


@dataclass
class JointTrajectory(IdlStruct, typename="trajectory_msgs::msg::dds_::JointTrajectory_"):
    header: Header
    joint_names: sequence[str]
    points: sequence[Point]


QOS = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.Volatile, Policy.History.KeepLast(5000)
)
LATCHED = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal, Policy.History.KeepLast(10))
STATES = ["joint_states", "phihat/reference", "phihat/error", "phihat/torque_command", "phihat/phi_hat", "phihat/error_share"]


def trajectory(names: list[str], points: list[tuple[int, list[float]]]) -> JointTrajectory:
    all_points = [Point(q, [], [], [], Span(t, 0)) for t, q in points]
    return JointTrajectory(Header(Time(0, 0), ""), names, all_points)


def main() -> None:
    folder, phihat = Path(sys.argv[1]), sys.argv[2]
    study = folder / "ros2.toml"
    study.write_text(STUDY, encoding="utf-8")
    participant = DomainParticipant(DOMAIN)

    def reader(topic: str, kind: type, qos: Qos = QOS) -> DataReader:
        return DataReader(participant, Topic(participant, f"rt/{topic}", kind, qos=qos), qos=qos)

    def writer(topic: str, kind: type) -> DataWriter:
        return DataWriter(participant, Topic(participant, f"rt/{topic}", kind, qos=QOS), qos=QOS)

    readers = {topic: reader(topic, JointState) for topic in STATES}
    readers["phihat/mode"] = reader("phihat/mode", String, LATCHED)
    readers["diagnostics"] = reader("diagnostics", DiagnosticArray)
    commands, along = writer("phihat/commands", Array), writer("phihat/joint_trajectory", JointTrajectory)
    drive = [phihat, "drive", str(study), "--on", "sim", "--real-time", "--ros2", "--ros2-interface", "127.0.0.1"]
    drive += ["--ros2-domain", str(DOMAIN), "--out", str(folder / "driven"), "--json"]
    for check in ["certificate", "real-time", "rehearsal"]:
        drive += ["--accept", check]
    process = subprocess.Popen(drive, stdout=subprocess.PIPE, text=True)
    seen: dict[str, list] = {topic: [] for topic in readers}

    def take(seconds: float) -> None:
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            for topic, source in readers.items():
                # What has no data says that its writer is gone.
                seen[topic] += [m for m in source.take(1000) if type(m).__name__ in KINDS]
            time.sleep(0.002)

    while not seen["joint_states"]:
        take(0.1)
        assert process.poll() is None, "the drive ended before anything was received"
    take(1.0)
    start = list(seen["joint_states"][-1].position)
    names = list(seen["joint_states"][-1].name)
    goal = [start[0] + 0.2, start[1] - 0.1, start[2] + 0.1]
    sent = 50
    for k in range(sent):
        commands.write(Array(Layout([], 0), [q + (g - q) * (k + 1) / sent for q, g in zip(start, goal)]))
        take(0.02)
    take(1.5)
    there = list(seen["joint_states"][-1].position)
    # Joints in another order; then back.
    along.write(trajectory(names[::-1], [(1, goal[::-1]), (3, start[::-1])]))
    take(4.0)
    back = list(seen["joint_states"][-1].position)
    # What is no way for this arm is left out.
    along.write(trajectory(["nobody"], [(1, [0.0])]))
    along.write(trajectory(names, [(1, [99.0, 0.0, 0.0])]))
    along.write(trajectory(names, [(2, start), (1, start)]))
    commands.write(Array(Layout([], 0), [float("nan")] * 3))
    commands.write(Array(Layout([], 0), [0.0]))
    while process.poll() is None:
        take(0.1)
    take(0.5)
    told = json.loads(process.stdout.read())
    counts = told["ros2"]
    for topic in STATES:
        print(f"/{topic}: {len(seen[topic])} received of {counts['states']} published")
    print(f"/phihat/mode: {[m.data for m in seen['phihat/mode']]} of {counts['modes']}")
    print(f"/diagnostics: {len(seen['diagnostics'])} of {counts['diagnostics']}")
    print(f"commands {counts['commands']} of {sent + 2}, trajectories {counts['trajectories']} of 4, refused {counts['refused']} of 5")
    print("moved to", [round(q - g, 4) for q, g in zip(there, goal)], "and back", [round(q - s, 4) for q, s in zip(back, start)])
    # A volatile topic owes a reader nothing that was said before the two had met; from then on all of it, in order.
    stamps = {topic: [(m.header.stamp.sec, m.header.stamp.nanosec) for m in seen[topic]] for topic in STATES}
    whole = max(stamps.values(), key=len)
    assert len(whole) == counts["states"] and whole == sorted(whole), "lost, or out of order"
    for topic in STATES:
        late = len(whole) - len(stamps[topic])
        assert late <= 20 and stamps[topic] == whole[late:], topic
    assert counts["dropped"] == 0 and len(seen["diagnostics"]) == counts["diagnostics"]
    assert len(seen["phihat/mode"]) == counts["modes"] and seen["phihat/mode"][-1].data == "tracking"
    assert (counts["commands"], counts["trajectories"], counts["refused"]) == (sent + 2, 4, 5)
    assert max(abs(q - g) for q, g in zip(there, goal)) < 5e-3, "the commands did not move the arm"
    assert max(abs(q - s) for q, s in zip(back, start)) < 5e-3, "the trajectory did not lead back"
    steps = [abs(b.velocity[0] - a.velocity[0]) for a, b in zip(seen["phihat/reference"], seen["phihat/reference"][1:])]
    assert max(abs(m.velocity[0]) for m in seen["phihat/reference"]) <= 0.5 + 1e-9, "not shaped"
    assert max(steps) <= 2.0 * 2e-3 * 20, "not shaped"
    assert told["drive"]["end"] == "complete", told["drive"]["end"]
    last = seen["diagnostics"][-1].status[0]
    assert last.level == 1 and any(v.key == "refused" and v.value == "5" for v in last.values), last
    print("every kind of message went both ways")


KINDS = {"JointState", "String", "DiagnosticArray"}

if __name__ == "__main__":
    main()
