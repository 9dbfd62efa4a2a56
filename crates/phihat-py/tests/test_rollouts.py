"""Rollouts: wrong if a run of many were not the run alone, if a wrong number were not named by its place, or if one could not
end them."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import phihat
import pytest
from long import long

BASE: dict[str, Any] = {
    "duration_s": 0.4,
    "seed": 5,
    "robot": {"name": "planar3r"},
    "spec": {"settle_s": 0.1, "error_bound_rad": 0.05},
    "gains": {"bandwidth_rad_s": 20.0, "estimator_bandwidth_rad_s": 60.0, "inertia_kg_m2": [0.42, 0.18, 0.14]},
    "loop": {"delay_samples": 1, "torque_max_nm": 25.0},
    "sensor": {"encoder_bits": 18, "velocity": "differenced", "velocity_filter_hz": 100.0},
    "reference": {"kind": "sines", "center": "ready", "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.5}]},
}

BEYOND: list[dict[str, Any]] = [
    {},
    {"supervisor": {}},
    {"world": {"drive_bandwidth_hz": 80.0}},
    {"sensor": {"encoder_bits": 14, "velocity": "measured", "velocity_noise_rad_s": 1e-3}},
    {"fault": [{"kind": "sensor_nan", "start_s": 0.2, "duration_s": 0.01}]},
]


def test_each_run_is_the_single_run_to_the_last_bit() -> None:
    """Random studies: what all runs leave, on one thread or three, is what each one leaves by itself."""
    rng = np.random.default_rng(2)
    for beyond in BEYOND:
        study = BASE | beyond
        runs = int(rng.integers(9, 13))
        values: dict[str, Any] = {
            "payload_kg": rng.uniform(0.05, 1.0, runs),
            "friction_nm": rng.uniform(0.0, 0.3, (runs, 3)),
            "loop.delay_samples": rng.integers(0, 3, runs),
            "gains.inertia_kg_m2": rng.uniform(0.15, 0.4, (runs, 3)),
            "reference.sine[0].frequency_hz": rng.uniform(0.2, 0.8, runs),
            "duration_s": rng.choice([0.25, 0.4], runs),
        }
        seeds = rng.integers(0, 2**53, runs)
        kept = ("e", "tau_applied", "q_measured")
        rolled = phihat.rollouts(study, values, seeds=seeds, signals=kept, every=7, threads=3, uncertified=True)
        again = phihat.rollouts(study, values, seeds=seeds, signals=kept, every=7, threads=1, uncertified=True)
        assert len(rolled) == runs and rolled.in_lanes == again.in_lanes
        assert rolled.joint_names == ["joint1", "joint2", "joint3"]
        for k in range(runs):
            alone = phihat.simulate(rolled.study(k), uncertified=True)
            metrics = alone.metrics
            for name, figure in rolled.figures.items():
                assert figure[k].tolist() == [joint[name] for joint in metrics["joints"]], (beyond, k, name)
                assert figure.tobytes() == again.figures[name].tobytes()
            assert rolled.within_spec[k] == alone.within_spec and rolled.samples[k] == metrics["samples"]
            for name in kept:
                own = alone[name][::7]
                assert np.array_equal(rolled[name][k, : len(own)], own, equal_nan=True), (beyond, k, name)
                assert np.isnan(rolled[name][k, len(own) :]).all()
        if not beyond:
            assert rolled.in_lanes >= runs - 3 and rolled.t[1] == 7e-3


@long
def test_designed_gains_are_those_of_the_study_as_it_stands() -> None:
    designed = {"design": {"payload_max_kg": 0.5}, "world": {"payload": {"mass_kg": 0.3}}, "sensor": {"encoder_bits": 20}}
    study = {key: value for key, value in BASE.items() if key != "gains"} | designed | {"spec": {"settle_s": 0.2, "error_bound_rad": 2e-3}}
    gains = phihat.design(study)
    rolled = phihat.rollouts(study, {"payload_kg": [0.2, 0.4], "duration_s": 0.5})
    assert rolled.gains.to_json() == gains.to_json()
    for k in range(2):
        alone = phihat.simulate(rolled.study(k), gains=gains, uncertified=True).metrics
        assert rolled["error_rms_rad"][k].tolist() == [joint["error_rms_rad"] for joint in alone["joints"]]
    assert not np.array_equal(rolled["tau_max_nm"][0], rolled["tau_max_nm"][1])
    assert rolled.study(-1)["world"]["payload"]["mass_kg"] == 0.4


def test_how_a_run_ended_is_told() -> None:
    torque = np.array([25.0, 0.01])
    rolled = phihat.rollouts(BASE | {"duration_s": 2.0}, {"loop.torque_max_nm": torque}, signals=["q"], uncertified=True)
    alone = phihat.simulate(rolled.study(1), uncertified=True)
    assert phihat._rollouts.ENDS[rolled.ended[0]] == "whole"
    assert (alone.divergence is None) == (rolled.ended[1] == 0)
    assert rolled.samples[1] == len(alone) and not rolled.within_spec[1]


@pytest.mark.parametrize(
    ("values", "seeds", "said"),
    [
        ({"payload_kg": [0.1] * 17 + [np.nan]}, None, r"payload_kg\[17\] = NaN: it must be finite"),
        ({"payload_kg": [0.1, -1.0]}, None, r"payload_kg\[1\] = -1: it must be .*kg"),
        ({"friction_nm": [[0.1, 0.1, 0.1], [0.1, 0.1, np.inf]]}, None, r"friction_nm\[1, 2\] = inf"),
        ({"friction_nm": np.ones((2, 5))}, None, "friction_nm: .*no such joint"),
        ({"world.payload.mass_g": [1.0]}, None, "world.payload.mass_kg"),
        ({"payload_kg": [0.1, 0.2]}, [1, 2, 3], "seeds: values for runs: 3; it must be for 2 runs"),
        ({"payload_kg": [0.1, 0.2]}, [1, -2], r"seeds\[1\] = -2"),
        ({"payload_kg": "heavy"}, None, "payload_kg: 'heavy'"),
        ({"payload_kg": 0.5}, None, "one entry per run"),
        ({"payload_kg": []}, None, "at least one run"),
        ({"seed": [1.0]}, None, "seeds"),
        ({"design.payload_max_kg": [1.0]}, None, "gains are made once"),
        ({"payload_kg": [1.0], "world.payload.mass_kg": [1.0]}, None, "told twice"),
    ],
)
def test_what_cannot_be_is_named_by_its_place(values: Any, seeds: Any, said: str) -> None:
    with pytest.raises(phihat.ArgumentError, match=said):
        phihat.rollouts(BASE, values, seeds=seeds)


def test_a_run_that_cannot_begin_is_named_with_what_it_was_told() -> None:
    """Numbers that may be, and together make no study: the first run of them, whichever thread came first."""
    values: dict[str, Any] = {"payload_kg": np.full(90, 0.1), "spec.settle_s": [0.1] * 70 + [0.5] * 20}
    for threads in (1, 4):
        with pytest.raises(phihat.Error, match=r"run 70 \(.*settle_s\[70\] = 0.5"):
            phihat.rollouts(BASE, values, threads=threads)
    with pytest.raises(phihat.ArgumentError, match="no 'tau'|no \"tau\""):
        phihat.rollouts(BASE, seeds=[1], signals=["tau"])


def test_progress_is_told_and_ends_it() -> None:
    told: list[tuple[int, int]] = []
    phihat.rollouts(BASE, seeds=range(40), progress=lambda done, of: told.append((done, of)))
    assert told[-1] == (40, 40) and all(a <= b for a, b in zip(told, told[1:]))

    def enough(done: int, of: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        phihat.rollouts(BASE, seeds=range(8), progress=enough)


def interrupted(rolling: Callable[[], object], ready: Callable[[], bool]) -> None:
    """Ctrl-C while compiled code is at work, once something is ready: it raises.

    A timer looks until it finds Python at one instruction of ``rollouts`` twice: that is inside the call which this instruction makes.
    """
    last: tuple[FrameType | None, int] = (None, -1)

    def look(_number: int, frame: FrameType | None) -> None:
        nonlocal last
        before, last = last, (None, -1)
        if frame is not None and frame.f_code.co_name == "rollouts" and ready():
            last = (frame, frame.f_lasti)
            if last == before:
                signal.raise_signal(signal.SIGINT)

    # A shell that starts this behind its back has it ignore Ctrl-C.
    before = [(number, signal.signal(number, handler)) for number, handler in
              ((signal.SIGINT, signal.default_int_handler), (signal.SIGALRM, look))]
    try:
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
            rolling()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in before:
            signal.signal(number, handler)


def test_ctrl_c_ends_the_runs_long_before_the_last() -> None:
    told: list[int] = []

    def progress(done: int, of: int) -> None:
        told.append(done)

    interrupted(lambda: phihat.rollouts(BASE, seeds=range(100_000), progress=progress), lambda: bool(told))
    assert told[-1] < 100_000


def test_ctrl_c_ends_what_comes_before_the_runs() -> None:
    """While gains are designed, which takes seconds: no run is begun."""
    told: list[int] = []
    designed = Path(__file__).parents[3] / "studies/panda_design.toml"
    interrupted(
        lambda: phihat.rollouts(designed, seeds=[1], progress=lambda done, _: told.append(done)), lambda: True
    )
    assert not told
