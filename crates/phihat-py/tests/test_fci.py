"""`phihat serve --fci` under clients that nobody here wrote: libfranka 0.9 (protocol 5) and the newest (protocol 10), as their Python packages bundle
them. In lock-step: nothing here depends on the clock. Wrong if a loop did not run to its end, if the same torques left another trace,
or if a reflex did not end as libfranka documents it."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import phihat
import pylibfranka
import pytest
from panda_py import libfranka

PROGRAM = Path(os.environ.get("PHIHAT_PROGRAM", Path(__file__).parents[3] / "target/release/phihat"))
CYCLES = 10_000 if "PHIHAT_ALL" in os.environ else 3_000


@pytest.fixture(autouse=True)
def _ordinary_priority() -> Iterator[None]:
    """libfranka puts the thread that controls before all others (FIFO, 99) and leaves it there, where it may: the tests after it, and
    all that runs beside them, would stand still."""
    yield
    if hasattr(os, "sched_setscheduler"):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


STUDY = """
title = "A Franka for other people's clients"
duration_s = 10.0
[robot]
name = "panda"
[profile]
name = "robot"
[spec]
settle_s = 9.0
[gains]
order = 1
bandwidth_rad_s = 10.0
estimator_bandwidth_rad_s = 20.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 100.0
[world]
friction = "robot"
payload = { frame = "panda_link8", mass_kg = 0.5, com_m = [0.0, 0.0, 0.05] }
[reference]
kind = "sines"
center = "ready"
[[reference.sine]]
amplitude_rad = 0.05
frequency_hz = 0.1
phase_rad = 0.0
"""


# Gains with a tube, inside the robot's rule: what a Franka adds is not in the law.
CERTIFIED = """
title = "A certified law through other people's clients"
duration_s = 4.0
[robot]
name = "panda"
[profile]
name = "robot"
[spec]
settle_s = 1.5
error_bound_rad = 1e-3
[design]
payload_max_kg = 1.0
window_margin = 1.2
torque_step_max_nm = 1.0
[loop]
form = "observer"
rate_hz = 1000.0
delay_samples = 1
torque_rate_max_nm_s = "robot"
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 15.0
[world]
friction = "robot"
payload = { frame = "panda_link8", mass_kg = 0.5, com_m = [0.0, 0.0, 0.05] }
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.05
frequency_hz = [0.20, 0.25, 0.30, 0.22, 0.35, 0.40, 0.28]
phase_rad = 0.0
"""


class Served:
    """`phihat serve`, on an address of the loopback of its own: libfranka knows one port."""

    def __init__(self, folder: Path, patience_ms: int, cycles: int | None = None, text: str = STUDY) -> None:
        study = folder / "study.toml"
        study.write_text(text)
        number = os.getpid() % 65_000
        self.address = f"127.{1 + number // 250}.{1 + number % 250}.1"
        command = [str(PROGRAM), "serve", str(study), "--fci", "--json", "--listen", self.address]
        command += ["--csv", "--out", str(folder / "out"), "--patience-ms", str(patience_ms)]
        if cycles is not None:
            command += ["--cycles", str(cycles)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self.line()["listening"] == f"{self.address}:1337"
        self.trace = folder / "out/trace.csv"

    def line(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        told: dict[str, Any] = json.loads(self.process.stdout.readline())
        return told

    def motion(self) -> dict[str, Any]:
        while "motion" not in (told := self.line()):
            pass
        return told

    def close(self) -> None:
        self.process.kill()
        self.process.wait()


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    begun: list[Served] = []

    def begin(patience_ms: int, cycles: int | None = None, text: str = STUDY) -> Served:
        begun.append(Served(tmp_path, patience_ms, cycles, text))
        return begun[-1]

    yield begin
    for served in begun:
        served.close()


class Law:
    """A spring and a damper to the first posture seen, moved slowly on one joint; within 0.9 N·m per sample, and zero at first."""

    def __init__(self) -> None:
        self.start: list[float] | None = None
        self.tau = [0.0] * 7
        self.sample = 0
        self.sum = hashlib.sha256()

    def __call__(self, q: list[float], dq: list[float]) -> list[float]:
        self.start = self.start or list(q)
        for i, (stiffness, damping) in enumerate([(120.0, 20.0)] * 4 + [(40.0, 4.0)] * 3):
            wanted = self.start[i] + (1e-5 * min(self.sample, 5000) if i == 3 else 0.0)
            step = stiffness * (wanted - q[i]) - damping * dq[i] - self.tau[i]
            self.tau[i] += max(-0.9, min(0.9, step)) if self.sample else 0.0
        self.sample += 1
        self.sum.update(repr(self.tau).encode())
        return list(self.tau)


def newest(address: str) -> Any:
    return pylibfranka.Robot(address, pylibfranka.RealtimeConfig.kIgnore)


def oldest(address: str) -> Any:
    return libfranka.Robot(address, libfranka.RealtimeConfig.kIgnore)


def run_newest(robot: Any, law: Callable[[list[float], list[float]], list[float]], cycles: int) -> None:
    """Protocol 10: a loop that reads and writes."""
    control = robot.start_torque_control()
    try:
        for k in range(cycles):
            state, _ = control.readOnce()
            torques = pylibfranka.Torques(law(list(state.q), list(state.dq)))
            torques.motion_finished = k + 1 == cycles
            control.writeOnce(torques)
    finally:
        # As long as it lives, it holds the robot.
        del control


def run_oldest(robot: Any, law: Callable[[list[float], list[float]], list[float]], cycles: int) -> None:
    """Protocol 5: a loop that calls back."""
    count = 0

    def answer(state: Any, _duration: Any) -> Any:
        nonlocal count
        count += 1
        torques = libfranka.Torques(law(list(state.q), list(state.dq)))
        torques.motion_finished = count == cycles
        return torques

    robot.control(answer, limit_rate=False, cutoff_frequency=1000.0)


CLIENTS = pytest.mark.parametrize(
    ("protocol", "connect", "run"), [(10, newest, run_newest), (5, oldest, run_oldest)]
)


@CLIENTS
def test_ten_thousand_cycles_and_the_same_again(
    serve: Callable[..., Served], protocol: int, connect: Any, run: Any
) -> None:
    left = []
    for _ in range(2):
        served, law = serve(60_000, CYCLES), Law()
        run(connect(served.address), law, CYCLES)
        motion = served.motion()
        assert (motion["motion"], motion["cycles"]) == ("finished by the client", CYCLES)
        packets = motion["packets"]
        assert packets["lost"] == 0 and packets["taken"] == CYCLES
        assert served.process.wait() in (0, 1)
        trace = hashlib.sha256(served.trace.read_bytes()).hexdigest()
        left.append((law.sum.hexdigest(), trace))
        assert law.start is not None and abs(law.tau[3]) < 87.0
    assert left[0] == left[1]


@CLIENTS
def test_reflexes_end_as_libfranka_documents_and_recovery_leads_on(
    serve: Callable[..., Served], protocol: int, connect: Any, run: Any
) -> None:
    served = serve(60_000)
    robot = connect(served.address)

    def after(cycles: int, then: Callable[[int], float]) -> Callable[[list[float], list[float]], list[float]]:
        sample = -1

        def law(_q: list[float], _dq: list[float]) -> list[float]:
            nonlocal sample
            sample += 1
            return [0.0] * 6 + [0.0 if sample < cycles else then(sample - cycles)]

        return law

    provoked = [
        ("controller_torque_discontinuity", after(50, lambda _: 1.5)),
        ("joint_velocity_violation", after(50, lambda k: min(0.9 * k, 11.0))),
    ]
    for name, law in provoked:
        with pytest.raises(error(protocol), match=name) as told:
            run(robot, law, 9000)
        assert "libfranka: Move command aborted: motion aborted by reflex!" in str(told.value)
        assert served.motion()["motion"] == f"reflex: {name}"
        with pytest.raises(refusal(protocol), match='not possible in the current mode ..Reflex'):
            run(robot, after(50, lambda _: 0.0), 100)
        robot.automatic_error_recovery()
    run(robot, after(100, lambda _: 0.0), 100)
    assert served.motion()["cycles"] == 100


def error(protocol: int) -> type[Exception]:
    """What a motion that is aborted ends with; the older package has no type for it."""
    return pylibfranka.ControlException if protocol == 10 else RuntimeError


def refusal(protocol: int) -> type[Exception]:
    """What a motion that is not begun ends with."""
    return pylibfranka.CommandException if protocol == 10 else RuntimeError


@CLIENTS
def test_silence_ends_as_libfranka_documents(
    serve: Callable[..., Served], protocol: int, connect: Any, run: Any
) -> None:
    served, told = serve(20), list[dict[str, Any]]()
    robot = connect(served.address)

    def silent() -> None:
        told.clear()
        with pytest.raises(error(protocol), match="communication_constraints_violation") as ended:
            run(robot, law, 1000)
        assert "libfranka: Move command aborted: motion aborted by reflex!" in str(ended.value)

    def law(_q: list[float], _dq: list[float]) -> list[float]:
        # The second sample is not answered before the robot has given up.
        told.append({} if not told else served.motion())
        return [0.0] * 7

    silent()
    # A client that had no processor for 0.4 s was stopped before its silence: it has other tries.
    for _ in range(20):
        if len(told) == 2:
            break
        served.motion()
        robot.automatic_error_recovery()
        silent()
    assert [motion.get("motion") for motion in told] == [None, "reflex: communication_constraints_violation"]
    robot.automatic_error_recovery()
    assert "Idle" in str(robot.read_once().robot_mode)


def test_a_second_client_is_told_so(serve: Callable[..., Served]) -> None:
    served = serve(60_000)
    first = newest(served.address)
    with pytest.raises(Exception, match="Protocol error during connection attempt"):
        newest(served.address)
    with pytest.raises(Exception, match="Protocol error during connection attempt"):
        oldest(served.address)
    run_newest(first, Law(), 100)
    assert served.motion()["motion"] == "finished by the client"


@pytest.fixture(scope="module")
def certified(tmp_path_factory: pytest.TempPathFactory) -> phihat.Trace:
    """A run of gains with a tube: what the arm is told at each sample, and what is claimed."""
    study = tmp_path_factory.mktemp("certified") / "certified.toml"
    study.write_text(CERTIFIED)
    return phihat.simulate(study)


@CLIENTS
def test_phihat_through_the_official_client_stays_inside_its_tube(
    serve: Callable[..., Served], certified: phihat.Trace, protocol: int, connect: Any, run: Any
) -> None:
    gains = certified.gains
    assert gains.certificate is not None
    tube = gains.certificate["tube"]["joints"]
    wanted = [np.ascontiguousarray(certified[name]) for name in ("q_desired", "dq_desired", "ddq_desired")]
    cycles = len(certified.t)
    controller = phihat.Controller(gains)
    told = [np.zeros(7)] * 2

    def law(q: list[float], dq: list[float]) -> list[float]:
        k = len(told) - 2
        if k > 0:
            # Commands act one sample late, and the law is told of them as late.
            at, rate, change = (signal[k] for signal in wanted)
            tau = controller.update(np.array(q), np.array(dq), at, rate, change, told[-2])
        else:
            # A Franka begins at zero.
            tau = np.zeros(7)
        told.append(np.array(tau))
        return [float(torque) for torque in tau]

    served = serve(60_000, cycles, CERTIFIED)
    run(connect(served.address), law, cycles)
    motion = served.motion()
    assert (motion["cycles"], motion["verdict"]) == (cycles, "within_spec")
    with served.trace.open() as file:
        rows = [row for row in csv.DictReader(file) if float(row["t_s"]) >= 1.5]
    for joint in tube:
        errors = [abs(float(row["e_rad"])) for row in rows if row["joint"] == joint["name"]]
        share = max(errors) / joint["error_bound_rad"]
        print(f"{joint['name']}: {1e3 * max(errors):.3f} of {1e3 * joint['error_bound_rad']:.3f} mrad")
        assert 0.02 < share <= 1.0
