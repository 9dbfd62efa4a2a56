"""`phihat.drive`: robots that Python code talks to. Wrong if a drive over a link were not the run of the same world, or a MuJoCo arm
left what was promised."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import mujoco
import numpy as np
import phihat
import phihat.mujoco
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]

WORLD = """
duration_s = {duration}
[robot]
name = "planar3r"
[spec]
settle_s = 1.0
error_bound_rad = 0.05
[gains]
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 60.0
inertia_kg_m2 = [0.42, 0.18, 0.14]
[loop]
delay_samples = 1
torque_max_nm = 20.0
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 100.0
[world]
coulomb_extra_nm = 0.1
substeps = 2
gravity_m_s2 = [0.0, 0.0, 0.0]
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.5
"""

GUARD = "[supervisor]\nerror_stop_rad = 0.3\n"
GONE_PAST = ["certificate", "supervisor", "window"]


def written(folder: Path, duration: float = 2.0, guard: str = "") -> Path:
    path = folder / "world.toml"
    path.write_text(WORLD.format(duration=duration) + guard)
    return path


class InPlant:
    """phihat's own world through the door that other people's robots take, its joints the other way round."""

    name = "the plant"

    def __init__(self, study: Path) -> None:
        self.plant = phihat.Plant(study)
        self.joint_names = self.plant.joint_names[::-1]
        self.period = self.plant.period
        self.written = 0

    def read(self) -> tuple[Array, ...] | None:
        s = self.plant.sample
        return s.q[::-1], s.dq[::-1], s.tau_applied[::-1]

    def write(self, tau: Array) -> None:
        self.written += 1
        self.plant.step(tau[::-1])


def test_a_drive_over_a_link_is_the_run(tmp_path: Path) -> None:
    study = written(tmp_path)
    run = phihat.simulate(study, uncertified=True)
    link = InPlant(study)
    driven = phihat.drive(study, link, accept=GONE_PAST, out=tmp_path / "out")
    assert driven.drive["end"] == "complete" and driven.drive["lost"] == 0
    assert link.written == len(run.t) == len(driven.trace.t)
    for signal_name in ("q_measured", "q_desired"):
        assert np.array_equal(run[signal_name], driven.trace[signal_name]), signal_name
    # A drive differences positions by itself: the weight of its filter may be off in the last bit.
    for signal_name in ("dq_measured", "tau_command"):
        assert np.allclose(run[signal_name], driven.trace[signal_name], rtol=1e-12, atol=1e-12), signal_name
    # The error of a robot is the one that it measured.
    assert np.array_equal(driven.trace["e"], run["q_measured"] - run["q_desired"])
    assert (tmp_path / "out/drive.json").is_file() and (tmp_path / "out/report.html").is_file()


PANDA = """
duration_s = 5.0
[robot]
name = "panda"
[spec]
settle_s = 2.0
error_bound_rad = 5e-3
[design]
payload_max_kg = 1.0
window_margin = 1.1
[loop]
form = "observer"
delay_samples = 1
[world]
friction = "none"
[supervisor]
error_stop_rad = 0.2
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.15
frequency_hz = 0.25
"""


def test_an_arm_in_mujoco_keeps_its_bound(tmp_path: Path) -> None:
    """Gains for a described arm; the world is an engine that nobody here wrote, one sample late, with a payload that was not told."""
    study = tmp_path / "panda.toml"
    study.write_text(PANDA)
    robot = phihat.Robot.from_name("panda").with_payload("panda_link8", 0.6, [0.0, 0.0, 0.05], [1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3])
    model = phihat.mujoco.build(robot, damping=False, friction=False, timestep=5e-4)
    data = mujoco.MjData(model)
    data.qpos[:] = phihat.simulate(study)["q_desired"][0]
    arm = phihat.mujoco.Arm(model, data, rate_hz=1000.0, delay_samples=1)
    driven = phihat.drive(study, arm, out=tmp_path / "out")
    assert driven.good, driven
    e = np.abs(driven.trace["e"][driven.trace.t >= 2.0]).max(axis=0)
    print("errors over the specification's", (e / 5e-3).round(3), driven.drive["on"])
    assert 1e-5 < e.max() < 5e-3
    # After the motion the arm was brought to rest: those samples are the robot's, and not the record's.
    assert data.time * 1000.0 == pytest.approx(5000 + driven.drive["stop_samples"])
    assert np.abs(data.qvel).max() < 0.02


class Raises(InPlant):
    def read(self) -> tuple[Array, ...] | None:
        if self.written == 300:
            raise RuntimeError("the bus is gone")
        return super().read()


class Short(InPlant):
    def read(self) -> tuple[Array, ...] | None:
        return np.zeros(2), np.zeros(2)


class Elsewhere(InPlant):
    def read(self) -> tuple[Array, ...] | None:
        q, dq, tau = self.plant.sample.q, self.plant.sample.dq, self.plant.sample.tau_applied
        return q[::-1] + 0.2, dq[::-1], tau[::-1]


def test_what_a_link_raises_is_raised_once_the_record_is_written(tmp_path: Path) -> None:
    study = written(tmp_path)
    with pytest.raises(RuntimeError, match="the bus is gone"):
        phihat.drive(study, Raises(study), accept=GONE_PAST, out=tmp_path / "out", csv=True)
    assert [path.name for path in (tmp_path / "out").glob("trace.*")] == ["trace.csv"]
    assert len(phihat.read_run(tmp_path / "out").t) == 300


def test_links_that_cannot_be(tmp_path: Path) -> None:
    study = written(tmp_path)
    out = tmp_path / "out"
    with pytest.raises(ValueError, match=r"read\(\): q has 2 values for 3 joints"):
        phihat.drive(study, Short(study), accept=GONE_PAST, out=out)
    with pytest.raises(phihat.Error, match="stands at .* the motion begins at"):
        phihat.drive(study, Elsewhere(study), accept=GONE_PAST, out=out)
    with pytest.raises(phihat.Error, match="supervisor: nothing guards"):
        phihat.drive(study, InPlant(study), accept=["certificate", "window"], out=out)
    with pytest.raises(phihat.ArgumentError, match="no check; there are certificate"):
        phihat.drive(study, InPlant(study), accept=["everything"], out=out)
    slow = InPlant(study)
    slow.period = 2e-3
    with pytest.raises(phihat.Error, match="loop.rate_hz"):
        phihat.drive(study, slow, accept=GONE_PAST, out=out)
    other = InPlant(study)
    other.joint_names = ["a", "b", "c"]
    with pytest.raises(phihat.Error, match="is not among those of the link"):
        phihat.drive(study, other, accept=GONE_PAST, out=out)
    assert not out.exists()


class Lossy(InPlant):
    """Every tenth sample is lost; the arm goes on."""

    def read(self) -> tuple[Array, ...] | None:
        return None if self.written % 10 == 9 else super().read()


def test_lost_samples_are_told_as_lost(tmp_path: Path) -> None:
    study = written(tmp_path, guard=GUARD)
    driven = phihat.drive(study, Lossy(study), accept=["certificate", "window"], out=tmp_path / "out")
    assert driven.drive["lost"] == driven.drive["samples"] // 10
    assert driven.drive["end"] == "complete"


class Interrupts(InPlant):
    """Presses Ctrl-C, and from there on is no faster than a robot: whoever looks for signals has time to see it."""

    def read(self) -> tuple[Array, ...] | None:
        if self.written == 700:
            signal.raise_signal(signal.SIGINT)
        if self.written >= 700:
            time.sleep(1e-3)
        return super().read()


def test_ctrl_c_is_a_safe_stop(tmp_path: Path) -> None:
    study = written(tmp_path, duration=60.0, guard=GUARD)
    link = Interrupts(study)
    # A test that runs in the background of a shell is started with the signal ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            phihat.drive(study, link, accept=["certificate", "window"], out=tmp_path / "out")
    finally:
        signal.signal(signal.SIGINT, before)
    trace = phihat.read_run(tmp_path / "out")
    # When the signal is seen depends on the machine's clock; what comes of it does not: the arm is at rest within half a second.
    mode = np.array(trace.mode)
    stop = int(np.flatnonzero(mode == "safe-stop")[0])
    assert 700 < stop < len(mode) < 20_000
    assert (mode[stop:] == "safe-stop").all()
    assert np.abs(trace["dq"][-1]).max() < 0.05
    assert trace.t[-1] - trace.t[stop] < 0.51
