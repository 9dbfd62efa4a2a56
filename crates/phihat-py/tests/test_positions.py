"""Gains of the law from positions: what is refused, by the argument's name; and that both classes run it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import phihat
import pytest
from numpy.typing import NDArray

T = 1e-3
NAN = float("nan")
SECTION = ((0.02, 0.3), (800.0, -300.0))
OTHER = ((0.5, 1.2), (2500.0, 90.0))


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
        ("innovation_filter", [[SECTION], [SECTION] * 3], 3, "3 sections of an innovation filter"),
        ("innovation_filter", [[], [SECTION, ((0.3, 0.02), (1.0, 0.0))]], None, "section 1 of the innovation filter is not stable"),
        ("innovation_filter", [[], [((0.02, float("nan")), (1.0, 0.0))]], NAN, "section 0 of the innovation filter is NaN"),
        ("innovation_filter", [[], [SECTION, ((0.02, 0.3), (1.0, float("inf")))]], float("inf"), "section 1 .* is inf"),
    ],
)
def test_what_cannot_be_is_refused(field: str, value: Any, found: Any, says: str) -> None:
    with pytest.raises(phihat.GainsError, match=says) as caught:
        phihat.PositionGains(**stated(**{field: value}))
    assert (caught.value.field, caught.value.joint) == (field, "elbow")
    assert caught.value.value == found or found is NAN and np.isnan(caught.value.value)
    assert caught.value.limit


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("kp", [900.0], "kp: 1 values; it must be 2 values, one per joint"),
        ("correction", [[0.271, 28.5, -1000.0]] * 3, "correction: 3 values"),
        ("velocity_correction", [], "velocity_correction: 0 values"),
        ("innovation_filter", [[SECTION]], "innovation_filter: 1 values"),
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
    told = stated(velocity_correction=[[], [0.0, 0.2, -15.0]], innovation_filter=[[SECTION, OTHER], []])
    gains = phihat.PositionGains(**told)
    assert {name: getattr(gains, name) for name in told} == told
    # As a document of gains has them: lists.
    listed = phihat.PositionGains(**stated(innovation_filter=[[[[0.02, 0.3], [800.0, -300.0]]], []]))
    assert listed.innovation_filter == [[SECTION], []]
    assert phihat.PositionGains(**stated()).innovation_filter is None
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


def assert_holds_a_load(controller: phihat.Controller, inertia: NDArray[np.float64]) -> None:
    """Two joints under 6 and 2 N m, one sample of delay, no velocity: the estimate is the load, the error nothing."""
    load, rest = np.array([6.0, 2.0]), np.zeros(2)
    q, dq, acting, coming = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    for _ in range(3000):
        tau = controller.update(q, rest, rest, rest, rest, acting)
        acting, coming = coming, tau
        ddq = (acting - load) / inertia
        q = q + T * (dq + 0.5 * T * ddq)
        dq = dq + T * ddq
    assert np.abs(q).max() < 1e-9 and np.abs(controller.phi_hat - load).max() < 1e-6


def test_it_holds_a_load_that_only_positions_tell() -> None:
    gains = phihat.PositionGains(**stated())
    controller = phihat.Controller(gains, torque_max=[20.0, np.inf])
    assert controller.joint_names == ["shoulder", "elbow"] and controller.period == T
    assert controller.torque_max.tolist() == [20.0, np.inf]
    assert_holds_a_load(controller, np.array([0.7, 0.6]))


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


def documented(filters: list[list[tuple[tuple[float, float], tuple[float, float]]]]) -> phihat.Gains:
    """The same laws as a document of gains."""
    said = stated()
    joints = []
    for j, name in enumerate(said["joint_names"]):
        sections = [{"rates": rates, "weights_per_s2": weights} for rates, weights in filters[j]]
        observer = {"correction": said["correction"][j], "share": said["share"][j], "delay_samples": 1}
        if sections:
            observer["innovation_filter"] = sections
        outer = {"inertia_kg_m2": said["inertia"][j], "kp_per_s2": said["kp"][j], "kd_per_s": said["kd"][j]}
        joints.append({"name": name, **outer, "a": [], "observer": observer})
    about = {"format": "phihat-gains", "version": 3, "study": "", "study_sha256": "", "method": "by hand"}
    return phihat.Gains.from_json(json.dumps({**about, "rate_hz": 1.0 / T, "joints": joints}))


def test_a_filter_is_the_same_from_a_document_and_its_difference_equation() -> None:
    """What a filter adds to the torque of a law with share 1 and no delay, of which ``nu`` is known from the torques alone."""
    changes = {"share": [1.0, 1.0], "delay_samples": [0, 0]}
    filters = [[SECTION, OTHER], []]
    random, rest = np.random.default_rng(3), np.zeros(2)
    plain, filtered = (
        phihat.Controller(phihat.PositionGains(**stated(**changes, innovation_filter=filter))) for filter in (None, filters)
    )
    state, estimate = np.zeros((2, 2)), np.zeros(3)
    for k in range(300):
        q, tau = random.normal(size=2), random.normal(size=2)
        more = filtered.update(q, rest, rest, rest, rest, tau) - plain.update(q, rest, rest, rest, rest, tau)
        # The observer of the first joint, written down again.
        e, de, phi = estimate
        if k > 0:
            a = (tau[0] - phi) / 0.8
            e, de = e + T * de + 0.5 * T * T * a, de + T * a
            nu = q[0] - e
            e, de, phi = e + 0.271 * nu, de + 28.5 * nu, phi - 0.8 * 1000.0 * nu
            for own, (c, _) in zip(state, (SECTION, OTHER), strict=True):
                own[:] = own[0] + own[1], own[1] + nu - c[0] * own[0] - c[1] * own[1]
        else:
            e = q[0]
        estimate = np.array([e, de, phi])
        wanted = 0.8 * sum(np.dot(b, own) for own, (_, b) in zip(state, (SECTION, OTHER), strict=True))
        assert more == pytest.approx([wanted, 0.0], rel=1e-9, abs=1e-9)
    # One document, the same bits; and through the text once more.
    with_delay = phihat.Controller(phihat.PositionGains(**stated(innovation_filter=filters)))
    gains = documented(filters)
    others = [phihat.Controller(gains), phihat.Controller(phihat.Gains.from_json(gains.to_json()))]
    for _ in range(100):
        q, tau = random.normal(size=2), random.normal(size=2)
        answer = with_delay.update(q, rest, rest, rest, rest, tau)
        for other in others:
            assert other.update(q, rest, rest, rest, rest, tau).tobytes() == answer.tobytes()


def test_a_filtered_law_holds_a_load_without_error() -> None:
    gains = phihat.PositionGains(**stated(innovation_filter=[[SECTION, OTHER], [SECTION]]))
    controller = phihat.Controller(gains)
    assert_holds_a_load(controller, np.array([0.8, 0.5]))
