"""The controller on MuJoCo's own physics: on arms that others described, inside the bounds certified for them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import phihat
import pytest
from arms import load, middle, written
from fetch_arms import ARMS
from phihat.mujoco import attach, build

DESIGNED = ARMS if "PHIHAT_ALL" in os.environ else ()
"""A design takes half a minute: `cargo xtask test --all` has them."""

PAYLOAD_MAX_KG = 1.0
PAYLOAD_KG = 0.6
AMPLITUDE, FREQUENCY = 0.2, 0.25
SETTLE, END = 2.0, 6.0


class Sine:
    """A sine on every joint, and the study's words for it."""

    def __init__(self, center: Any) -> None:
        self.center = np.array(center, dtype=float)
        self.words = {
            "kind": "sines",
            "center_rad": self.center,
            "fade_in_s": 0.0,
            "sine": [{"amplitude_rad": AMPLITUDE, "frequency_hz": FREQUENCY}],
        }

    def __call__(self, t: float) -> tuple[Any, Any, Any]:
        w, ones = 2.0 * np.pi * FREQUENCY, np.ones_like(self.center)
        s, c = AMPLITUDE * np.sin(w * t), AMPLITUDE * np.cos(w * t)
        return self.center + s * ones, w * c * ones, -w * w * s * ones


_GAINS: dict[str, phihat.Gains] = {}


def design(path: Path, motion: Sine) -> phihat.Gains:
    """Gains from the description alone: a bound of 5 mrad, and any payload up to a kilogram. Once for each arm."""
    if path.stem not in _GAINS:
        _GAINS[path.stem] = _design(path, motion)
    return _GAINS[path.stem]


def _design(path: Path, motion: Sine) -> phihat.Gains:
    return phihat.design(
        {
            "duration_s": END,
            "robot": {"file": str(path), "tip": "right_hand"},
            "spec": {"settle_s": SETTLE, "error_bound_rad": 5e-3},
            "design": {"payload_max_kg": PAYLOAD_MAX_KG, "window_margin": 1.1},
            "world": {"substeps": 20},
            "reference": motion.words,
        }
    )


def track(model: Any, gains: phihat.Gains, motion: Sine) -> Any:
    """Largest error of each joint after the transient, at every step of a run."""
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], _ = motion(0.0)
    attached = attach(model, data, gains, reference=motion)
    worst = np.zeros(model.nq)
    while data.time < END:
        attached.update()
        mujoco.mj_step(model, data)
        if data.time > SETTLE:
            worst = np.maximum(worst, np.abs(data.qpos - motion(data.time)[0]))
    assert attached.samples == round(END * gains.rate_hz)
    return worst


@pytest.mark.parametrize("arm", DESIGNED)
def test_bounds_hold_with_a_payload_that_was_not_told(arm: str, tmp_path: Path) -> None:
    bare = load(arm)
    (tmp_path / f"{arm}.xml").write_text(written(arm))
    motion = Sine(middle(bare))
    gains = design(tmp_path / f"{arm}.xml", motion)
    gains.verify()
    model = load(arm, PAYLOAD_KG)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    worst = track(model, gains, motion)
    share = worst / np.array(gains.error_bound)
    print(arm, "errors over bounds", share.round(2))
    assert share.max() <= 1.0
    assert worst.max() <= 5e-3


@pytest.fixture(scope="module")
def arm() -> tuple[phihat.Gains, Sine]:
    gains = phihat.Gains(
        rate_hz=1000.0,
        inertia=[1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212],
        kp=[400.0] * 7,
        kd=[40.0] * 7,
        a=[[2500.0, 100.0]] * 7,
        joint_names=[f"joint{i}" for i in range(1, 8)],
    )
    return gains, Sine(middle(load("panda")))


def ready(motion: Sine, **options: Any) -> tuple[Any, Any]:
    model = load("panda", PAYLOAD_KG, **options)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], _ = motion(0.0)
    return model, data


def test_callback_and_explicit_updates_are_the_same(arm: tuple[phihat.Gains, Sine]) -> None:
    gains, motion = arm
    ends = []
    for by_callback in (True, False):
        model, data = ready(motion, timestep=5e-4)
        attached = attach(model, data, gains, reference=motion)
        if by_callback:
            with attached:
                for _ in range(600):
                    mujoco.mj_step(model, data)
        else:
            for _ in range(600):
                attached.update()
                mujoco.mj_step(model, data)
        assert attached.samples == 300
        ends.append(data.qpos.copy())
    assert (ends[0] == ends[1]).all()
    assert mujoco.get_mjcb_control() is None


def test_it_holds_where_it_is_when_nothing_is_asked(arm: tuple[phihat.Gains, Sine]) -> None:
    gains, motion = arm
    model, data = ready(motion)
    data.qvel[:] = 0.0
    start = data.qpos.copy()
    attached = attach(model, data, gains)
    for _ in range(3000):
        attached.update()
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(data.qpos, start, atol=1e-4)
    # At rest, what the controller did not know is the arm's weight.
    weight = np.array(data.qfrc_bias)
    np.testing.assert_allclose(attached.controller.phi_hat, weight, atol=0.02 * np.abs(weight).max())


def test_an_interface_that_adds_gravity(arm: tuple[phihat.Gains, Sine]) -> None:
    """With the interface's model right, nothing is left for the controller to find but coupling and friction."""
    gains, motion = arm
    model, data = ready(motion)
    data.qvel[:] = 0.0
    attached = attach(model, data, gains, gravity="compensated")
    for _ in range(1000):
        attached.update()
        mujoco.mj_step(model, data)
    assert np.abs(attached.controller.phi_hat).max() < 1e-6
    assert np.abs(data.ctrl).max() > 10.0


def test_gears_and_other_names(arm: tuple[phihat.Gains, Sine]) -> None:
    """The same arm with geared motors and in other hands gives the same motion."""
    gains, motion = arm
    ends = []
    for geared in (False, True):
        model, data = ready(motion)
        if geared:
            model.actuator_gear[:, 0] = -50.0
            model.actuator_ctrlrange[:] /= 50.0
        attached = attach(model, data, gains, joints=[f"joint{i}" for i in range(1, 8)], reference=motion)
        for _ in range(300):
            attached.update()
            mujoco.mj_step(model, data)
        ends.append(data.qpos.copy())
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


def refused(says: str, model: Any, gains: phihat.Gains, **options: Any) -> phihat.ArgumentError:
    with pytest.raises(phihat.ArgumentError, match=says) as caught:
        attach(model, mujoco.MjData(model), gains, **options).install()
    assert mujoco.get_mjcb_control() is None
    return caught.value


def test_what_cannot_work_is_refused(arm: tuple[phihat.Gains, Sine]) -> None:
    gains, motion = arm
    model, _ = ready(motion)
    why = refused("no joint 'elbow'", model, gains, joints=["elbow"] * 7)
    assert why.joint == "elbow"
    refused("6 joints; it must be 7", model, gains, joints=["joint1"] * 6)
    refused("gravity: 'none'", model, gains, gravity="none")
    model.opt.timestep = 3e-4
    assert refused("timestep: 0.0003 s", model, gains).value == 3e-4
    model.opt.timestep = 1e-3
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    refused("RK4", model, gains)
    model, _ = ready(motion)
    model.body_gravcomp[5] = 1.0
    refused("gravcomp", model, gains)
    model, _ = ready(motion)
    model.actuator_biastype[3] = mujoco.mjtBias.mjBIAS_AFFINE
    assert refused("no torque motor", model, gains).joint == "joint4"
    model = build(phihat.Robot.from_name("ur5"))
    refused("no joint 'joint1'", model, gains)
