"""Environments: wrong if they were not the simulation's world, if a vector of them were not each one alone, or if Gymnasium's own
checker found fault."""

from __future__ import annotations

import warnings
from typing import Any

import gymnasium
import numpy as np
import phihat
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from phihat.gym import Env, VectorEnv

STUDY: dict[str, Any] = {
    "duration_s": 0.3,
    "robot": {"name": "planar3r"},
    "spec": {"settle_s": 0.03, "error_bound_rad": 0.01},
    "gains": {"bandwidth_rad_s": 20.0, "estimator_bandwidth_rad_s": 60.0, "inertia_kg_m2": [0.42, 0.18, 0.14]},
    "loop": {"delay_samples": 2, "torque_max_nm": 20.0, "torque_rate_max_nm_s": 4000.0},
    "sensor": {"encoder_bits": 16, "velocity": "differenced", "velocity_filter_hz": 80.0},
    "world": {"coulomb_extra_nm": 0.1, "payload": {"mass_kg": 0.3}},
    "fault": [{"kind": "sensor_noise", "start_s": 0.0, "size": 1e-4}],
    "reference": {"kind": "sines", "center": "ready", "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.5}]},
}
SIGNALS = ("q", "dq", "e", "q_measured", "dq_measured", "tau_command", "tau_applied", "phi")


def test_gymnasiums_checker_finds_no_fault() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(minimum|maximum) value is (-)?infinity.*")
        warnings.filterwarnings("ignore", message=".*not within.*normali[sz]ed.*|.*symmetric and normalized.*")
        warnings.filterwarnings("ignore", message=".*spec.*")
        for action in ("torque", "correction"):
            check_env(Env(STUDY, action=action), skip_render_check=True)


@pytest.mark.parametrize("beyond", [{}, {"world": {"drive_bandwidth_hz": 60.0}}, {"loop": {"delay_samples": 1}}])
def test_phihats_own_law_leaves_the_trace_of_the_simulation(beyond: dict[str, Any]) -> None:
    """By the hand of an agent that is the law, and as the law whose torque nobody corrects."""
    study = STUDY | beyond
    simulated = phihat.simulate(study, uncertified=True)
    limits = study["loop"].get("torque_max_nm"), study["loop"].get("torque_rate_max_nm_s")
    most: dict[str, Any] = {"torque_max": [limits[0]] * 3 if limits[0] else None}
    most["torque_rate_max"] = [limits[1]] * 3 if limits[1] else None
    law = phihat.Controller(simulated.gains, **most)
    bound = {} if limits[0] else {"action_max": 50.0}
    for action in ("torque", "correction"):
        env = Env(study, action=action, gains=simulated.gains, **bound)
        seen, info = env.reset(seed=1, options={"seed": simulated.run["seed"]})
        assert info["seed"] == simulated.run["seed"]
        over, steps = False, 0
        while not over:
            q, dq, tau, q_des, dq_des, ddq_des = seen.reshape(6, 3)
            told = law.update(q, dq, q_des, dq_des, ddq_des, tau) if action == "torque" else np.zeros(3)
            seen, reward, terminated, over, info = env.step(told)
            steps += 1
            assert not terminated and reward <= 0.0 and info["t"] < 0.3005
        trace = env.trace()
        assert steps == len(simulated) == len(trace) == 300
        for signal in SIGNALS:
            assert np.array_equal(trace[signal], simulated[signal]), (action, signal)
        with pytest.raises(phihat.ArgumentError, match="after a reset"):
            env.step(np.zeros(3))
        with pytest.raises(phihat.ArgumentError, match="its record was taken"):
            env.trace()


def test_a_held_action_and_the_reward_are_what_they_are_said_to_be() -> None:
    env = Env(STUDY, repeat=7, action_cost=0.5)
    seen, _ = env.reset(seed=3)
    assert env.dt == 7e-3
    action = np.array([1.0, -2.0, 0.5])
    seen, reward, *_, info = env.step(action)
    error = (seen[:3] - seen[9:12]) / 0.01
    assert info["t"] == 7e-3
    np.testing.assert_allclose(reward, -np.mean(error**2) - 0.5 * np.mean((action / 20.0) ** 2), rtol=1e-12)
    over = False
    while not over:
        *_, over, _ = env.step(action)
    trace = env.trace()
    assert (trace["tau_command"][10:] == action).all()


def test_an_arm_that_runs_away_ends_its_episode() -> None:
    env = Env(STUDY | {"duration_s": 20.0, "loop": {"torque_max_nm": 1e5}}, failure=-7.0)
    env.reset(seed=0)
    for _ in range(20_000):
        seen, reward, terminated, truncated, _ = env.step(np.full(3, 1e5))
        if terminated:
            break
    assert terminated and not truncated and reward == -7.0 and np.isfinite(seen).all()
    assert env.trace().divergence is not None


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP, AutoresetMode.DISABLED])
def test_a_vector_is_gymnasiums_own_vector_of_single_ones(mode: AutoresetMode) -> None:
    told: dict[str, Any] = {"randomise": {"payload_kg": (0.1, 0.6), "duration_s": (0.05, 0.2)}, "repeat": 9}
    ours = VectorEnv(STUDY, 5, autoreset_mode=mode, **told)
    theirs = SyncVectorEnv([lambda: Env(STUDY, **told)] * 5, autoreset_mode=mode)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert ours.metadata["autoreset_mode"] == theirs.metadata["autoreset_mode"]
    equal(ours.reset(seed=11), theirs.reset(seed=11))
    rng = np.random.default_rng(4)
    ends = 0
    for _ in range(60):
        actions = rng.uniform(-5.0, 5.0, (5, 3))
        mine, other = ours.step(actions), theirs.step(actions)
        equal(mine, other)
        over = mine[2] | mine[3]
        ends += int(over.sum())
        if mode == AutoresetMode.DISABLED and over.any():
            with pytest.raises(phihat.ArgumentError, match="after a reset"):
                ours.step(actions)
            mask = {"reset_mask": over}
            equal(ours.reset(options=dict(mask)), theirs.reset(options=dict(mask)))
    assert ends >= 10


def equal(mine: Any, other: Any) -> None:
    if isinstance(mine, dict):
        assert mine.keys() == other.keys()
        for key in mine:
            equal(mine[key], other[key])
    elif isinstance(mine, tuple):
        assert len(mine) == len(other)
        for one, two in zip(mine, other):
            equal(one, two)
    elif isinstance(mine, np.ndarray) and mine.dtype == object:
        equal(tuple(mine), tuple(other))
    elif mine is None:
        assert other is None
    else:
        assert np.array_equal(mine, other), (mine, other)
        assert np.asarray(mine).dtype == np.asarray(other).dtype


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ({"action": "gains"}, "'torque' or 'correction'"),
        ({"repeat": 0}, "repeat: 0"),
        ({"action_max": -1.0}, "action_max"),
        ({"dtype": "float16"}, "'float32' or 'float64'"),
        ({"record": 1}, "True or False"),
        ({"randomise": {"payload_kg": (2.0, 1.0)}}, "randomise"),
    ],
)
def test_what_cannot_be_is_said(told: dict[str, Any], said: str) -> None:
    with pytest.raises(phihat.ArgumentError, match=said):
        Env(STUDY, **told)


def test_single_precision_is_the_same_run_rounded_on_the_way() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        check_env(Env(STUDY, dtype="float32", record=False), skip_render_check=True)
    single, double = VectorEnv(STUDY, 3, dtype="float32", record=False), VectorEnv(STUDY, 3)
    seen, _ = single.reset(seed=4)
    other, _ = double.reset(seed=4)
    rng = np.random.default_rng(2)
    for _ in range(40):
        assert seen.dtype == np.float32 and np.array_equal(seen, other.astype(np.float32))
        actions = rng.uniform(-5.0, 5.0, (3, 3)).astype(np.float32)
        seen, rewards, *_ = single.step(actions)
        other, same, *_ = double.step(actions.astype(np.float64))
        assert np.array_equal(rewards, same)
    with pytest.raises(phihat.ArgumentError, match="record: False"):
        single.trace(0)


def test_wrong_actions_and_options_are_named() -> None:
    envs = VectorEnv(STUDY, 3)
    with pytest.raises(phihat.ArgumentError, match="after a reset"):
        envs.step(np.zeros((3, 3)))
    envs.reset(seed=0)
    with pytest.raises(phihat.ArgumentError, match=r"action\[2\]: NaN at joint joint2"):
        envs.step(np.array([[0.0] * 3, [0.0] * 3, [0.0, np.nan, 0.0]]))
    with pytest.raises(phihat.ArgumentError, match="shape"):
        envs.step(np.zeros(3))
    with pytest.raises(phihat.ArgumentError, match="mass_kg"):
        envs.reset(options={"values": {"payload_kg": -1.0}})
    with pytest.raises(phihat.ArgumentError, match="supervisor"):
        Env(STUDY | {"supervisor": {}}, action="correction")
    assert isinstance(envs, gymnasium.vector.VectorEnv)
