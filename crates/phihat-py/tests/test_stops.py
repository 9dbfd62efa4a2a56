"""Stops of arms that others described, on MuJoCo's own physics: no state of the supervisor makes an arm faster than whoever pushes it.

``PHIHAT_STOPS=500`` for as many; ``cargo xtask test --all`` has 200.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np
import phihat
import pytest
from arms import load, middle
from fetch_arms import ARMS

STOPS = int(os.environ.get("PHIHAT_STOPS", "200" if "PHIHAT_ALL" in os.environ else "7"))
PERIOD = 1e-3
EVENT, END = 1200, 4200
TORQUE = 87.0
NOMINAL = 0.5
"""Nominal inertia of a joint, as a share of its entry on the diagonal of the inertia matrix."""
RATIO = (0.18, 6.0)
"""Range of true over nominal inertia, in any direction, in which the law below is stable: what a stop supposes."""


@dataclass
class Case:
    arm: str
    event: str
    joint: int
    size: float
    samples: int
    order: int
    speed: float
    load: float


def drawn(number: int) -> Case:
    dice = np.random.default_rng(number)
    arm = sorted(ARMS)[number % len(ARMS)]
    return Case(
        arm=arm,
        event=str(dice.choice(["asked", "push", "push", "lost", "nan", "torque", "drop"])),
        joint=int(dice.integers(0, 6)),
        size=float(dice.uniform(-60.0, 60.0)),
        samples=int(dice.integers(20, 400)),
        order=int(dice.integers(1, 3)),
        speed=float(dice.uniform(0.0, 0.6)),
        load=float(dice.uniform(0.1, 1.5)),
    )


def supervised(model: Any, data: Any, case: Case) -> phihat.Supervisor:
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, mass)
    n = model.nv
    estimator = [60.0] if case.order == 1 else [1600.0, 80.0]
    nominal = NOMINAL * np.diag(mass)
    gains = phihat.Gains(rate_hz=1000.0, inertia=list(nominal), kp=[400.0] * n, kd=[80.0] * n, a=[estimator] * n)
    return phihat.Supervisor(
        gains, torque_max=[TORQUE] * n, velocity_max=[4.0] * n, error_stop=[0.08] * n, first_motion=[4.0] * n, saturation=0.5
    )


def played(case: Case) -> tuple[bool, float, float, float] | None:
    """Whether it stopped; the most kinetic energy that it got in 50 ms beside a push, and the reserves [J]; the speed at the end [rad/s].

    None: the law is not stable where the stop begins, and nothing is promised.
    """
    model = load(case.arm, case.load)
    data = mujoco.MjData(model)
    center = middle(model)
    data.qpos[:] = center
    arm = supervised(model, data, case)
    n = model.nv
    inertia = np.zeros((n, n))
    mujoco.mj_fullM(model, data, inertia)
    nominal = NOMINAL * np.diag(inertia)
    reserves = 0.5 * float(nominal.sum()) * 0.2**2
    preset = np.array(data.qfrc_bias)
    tau, before, acted = preset.copy(), center.copy(), preset.copy()
    quantum, seen, omega = 2 * np.pi / 2**20, 0, 2 * np.pi * 0.4
    energies, stopped = [], False
    (hand,) = [b for b in range(model.nbody) if model.body(b).name == "payload"]
    for k in range(END):
        t = max(0.0, (k - 200) * PERIOD)
        after = 0 <= k - EVENT < case.samples
        if k == EVENT:
            mujoco.mj_fullM(model, data, inertia)
            ratios = np.linalg.eigvals(inertia / nominal[:, None]).real
            if ratios.min() < RATIO[0] or ratios.max() > RATIO[1]:
                return None
        if case.event == "drop" and k == EVENT:
            model.body_mass[hand] = 1e-6
            model.body_inertia[hand] = 1e-9
            mujoco.mj_setConst(model, mujoco.MjData(model))
        q = np.round(data.qpos / quantum) * quantum
        dq, told = (q - before) / PERIOD, acted.copy()
        if not (case.event == "lost" and after):
            seen, before = k, q
        if case.event == "nan" and after:
            q = q * np.nan
        if case.event == "torque" and after:
            told[case.joint] = 1e6 * np.sign(case.size)
        request: Literal["arm", "hold", "track", "stop"] = "arm" if k < 100 else "hold" if k < 110 else "track"
        if case.event == "asked" and k >= EVENT:
            request = "stop"
        amplitude = case.speed / omega
        motion = [amplitude * (1 - np.cos(omega * t)), case.speed * np.sin(omega * t), case.speed * omega * np.cos(omega * t)]
        if t == 0.0:
            motion = [0.0, 0.0, 0.0]
        wanted = [center + motion[0], np.full(n, motion[1]), np.full(n, motion[2])]
        coming = arm.step(
            q,
            dq,
            wanted[0],
            wanted[1],
            wanted[2],
            told,
            request=request,
            sequence=seen,
            t_ns=seen * 1_000_000,
            now_ns=k * 1_000_000,
            preset=preset,
        )
        assert np.isfinite(coming).all() and (np.abs(coming) <= TORQUE).all()
        # A torque acts one sample late.
        acted, tau = tau, np.array(coming)
        stopped = stopped or arm.mode == "safe-stop"
        push = np.zeros(n)
        if case.event == "push" and after:
            push[case.joint] = case.size
        data.qfrc_applied[:] = acted + push
        start = data.qpos.copy()
        if k < 100:
            # Something holds the arm until the law does.
            continue
        mujoco.mj_step(model, data)
        blind = case.event in ("lost", "nan") and after
        if stopped and not blind:
            mujoco.mj_energyVel(model, data)
            energies.append((data.energy[1], float(push @ (data.qpos - start))))
    kinetic = np.array([e for e, _ in energies])
    pushed = np.concatenate([[0.0], np.cumsum([w for _, w in energies])])[: len(kinetic)]
    own = kinetic - pushed
    gained = float((own[50:] - own[:-50]).max()) if len(own) > 50 else 0.0
    return stopped, gained, reserves, float(np.abs(data.qvel).max())


@pytest.mark.parametrize("part", range(2))
def test_a_stop_takes_energy_out_of_the_arm_and_leaves_it_at_rest(part: int) -> None:
    stops, without, misses = 0, 0, []
    for number in range(part, STOPS, 2):
        case = drawn(number)
        outcome = played(case)
        if outcome is None:
            without += 1
            continue
        stopped, gained, reserves, speed = outcome
        stops += stopped
        # Gravity is another one than half a second before, and acts on an arm that is not measured.
        most = reserves + (3.0 if case.event in ("lost", "nan", "drop") else 0.5)
        if stopped and (gained > most or speed > 0.1):
            misses.append((number, case, round(gained, 3), round(reserves, 3), round(speed, 3)))
    print(stops, "stopped,", without, "without a promise")
    assert not misses, "\n".join(map(str, misses))
    assert 5 * stops > STOPS / 2 and 5 * without < STOPS / 2
