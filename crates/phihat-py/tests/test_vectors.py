"""The controller answers the project's test vectors with the same bits as Rust and C; and it is the law."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import phihat
import pytest

VECTORS = Path(__file__).parents[2] / "phihat" / "tests" / "vectors" / "controller.txt"

Line = tuple[str, list[str]]


def document(joints: list[list[str]], period: float) -> str:
    """A gains document from the vectors' joint lines."""
    records = []
    for number, (_form, order, inertia, kp, kd, *rest) in enumerate(joints):
        records.append(
            {
                "name": f"joint{number}",
                "inertia_kg_m2": float(inertia),
                "kp_per_s2": float(kp),
                "kd_per_s": float(kd),
                "a": [float(x) for x in rest[: int(order)]],
            }
        )
    return json.dumps(
        {
            "format": "phihat-gains",
            "version": 3,
            "study": "vectors",
            "study_sha256": "",
            "rate_hz": 1.0 / period,
            "method": "test vectors",
            "joints": records,
        }
    )


def seeing(joints: list[list[str]], period: float) -> phihat.PositionGains:
    """Gains of a law from positions from the vectors' joint lines."""
    records = []
    for _form, order, *rest in joints:
        states, numbers = int(order) + 2, [float(x) for x in rest]
        records.append((numbers[:3], numbers[3 : 3 + states], numbers[3 + states : 3 + 2 * states], numbers[3 + 2 * states :]))
    # Behind share and delay stand the number of sections, and four numbers of each.
    fours = [[rest[i : i + 4] for i in range(3, len(rest) - 2, 4)] for _, _, _, rest in records]
    filters = [[((c0, c1), (b0, b1)) for c0, c1, b0, b1 in own] for own in fours]
    filtered = joints[0][0] == "filtered"
    assert not filtered or [len(filter) for filter in filters] == [rest[2] for _, _, _, rest in records]
    return phihat.PositionGains(
        joint_names=[f"joint{number}" for number in range(len(joints))],
        rate_hz=1.0 / period,
        inertia=[outer[0] for outer, _, _, _ in records],
        kp=[outer[1] for outer, _, _, _ in records],
        kd=[outer[2] for outer, _, _, _ in records],
        correction=[position for _, position, _, _ in records],
        velocity_correction=[velocity for _, _, velocity, _ in records],
        share=[rest[0] for _, _, _, rest in records],
        delay_samples=[int(rest[1]) for _, _, _, rest in records],
        innovation_filter=filters if filtered else None,
    )


def cases() -> dict[str, list[Line]]:
    found: dict[str, list[Line]] = {}
    for line in VECTORS.read_text().splitlines():
        if line.startswith("#"):
            continue
        verb, *words = line.split()
        if verb == "case":
            found[words[0]] = []
        list(found.values())[-1].append((verb, words))
    return found


CASES = cases()


@pytest.mark.parametrize("name", CASES)
def test_same_bits(name: str) -> None:
    lines = CASES[name]
    joints = [words for verb, words in lines if verb == "joint"]
    period, n = float(lines[0][1][2]), len(joints)
    torque_max, torque_rate_max = ([float(words[at]) for words in joints] for at in (-2, -1))
    controller = (
        phihat.Controller(seeing(joints, period), torque_max=torque_max, torque_rate_max=torque_rate_max)
        if joints[0][0] in ("positions", "filtered")
        else phihat.Controller(
            phihat.Gains.from_json(document(joints, period)),
            torque_max=torque_max,
            torque_rate_max=torque_rate_max,
            form="literal" if joints[0][0] == "literal" else "observer",
        )
    )
    answers = 0
    tau = np.zeros(n)
    refused = False
    for verb, words in lines:
        numbers = np.array([float(x) for x in words]) if verb in ("sample", "resume", "answer") else np.empty(0)
        if verb in ("sample", "resume"):
            q, dq, tau_applied, q_des, dq_des, ddq_des = numbers[: 6 * n].reshape(6, n)
        if verb == "resume":
            controller.resume(q, dq, q_des, dq_des, ddq_des, numbers[6 * n :])
        if verb == "sample":
            try:
                tau, refused = controller.update(q, dq, q_des, dq_des, ddq_des, tau_applied), False
            except phihat.SampleRefused as why:
                assert why.tau is not None and why.field == "dq" and why.joint == f"joint{n - 1}"
                tau, refused = why.tau, True
        if verb == "answer":
            want_tau, want_phi, flags = numbers.reshape(3, n)
            assert tau.tobytes() == want_tau.tobytes()
            assert controller.phi_hat.tobytes() == want_phi.tobytes()
            assert (flags == 4).all() if refused else (flags < 4).all()
            if not refused:
                assert (controller.saturated == (flags.astype(int) & 1 > 0)).all()
                assert (controller.rate_limited == (flags.astype(int) & 2 > 0)).all()
            answers += 1
    assert answers == 40


def test_the_law_written_down_again() -> None:
    """(T1), (T4) for order 2 with sampled poles, from the text of the theory, not from the code."""
    inertia, kp, kd, w, period = 0.8, 400.0, 40.0, 70.0, 1e-3
    words = ["observer", "2", str(inertia), str(kp), str(kd), str(w * w), str(2 * w), "inf", "inf"]
    controller = phihat.Controller(phihat.Gains.from_json(document([words], period)))
    pole = (np.exp(-w * period) - 1.0) / period  # both poles of δ² + α₁ δ + α₀
    alpha = [pole * pole, -2.0 * pole]
    random = np.random.default_rng(5)
    memory, last, tau = np.zeros(2), 0.0, 0.0
    for k in range(300):
        q, dq, q_des, dq_des, ddq_des, applied = random.normal(size=6)
        if k > 0:
            innovation = period * (applied - memory[0]) - inertia * (dq - last)
            memory = np.array(
                [memory[0] + period * memory[1] + alpha[1] * innovation, memory[1] + alpha[0] * innovation]
            )
        last = dq
        tau = inertia * (ddq_des - kd * (dq - dq_des) - kp * (q - q_des)) + memory[0]
        one = np.array([[q], [dq], [q_des], [dq_des], [ddq_des], [applied]])
        answer = controller.update(one[0], one[1], one[2], one[3], one[4], one[5])
        assert answer[0] == pytest.approx(tau, rel=1e-9, abs=1e-9)
