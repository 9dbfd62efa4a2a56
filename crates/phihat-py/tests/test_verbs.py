"""Design, verify, simulate, report: the same as the command, as Python objects."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Literal

import numpy as np
import phihat
import pytest
from long import long

STUDIES = Path(__file__).parents[3] / "studies"

SHORT: dict[str, Any] = {
    "duration_s": 3.0,
    "robot": {"name": "planar3r"},
    "spec": {"settle_s": 1.5, "error_bound_rad": 2e-3},
    "design": {"payload_max_kg": 0.5},
    "loop": {"rate_hz": 1000.0, "delay_samples": 1},
    "sensor": {"encoder_bits": 20, "velocity": "differenced", "velocity_filter_hz": 100.0},
    "world": {"payload": {"mass_kg": np.float64(0.3)}},
    "reference": {
        "kind": "sines",
        "center": "ready",
        "sine": [{"amplitude_rad": np.full(3, 0.2), "frequency_hz": 0.3}],
    },
}


@pytest.fixture(scope="module")
def gains() -> phihat.Gains:
    return phihat.design(SHORT)


@pytest.fixture(scope="module")
def trace(gains: phihat.Gains) -> phihat.Trace:
    return phihat.simulate(SHORT, gains=gains)


def test_design_keeps_what_it_promises(gains: phihat.Gains, trace: phihat.Trace) -> None:
    gains.verify()
    phihat.verify(gains)
    assert gains.window is not None and gains.error_bound is not None
    assert all(low < 1.0 < high for low, high in gains.window)
    steady = trace.t >= 1.5
    worst = np.abs(trace["e"][steady]).max(axis=0)
    assert (worst <= gains.error_bound).all() and max(gains.error_bound) <= 2e-3
    assert trace.within_spec and trace.divergence is None


def test_coupled_gains_are_arrays_by_joint_that_moves_and_joint_that_is_hit(gains: phihat.Gains) -> None:
    coupled = gains.coupled
    assert coupled is not None
    error = coupled["error_rad_per_nm"]
    assert error.shape == (3, 3) and error.dtype == np.float64 and (error > 0.0).all()
    # At one posture the matrix of a push to an error is symmetric; so is the largest of every entry.
    assert np.allclose(error, error.T, rtol=1e-3)
    document = gains.certificate
    assert document is not None
    assert (error == np.array(document["coupled"]["error_rad_per_nm"])).all()
    assert (error @ np.array([1.0, 0.0, 0.0]) == error[:, 0]).all()


def test_faults_answer_run_by_run(tmp_path: Path) -> None:
    study = STUDIES / "faults" / "planar3r.toml"
    answer = phihat.faults(study, orders=[1], seeds=1, only="/payload_drop/", out=tmp_path)
    names = [run["name"] for run in answer["runs"]]
    assert names == [f"planar3r/m1/payload_drop/{severity}/1" for severity in (1, 2, 3)]
    assert answer["totals"]["good"] and answer == json.loads((tmp_path / "faults.json").read_text())
    with pytest.raises(phihat.Error, match="no_such"):
        phihat.faults("no_such.toml", out=tmp_path)


def test_a_comparison_answers_law_by_law(tmp_path: Path) -> None:
    chosen = ["pd", "proposed-designed"]
    study = STUDIES / "table1.toml"
    answer = phihat.compare(study, only=chosen, worlds=["delay"], quick=True, out=tmp_path)
    assert answer == json.loads((tmp_path / "compare.json").read_text())
    pd, designed = answer["rows"]
    assert [pd["rival"], designed["rival"]] == chosen
    worst = designed["cells"][1]["worst"]
    assert worst["error_peak_rad"] <= worst["error_bound_rad"] <= 5e-3
    with pytest.raises(phihat.Error, match="nobody"):
        phihat.compare(study, only=["nobody"], out=tmp_path)


@long
def test_the_paper_is_reproduced_part_by_part(tmp_path: Path) -> None:
    answer = phihat.reproduce(only="theorem 2", quick=True, out=tmp_path)
    assert answer == json.loads((tmp_path / "reproduction.json").read_text())
    statements = {s["id"]: s for section in answer["sections"] for s in section["statements"]}
    assert statements["theorem2-first-order"]["verdict"] == "as_printed"
    assert statements["erratum-q33"]["verdict"] == "with_correction"
    with pytest.raises(phihat.Error, match="no such place"):
        phihat.reproduce(only="no such place", out=tmp_path)


def test_a_changed_gain_is_refuted(gains: phihat.Gains) -> None:
    document = json.loads(gains.to_json())
    for joint in document["joints"]:
        joint["kp_per_s2"] *= 3.0
    with pytest.raises(phihat.Refuted) as caught:
        phihat.Gains.from_json(json.dumps(document)).verify()
    assert caught.value.claim and caught.value.inequality


def test_exports_hold_the_gains(gains: phihat.Gains) -> None:
    table = gains.export("csv").splitlines()
    assert len([line for line in table if line and not line.startswith("#")]) == 1 + len(gains.joint_names)
    assert all(name in gains.export("c-header") for name in gains.joint_names)
    with pytest.raises(phihat.ArgumentError, match="format"):
        gains.export("yaml")  # type: ignore[arg-type]


def test_impossible_is_told_with_clauses() -> None:
    strict = SHORT | {"spec": {"settle_s": 1.5, "error_bound_rad": 1e-9}}
    with pytest.raises(phihat.Infeasible, match="error_bound_rad") as caught:
        phihat.design(strict)
    assert any(clause["possible"] and clause["possible"] > 1e-9 for clause in caught.value.clauses)
    # What the error of the nearest law is spent on: parts that are not within others add up.
    budget = caught.value.budget
    assert budget is not None and not budget["feasible"] and budget["front"]
    for joint in budget["joints"]:
        parts = sum(part["error_rad"] for part in joint["parts"] if not part["within"])
        assert parts == pytest.approx(joint["total_rad"])


def test_the_trace_obeys_its_own_definitions(trace: phihat.Trace) -> None:
    n = len(trace.joint_names)
    assert trace["q"].shape == (len(trace), n) == (3000, 3)
    assert (trace["e"] == trace["q"] - trace["q_desired"]).all()
    assert (trace["de"] == trace["dq"] - trace["dq_desired"]).all()
    area = np.cumsum(0.5e-3 * (trace["e"][1:] + trace["e"][:-1]), axis=0)
    np.testing.assert_allclose(trace["e_integral"][1:], area, atol=1e-12)
    assert trace["saturated"].dtype == np.bool_
    with pytest.raises(phihat.ArgumentError, match="no 'tau'"):
        trace["tau"]


def test_controller_in_python_retraces_the_simulation(gains: phihat.Gains, trace: phihat.Trace) -> None:
    """The trace's own measurements through a controller in Python give its torques, bit for bit."""
    # The study's torque limits are the robot's; the certificate carries them.
    controller = phihat.Controller(gains)
    commanded = trace["tau_command"]
    applied = np.vstack([np.zeros(3), trace["tau_applied"][:-1]])
    signals = [trace[name] for name in ("q_measured", "dq_measured", "q_desired", "dq_desired", "ddq_desired")]
    for k in range(len(trace)):
        q, dq, q_des, dq_des, ddq_des = (signal[k] for signal in signals)
        tau = controller.update(q, dq, q_des, dq_des, ddq_des, applied[k], k * 1_000_000)
        assert (tau == commanded[k]).all(), k


def test_a_supervised_run_tells_modes_events_and_faults(gains: phihat.Gains, trace: phihat.Trace) -> None:
    assert trace.mode is None and trace.events is None and trace.fault is None
    nothing = {"kind": "sensor_nan", "start_s": 2.0, "duration_s": 0.1}
    watched = phihat.simulate(SHORT | {"supervisor": {}, "fault": [nothing]}, gains=gains)
    mode, events, fault = watched.mode, watched.events, watched.fault
    assert mode is not None and events is not None and fault is not None
    assert len(mode) == len(events) == len(fault) == len(watched)
    stopped = mode.index("safe-stop")
    assert 2.0 <= watched.t[stopped] < 2.1 and mode[stopped - 1] == "tracking"
    assert fault[stopped] == "bad-sample" and fault[stopped - 1] is None
    assert "not-finite" in events[stopped] and events[1900] == []


def test_same_study_same_bits(gains: phihat.Gains, trace: phihat.Trace) -> None:
    again = phihat.simulate(SHORT, gains=gains)
    assert again["q"].tobytes() == trace["q"].tobytes()


def test_pandas_and_plot(trace: phihat.Trace) -> None:
    table = trace.to_pandas()
    assert table.index.name == "t_s" and table.shape == (3000, 17 * 3)
    assert (table["e"]["joint2"].to_numpy() == trace["e"][:, 1]).all()
    figure = trace.plot("e", "phi", "phi_hat")
    assert [axis.get_ylabel() for axis in figure.axes] == ["e = q − q_d [rad]", "φ [N·m]", "φ̂ [N·m]"]


def test_report_and_folder(tmp_path: Path, trace: phihat.Trace) -> None:
    trace.report(tmp_path / "page.html")
    assert "<html" in (tmp_path / "page.html").read_text() and list((tmp_path / "figures").glob("*.svg"))
    trace.save(tmp_path / "run")
    page = phihat.report(tmp_path / "run" / "trace.parquet")
    assert page.read_text() == (tmp_path / "page.html").read_text()
    page.unlink()
    assert phihat.report(tmp_path / "run") == page and page.is_file()


def test_the_module_says_what_it_runs() -> None:
    call = [sys.executable, "-m", "phihat"]
    helped = subprocess.run([*call, "--help"], capture_output=True, text=True, check=True)
    assert "crosscheck" in helped.stdout and not helped.stderr
    other = subprocess.run([*call, "run", "study.toml"], capture_output=True, text=True)
    assert other.returncode == 2 and "cargo install" in other.stderr and not other.stdout


def test_a_report_of_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(phihat.Error, match="none.csv"):
        phihat.report(tmp_path / "none.csv")


def test_a_record_is_read_back_to_the_last_bit_or_refused(trace: phihat.Trace, tmp_path: Path) -> None:
    folder = tmp_path / "record"
    trace.save(folder)
    again = phihat.read_run(folder)
    assert again.metrics == trace.metrics and again.joint_names == trace.joint_names
    for name in ("q", "e", "tau_command", "phi_hat"):
        assert np.array_equal(again[name], trace[name])
    again.gains.verify()
    assert again.within_spec == trace.within_spec
    (folder / "gains.json").write_text("{}")
    with pytest.raises(phihat.Error, match="is not the file that the run left"):
        phihat.read_run(folder)


ANY: dict[str, Any] = {
    "duration_s": 3.0,
    "robot": {"name": "planar3r"},
    "profile": {"name": "ideal", "adds_gravity": True},
    "spec": {"settle_s": 1.0, "error_bound_rad": 3e-3},
    "design": {"payload_max_kg": 0.05, "window_margin": 1.1},
    "loop": {"delay_samples": 1, "form": "positions"},
    "sensor": {"encoder_bits": 19},
    "world": {"coulomb_extra_nm": 0.05, "payload": {"mass_kg": 0.05}},
    "supervisor": {"error_stop_rad": 0.2},
    "reference": {
        "kind": "any",
        "center": "ready",
        "box_rad": 0.4,
        "speed_max_rad_s": 0.4,
        "acceleration_max_rad_s2": 1.0,
        "jerk_max_rad_s3": 10.0,
    },
}


def test_a_motion_is_compared_with_the_class_of_its_gains(gains: phihat.Gains) -> None:
    own = phihat.design(ANY)
    t = np.linspace(0.0, 6.0, 301)
    window = np.sin(np.pi * t / 6.0) ** 4
    q = np.array([0.4, 1.2, 0.6]) + 0.15 * window[:, None] * np.sin(np.outer(t, [0.9, 0.7, 1.1]))
    found = phihat.bound(own, t, q, study=ANY)
    assert found["inside"] and found["slow_down"] == 1.0
    along = found["along"]["error_bound_rad"]
    for joint, bound, alone in zip(found["joints"], own.error_bound or [], along, strict=True):
        assert joint["error_bound_rad"] == bound and 0.0 < alone < bound
    speed = np.abs(np.gradient(q, t, axis=0)).max(axis=0)
    for joint, largest in zip(found["joints"], speed, strict=True):
        clause = next(clause for clause in joint["clauses"] if clause["quantity"] == "speed")
        assert abs(clause["value"] / largest - 1.0) < 0.01
    faster = phihat.bound(own, 0.4 * t, q)
    assert not faster["inside"] and faster["along"] is None and faster["slow_down"] > 1.05
    assert phihat.bound(own, 0.4 * 1.000001 * faster["slow_down"] * t, q)["inside"]
    with pytest.raises(phihat.Error, match="bound no class of motions"):
        phihat.bound(gains, t, q)
    with pytest.raises(phihat.ArgumentError, match="a row per time"):
        phihat.bound(own, t[:-1], q)
    with pytest.raises(phihat.ArgumentError, match="begin at 0 and grow"):
        phihat.bound(own, t + 1.0, q)
    # A run inside the class has the shares of the bound, and all of them below 1.
    trace = phihat.simulate(ANY, gains=own)
    share = trace["error_share"]
    assert share.shape == trace["e"].shape and 0.0 < share.max() < 1.0
