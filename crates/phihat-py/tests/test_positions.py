"""Gains of the law from positions: what is refused, by the argument's name; and that both classes run it."""

from __future__ import annotations

from typing import Any

import numpy as np
import phihat
import pytest

T = 1e-3


def stated(**changes: Any) -> dict[str, Any]:
    """Two joints: observer poles at 0.9, one sample of delay."""
    return {
        "joint_names": ["shoulder", "elbow"],
        "rate_hz": 1.0 / T,
        "inertia": [0.8, 0.5],
        "kp": [900.0, 400.0],
        "kd": [60.0, 40.0],
        "correction": [[0.271, 28.5, -1000.0]] * 2,
        "share": [0.5, 0.4],
        "delay_samples": [1, 1],
    } | changes


@pytest.mark.parametrize(
    ("field", "value", "found", "says"),
    [
        ("inertia", [0.8, -0.5], -0.5, "inertia .* is -0.5; it must be positive"),
        ("kp", [900.0, float("inf")], float("inf"), "kp .* is inf; it must be positive and finite"),
        ("kd", [60.0, 0.0], 0.0, "kd .* is 0; it must be positive"),
        ("correction", [[0.271, 28.5, -1000.0], [0.271, float("-inf"), -1000.0]], float("-inf"), r"correction\[1\] is -inf"),
        ("correction", [[0.271, 28.5, -1000.0], [0.271, 28.5, 1000.0]], None, "not stable"),
        ("correction", [[0.271, 28.5, -1000.0], [0.271, 28.5]], None, "2 corrections by position"),
        ("correction", [[0.271, 28.5, -1000.0], [0.1] * 6], None, "6 corrections by position"),
        ("share", [0.5, 0.0], 0.0, "share is 0; it must be positive"),
        ("share", [0.5, 1.5], 1.5, "share is 1.5; it must be above 0 and at most 1"),
        ("delay_samples", [1, 5], 5, "a delay of 5 samples"),
        ("velocity_correction", [[], [0.1, 0.2]], None, "3 corrections by position and 2 by velocity"),
        ("velocity_correction", [[], [0.0, 0.0, float("inf")]], float("inf"), r"velocity_correction\[2\] is inf"),
    ],
)
def test_what_cannot_be_is_refused(field: str, value: Any, found: Any, says: str) -> None:
    with pytest.raises(phihat.GainsError, match=says) as caught:
        phihat.PositionGains(**stated(**{field: value}))
    assert (caught.value.field, caught.value.joint, caught.value.value) == (field, "elbow", found)
    assert caught.value.limit


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("kp", [900.0], "kp: 1 values; it must be 2 values, one per joint"),
        ("correction", [[0.271, 28.5, -1000.0]] * 3, "correction: 3 values"),
        ("velocity_correction", [], "velocity_correction: 0 values"),
        ("joint_names", [], "there is none"),
        ("rate_hz", 0.0, "rate_hz: 0 Hz"),
        ("delay_samples", [1, -1], "a delay of -1 samples"),
    ],
)
def test_what_does_not_fit_is_refused(field: str, value: Any, says: str) -> None:
    with pytest.raises(phihat.ArgumentError, match=says) as caught:
        phihat.PositionGains(**stated(**{field: value}))
    assert caught.value.field == field


def test_gains_are_what_was_stated() -> None:
    told = stated(velocity_correction=[[], [0.0, 0.2, -15.0]])
    gains = phihat.PositionGains(**told)
    assert {name: getattr(gains, name) for name in told} == told
    assert repr(gains) == "PositionGains(2 joints, 1000 Hz)"
    assert phihat.PositionGains(**stated()).velocity_correction is None


def test_forms_and_kinds() -> None:
    gains = phihat.PositionGains(**stated())
    with pytest.raises(phihat.ArgumentError, match='form: "literal"; it must be left out'):
        phihat.Controller(gains, form="literal")
    for kind in (phihat.Controller, phihat.Supervisor):
        with pytest.raises(phihat.ArgumentError, match="gains: dict; they must be phihat.Gains or phihat.PositionGains"):
            kind({})  # type: ignore[arg-type]
        with pytest.raises(phihat.GainsError, match="elbow.*torque limit"):
            kind(gains, torque_max=[1.0, -1.0])


def test_it_holds_a_load_that_only_positions_tell() -> None:
    """Two joints under 6 and 2 N m, one sample of delay, no velocity: the estimate is the load, the error nothing."""
    gains = phihat.PositionGains(**stated())
    controller = phihat.Controller(gains, torque_max=[20.0, np.inf])
    assert controller.joint_names == ["shoulder", "elbow"] and controller.period == T
    assert controller.torque_max.tolist() == [20.0, np.inf]
    inertia, load, rest = np.array([0.7, 0.6]), np.array([6.0, 2.0]), np.zeros(2)
    q, dq, acting, coming = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    for _ in range(3000):
        tau = controller.update(q, rest, rest, rest, rest, acting)
        acting, coming = coming, tau
        ddq = (acting - load) / inertia
        q = q + T * (dq + 0.5 * T * ddq)
        dq = dq + T * ddq
    assert np.abs(q).max() < 1e-9 and np.abs(controller.phi_hat - load).max() < 1e-6


def test_it_runs_under_supervision() -> None:
    arm = phihat.Supervisor(phihat.PositionGains(**stated()))
    inertia, load, rest = np.array([0.8, 0.5]), np.array([6.0, 2.0]), np.zeros(2)
    q, dq, acting = np.zeros(2), np.zeros(2), load
    for k in range(3000):
        sample = (q, dq, rest, rest, rest, acting)
        # Some of the load is known for a while, then nothing is said, then far too much.
        known = (0.8 * load, None, 10.0 * load)[k // 1000]
        tau = arm.step(*sample, request="arm" if k < 10 else "hold", sequence=k, preset=load, feed_forward=known)
        assert np.abs(tau - load).max() < 1e-6 and (k < 10 or np.abs(arm.phi_hat - load).max() < 1e-6)
        ddq = (acting - load) / inertia
        q, dq, acting = q + T * (dq + 0.5 * T * ddq), dq + T * ddq, tau
    assert arm.mode == "holding" and arm.fault is None
    arm.step(*sample, request="hold", sequence=3000, feed_forward=np.full(2, np.nan))
    assert arm.events == ["reference-refused"] and np.abs(arm.tau - load).max() < 1e-6
    with pytest.raises(phihat.ArgumentError, match="feed_forward"):
        arm.step(*sample, request="hold", sequence=3001, feed_forward=np.zeros(3))
