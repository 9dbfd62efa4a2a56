"""The same study in two engines."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import phihat
import pytest
from phihat import _crosscheck

STUDIES = Path(__file__).parents[3] / "studies"

STUDY: dict[str, Any] = {
    "duration_s": 2.5,
    "robot": {"name": "panda", "locked": {"panda_joint3": 0.2}},
    "spec": {"settle_s": 1.5, "error_bound_rad": 2e-3},
    "gains": {
        "order": 2,
        "bandwidth_rad_s": 20.0,
        "estimator_bandwidth_rad_s": 50.0,
        "inertia_kg_m2": [1.78, 2.22, 1.28, 0.247, 0.259, 0.212],
    },
    "loop": {"rate_hz": 1000.0, "delay_samples": 1, "torque_rate_max_nm_s": "robot"},
    "sensor": {"encoder_bits": 18, "velocity": "differenced", "velocity_filter_hz": 45.0},
    "world": {
        "gravity_m_s2": [0.5, 0.0, -9.7],
        "coulomb_extra_nm": 0.3,
        "viscous_extra_nm_s_rad": 0.2,
        "drive_bandwidth_hz": 120.0,
        "substeps": 2,
        "payload": {"frame": "panda_link8", "mass_kg": 0.5, "com_m": [0.0, 0.01, 0.05]},
        "push": [{"joint": "panda_joint4", "torque_nm": 2.0, "start_s": 1.2003, "duration_s": 0.2}],
    },
    "reference": {
        "kind": "sines",
        "center": "ready",
        "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.3, "phase_rad": [0, 1, 2, 3, 4, 5]}],
    },
}


def test_a_whole_world_in_two_engines() -> None:
    """Encoders, delay, drive lag, friction, payload, push, a locked joint: sample by sample the same."""
    found = phihat.crosscheck(STUDY)
    assert found.agrees
    assert found.step.max() < 1e-11, "rounding, and nothing else"
    assert found.same.max() < 1e-4, "what encoder steps and dry friction make of rounding"
    # Its own friction sticks and its integrator is coarser, so it is not the same; but it is the same arm.
    assert 1e-6 < found.own.max() < 2e-3
    assert (found.errors[2] < 2e-3).all()
    assert "they agree to 1e-09" in str(found) and len(found.as_document()["joints"]) == 6


def test_it_can_tell_a_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    """One per mille of payload more on the MuJoCo side is seen in every joint."""

    class Heavier(_crosscheck.Loop):
        def __init__(self, plan: dict[str, Any], robot: phihat.Robot, ours: phihat.Trace) -> None:
            plan["payload"]["mass_kg"] *= 1.001
            super().__init__(plan, robot, ours)

    monkeypatch.setattr(_crosscheck, "Loop", Heavier)
    found = phihat.crosscheck(STUDY)
    assert not found.agrees and found.step.min() > 1e-8


def test_exact_sensors_agree_to_rounding() -> None:
    smooth = STUDY | {"sensor": {}, "world": {"payload": STUDY["world"]["payload"], "friction": "none"}}
    found = phihat.crosscheck(smooth)
    assert found.same.max() < 1e-11


def test_what_is_not_modelled_is_refused() -> None:
    world = STUDY["world"] | {"drive": {"torque_ripple_nm": 0.1}}
    with pytest.raises(phihat.Error):
        phihat.crosscheck(STUDY | {"world": world})
    push = {"push": [{"force_n": [1.0, 0.0, 0.0], "start_s": 1.0, "duration_s": 0.1}]}
    with pytest.raises(phihat.Error, match="world.push.force_n: not modelled"):
        phihat.crosscheck(STUDY | {"world": push})
    with pytest.raises(phihat.Error, match="sensor.position_noise_rad: not modelled") as caught:
        phihat.crosscheck(STUDY | {"sensor": {"position_noise_rad": 1e-5}})
    assert caught.value.field == "sensor.position_noise_rad"


def test_by_the_clock(tmp_path: Path) -> None:
    """Two seconds of the first study; how late samples are depends on the machine, that it is told does not."""
    text = (STUDIES / "first.toml").read_text().replace("duration_s = 7.0", "duration_s = 2.0")
    text = text.replace("start_s = 4.0", "start_s = 1.0")
    study = tmp_path / "short.toml"
    study.write_text(text)
    call = [sys.executable, "-m", "phihat", "crosscheck", str(study), "--json", "--real-time"]
    done = subprocess.run(call, capture_output=True, text=True, env={"PATH": "", "PYTHONPATH": os.environ.get("PYTHONPATH", "")})
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["agrees"] is True
    assert "2000 samples by the clock, period 1000 µs" in done.stderr
    refused = subprocess.run([*call[:4], str(tmp_path / "none.toml")], capture_output=True, text=True)
    assert refused.returncode == 2 and "none.toml" in refused.stderr
