"""What cannot be is refused with an exception that says what, where, which value, and what would be right."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import phihat
import pytest

STUDIES = Path(__file__).parents[3] / "studies"


@pytest.fixture(scope="module")
def gains() -> phihat.Gains:
    return phihat.simulate(STUDIES / "first.toml").gains


def good(n: int = 3) -> dict[str, Any]:
    return {name: np.zeros(n) for name in ("q", "dq", "q_des", "dq_des", "ddq_des")}


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("q", np.zeros(4), r"q: shape \[4\]; it must be \(3,\)"),
        ("dq", np.zeros((3, 1)), "array of float64 with 2 axes"),
        ("q_des", np.zeros(3, dtype=np.float32), "array of float32"),
        ("dq_des", np.zeros(3, dtype=int), "array of int64"),
        ("ddq_des", [0.0, 0.0, 0.0], "ddq_des: list"),
        ("q", None, "q: NoneType"),
    ],
)
def test_samples(gains: phihat.Gains, field: str, value: Any, says: str) -> None:
    controller = phihat.Controller(gains)
    with pytest.raises(phihat.ArgumentError, match=says) as caught:
        controller.update(**(good() | {field: value}))
    assert caught.value.field == field and caught.value.limit
    assert (controller.tau == 0).all()


def test_not_finite_holds_the_last_torque(gains: phihat.Gains) -> None:
    controller = phihat.Controller(gains)
    tau = controller.update(**(good() | {"q_des": np.full(3, 0.01)}))
    assert (tau > 0).all()
    with pytest.raises(phihat.SampleRefused, match="dq_des: inf at joint joint2") as caught:
        controller.update(**(good() | {"dq_des": np.array([0.0, np.inf, 0.0])}))
    assert caught.value.joint == "joint2" and caught.value.value == np.inf
    assert caught.value.tau is not None and (caught.value.tau == tau).all()
    again = phihat.Controller(gains)
    again.update(**(good() | {"q_des": np.full(3, 0.01)}))
    assert (controller.update(**good()) == again.update(**good())).all(), "the state was untouched"


def test_stamps_go_forward_by_three_periods_at_most(gains: phihat.Gains) -> None:
    controller = phihat.Controller(gains)
    controller.update(**good(), t_ns=5_000_000)
    controller.update(**good(), t_ns=8_000_000)
    for t in (8_000_000, 7_000_000, 11_000_001):
        with pytest.raises(phihat.ArgumentError, match="t_ns") as caught:
            controller.update(**good(), t_ns=t)
        assert caught.value.value == t
    controller.update(**good(), t_ns=9_000_000)


def test_limits_and_forms(gains: phihat.Gains) -> None:
    with pytest.raises(phihat.ArgumentError, match="torque_max: 2 values"):
        phihat.Controller(gains, torque_max=[1.0, 2.0])
    with pytest.raises(phihat.GainsError, match="joint2.*torque limit") as caught:
        phihat.Controller(gains, torque_max=[1.0, -2.0, 3.0])
    assert (caught.value.joint, caught.value.value) == ("joint2", -2.0)
    with pytest.raises(phihat.ArgumentError, match="form"):
        phihat.Controller(gains, form="pid")  # type: ignore[arg-type]
    limited = phihat.Controller(gains, torque_max=[1.0, 2.0, np.inf])
    tau = limited.update(**(good() | {"q_des": np.ones(3)}))
    assert (np.abs(tau[:2]) == [1.0, 2.0]).all() and limited.saturated.tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("q", "says"),
    [
        (np.zeros(6), r"q: shape \[6\]; it must be \(\.\.\., 7\)"),
        (np.zeros((2, 6)), "it must be"),
        (np.zeros(7, dtype=complex), "array of complex128"),
        ([0.0] * 6 + [float("nan")], "NaN at joint panda_joint7"),
        ("posture", "q: str"),
    ],
)
def test_postures(q: Any, says: str) -> None:
    with pytest.raises(phihat.ArgumentError, match=says) as caught:
        phihat.Robot.from_name("panda").mass_matrix(q)
    assert caught.value.field == "q"


def test_batches_that_do_not_fit() -> None:
    robot = phihat.Robot.from_name("ur5")
    with pytest.raises(phihat.ArgumentError, match="dq: shape"):
        robot.bias(np.zeros((4, 6)), np.zeros((5, 6)))


def test_robots(tmp_path: Path) -> None:
    with pytest.raises(phihat.RobotError, match='did you mean "panda"'):
        phihat.Robot.from_name("pandas")
    with pytest.raises(phihat.RobotError, match="cannot be read"):
        phihat.Robot.from_file(tmp_path / "none.urdf")
    robot = phihat.Robot.from_name("panda")
    with pytest.raises(phihat.ArgumentError, match="there is no \"hand\""):
        robot.frame_pose(np.zeros(7), "hand")
    with pytest.raises(phihat.ArgumentError, match="mass is -1"):
        robot.with_payload("panda_link8", -1.0, [0, 0, 0], [0] * 6)
    with pytest.raises(phihat.RobotError, match="there is none") as caught:
        robot.with_locked({"joint9": 0.0})
    assert caught.value.joint == "joint9"
    with pytest.raises(phihat.ArgumentError, match="gravity"):
        phihat.Robot.from_name("panda", gravity=(0.0, 0.0, np.nan))


def test_studies(tmp_path: Path) -> None:
    broken = tmp_path / "broken.toml"
    broken.write_text("duration_s = 1.0\nseeed = 2\n")
    with pytest.raises(phihat.StudyError, match="unknown key; did you mean `seed`") as caught:
        phihat.simulate(broken)
    assert (caught.value.line, caught.value.field) == (2, "seeed")
    with pytest.raises(phihat.StudyError, match="reference"):
        phihat.simulate({"duration_s": 1.0})
    with pytest.raises(phihat.ArgumentError, match="a path or a dictionary"):
        phihat.simulate(3)  # type: ignore[arg-type]
    with pytest.raises(phihat.ArgumentError, match="type set"):
        phihat.simulate({"duration_s": {1.0}})
    with pytest.raises(phihat.ArgumentError, match="not a study's document"):
        phihat.simulate({"duration_s": None})


def test_gains(tmp_path: Path) -> None:
    with pytest.raises(phihat.ArgumentError, match="cannot be read"):
        phihat.Gains.from_file(tmp_path / "none.json")
    with pytest.raises(phihat.GainsError, match="line 1"):
        phihat.Gains.from_json("{")
    with pytest.raises(phihat.ArgumentError, match="no certificate"):
        phihat.simulate(STUDIES / "first.toml").gains.verify()


def test_a_gate_lets_nothing_out_beyond_its_limits() -> None:
    gate = phihat.Gate(rate_hz=1000.0, torque_max=[87.0, 12.0], torque_rate_max=[1000.0, np.inf], energy_max_j=2.0)
    gate.hold(np.array([10.0, 0.0]))
    tau = gate.release(np.zeros(2), np.array([50.0, np.nan]))
    assert tau.tolist() == [11.0, 0.0]
    assert gate.rate_limited.tolist() == [True, False] and gate.refused.tolist() == [False, True]
    # 12 N m over 0.05 rad per sample are 0.6 J per sample: more than 2 J in 0.1 s.
    given = 0.0
    for k in range(1, 40):
        given += float(gate.release(np.array([0.0, 0.05 * k]), np.array([0.0, 1e6]))[1]) * 0.05
    assert gate.saturated[1] and 1.0 < given < 2.0
    with pytest.raises(phihat.ArgumentError, match="energy_max_j"):
        phihat.Gate(rate_hz=1000.0, torque_max=[1.0], energy_max_j=-1.0)
    with pytest.raises(phihat.ArgumentError, match="torque_rate_max"):
        phihat.Gate(rate_hz=1000.0, torque_max=[1.0, 2.0], torque_rate_max=[1.0])
