"""The supervisor: what it lets through is the law, what it does not is told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import phihat
import pytest

STUDIES = Path(__file__).parents[3] / "studies"
N = 3


@pytest.fixture(scope="module")
def gains() -> phihat.Gains:
    return phihat.simulate(STUDIES / "first.toml").gains


def rest(**changes: Any) -> dict[str, Any]:
    return {name: np.zeros(N) for name in ("q", "dq", "q_des", "dq_des", "ddq_des", "tau_applied")} | changes


def tracking(gains: phihat.Gains, **options: Any) -> tuple[phihat.Supervisor, int]:
    arm = phihat.Supervisor(gains, **options)
    assert arm.mode == "idle" and arm.brake
    for k in range(700):
        arm.step(**rest(), request="arm" if k == 0 else "hold" if k < 10 else "track", sequence=k)
    assert arm.mode == "tracking" and not arm.brake and arm.fault is None
    return arm, 700


def test_the_law_is_inside(gains: phihat.Gains) -> None:
    """Once it tracks, a small excursion gives the torque of the bare controller, to rounding."""
    arm, k = tracking(gains)
    bare = phihat.Controller(gains)
    for _ in range(700):
        bare.update(**rest())
    rng = np.random.default_rng(2)
    q = np.zeros(N)
    for k in range(k, k + 50):
        q = q + 1e-5 * rng.normal(size=N)
        sample = rest(q=q, dq=1e-3 * rng.normal(size=N), tau_applied=bare.tau)
        np.testing.assert_allclose(arm.step(**sample, request="track", sequence=k), bare.update(**sample), atol=1e-9)


def test_not_a_number_is_judged_and_stops_the_arm(gains: phihat.Gains) -> None:
    arm, k = tracking(gains)
    held = arm.step(**rest(q=np.array([0.0, np.nan, 0.0])), request="track", sequence=k)
    assert np.isfinite(held).all() and "not-finite" in arm.events and arm.mode == "tracking" and arm.misses == 1
    for k in range(k + 1, k + 5):
        arm.step(**rest(q=np.array([0.0, np.nan, 0.0])), request="track", sequence=k)
    assert arm.mode == "safe-stop" and arm.fault is not None and arm.fault[0] == "bad-sample"
    arm.step(**rest(), request="track", sequence=k + 1)
    assert arm.mode == "safe-stop" and arm.refusal == "latched" and "refused" in arm.events


def test_a_lost_link_stops_after_as_many_samples_as_said(gains: phihat.Gains) -> None:
    arm, k = tracking(gains, stop_samples=7)
    for missed in range(1, 7):
        arm.step(**rest(), request="track", sequence=k - 1)
        assert (arm.mode, arm.misses) == ("tracking", missed)
    arm.step(**rest(), request="track", sequence=k - 1)
    assert arm.mode == "safe-stop" and arm.fault is not None and arm.fault[0] == "link-lost"


def test_limits_stop_the_arm(gains: phihat.Gains) -> None:
    arm, k = tracking(gains, position_range=[(-1.0, 1.0)] * N, velocity_max=[2.0] * N, error_stop=[0.01, 0.02, 0.03])
    arm.step(**rest(q=np.array([0.0, 0.5, 0.0])), request="track", sequence=k)
    assert "implausible" in arm.events and arm.mode == "tracking", "no joint jumps by half a radian"
    q = np.zeros(N)
    for k in range(k + 1, k + 40):
        q = q + np.array([0.0, 0.0015, 0.0])
        arm.step(**rest(q=q, dq=np.array([0.0, 1.5, 0.0])), request="track", sequence=k)
        if arm.mode == "safe-stop":
            break
    assert arm.fault == ("tracking-error", "joint2") and 0.02 < q[1] < 0.025


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"velocity_max": [1.0]}, "velocity_max: 1 values; it must be 3 values"),
        ({"velocity_max": [1.0, -1.0, 1.0]}, "velocity limit is -1"),
        ({"position_range": [(0.0, 1.0), (1.0, 0.0), (0.0, 1.0)]}, "width of the range is -1"),
        ({"reference_limits": (1.0, 0.0, 1.0)}, "must be positive"),
        ({"blend": float("nan")}, "blend time is NaN"),
        ({"stop_samples": 0}, "stop samples is 0"),
        ({"torque_max": [1.0, 2.0]}, "torque_max: 2 values"),
    ],
)
def test_options(gains: phihat.Gains, options: dict[str, Any], says: str) -> None:
    with pytest.raises(phihat.ArgumentError, match=says):
        phihat.Supervisor(gains, **options)


def test_steps(gains: phihat.Gains) -> None:
    arm = phihat.Supervisor(gains)
    with pytest.raises(phihat.ArgumentError, match='request: "go"'):
        arm.step(**rest(), request="go", sequence=0)  # type: ignore[arg-type]
    with pytest.raises(phihat.ArgumentError, match="dq: shape"):
        arm.step(**rest(dq=np.zeros(4)), request="idle", sequence=0)
    arm.step(**rest(), request="track", sequence=0)
    assert arm.mode == "idle" and arm.refusal == "not-armed"
