"""A law of one's own: in phihat's world by the hand, through simulate, and among the rivals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import phihat
import pytest
from long import long
from numpy.typing import NDArray

Array = NDArray[np.float64]

INERTIA = np.array([0.42, 0.18, 0.14])

STUDY: dict[str, Any] = {
    "duration_s": 2.0,
    "robot": {"name": "planar3r"},
    "spec": {"settle_s": 1.0, "error_bound_rad": 0.05},
    "gains": {"bandwidth_rad_s": 20.0, "estimator_bandwidth_rad_s": 60.0, "inertia_kg_m2": INERTIA},
    "loop": {"delay_samples": 1, "torque_max_nm": 20.0},
    "sensor": {"encoder_bits": 18, "velocity": "differenced", "velocity_filter_hz": 100.0},
    "world": {"coulomb_extra_nm": 0.1, "substeps": 2, "gravity_m_s2": [0.0, 0.0, 0.0]},
    "reference": {
        "kind": "sines",
        "center": "ready",
        "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.5}],
    },
}


def pd(s: phihat.Sample) -> Array:
    return INERTIA * (s.ddq_des - 40.0 * (s.dq - s.dq_des) - 400.0 * (s.q - s.q_des))


class PdPlus:
    """tau = M (ddq_des - kd de - kp e)"""

    name = "my-pd"
    scalars = {"kp": (400.0, 10.0, 4000.0), "kd": (40.0, 1.0, 400.0)}

    def __init__(self, scalars: dict[str, float], arm: phihat.ArmFacts) -> None:
        self.scalars_given, self.arm = scalars, arm

    def update(self, s: phihat.Sample) -> Array:
        e, de = s.q - s.q_des, s.dq - s.dq_des
        gains = self.scalars_given
        return self.arm.inertia * (s.ddq_des - gains["kd"] * de - gains["kp"] * e)


def test_our_own_law_from_outside_is_our_own_law() -> None:
    """The controller of phihat, driven by hand through the world, leaves the trace that phihat leaves."""
    inside = phihat.simulate(STUDY)
    law = phihat.Controller(inside.gains, torque_max=[20.0] * 3)
    outside = phihat.simulate(STUDY, controller=law)
    for signal in ("q", "dq", "e", "tau_command", "tau_applied", "phi"):
        assert np.array_equal(inside[signal], outside[signal]), signal
    with pytest.raises(phihat.Error, match="another controller"):
        _ = outside.gains
    assert outside.within_spec == inside.within_spec


def test_a_controller_from_numbers_is_that_from_a_document() -> None:
    gains = phihat.simulate(STUDY).gains
    numbers: dict[str, Any] = {"inertia": gains.inertia, "kp": gains.kp, "kd": gains.kd, "a": gains.a}
    typed = phihat.Controller(rate_hz=1000.0, joint_names=gains.joint_names, **numbers)
    given = phihat.Controller(gains)
    rng = np.random.default_rng(7)
    for _ in range(200):
        q, dq, q_des, dq_des, ddq_des = rng.normal(size=(5, 3))
        sample = {"q": q, "dq": dq, "q_des": q_des, "dq_des": dq_des, "ddq_des": ddq_des}
        assert np.array_equal(typed.update(**sample), given.update(**sample))
    assert phihat.Controller(rate_hz=1013.0, **numbers).joint_names == ["joint_1", "joint_2", "joint_3"]
    with pytest.raises(phihat.GainsError, match="joint_2"):
        phihat.Controller(rate_hz=1000.0, **{**numbers, "kp": [400.0, -1.0, 400.0]})
    with pytest.raises(phihat.ArgumentError, match="kd"):
        phihat.Controller(rate_hz=1000.0, **{**numbers, "kd": [40.0]})
    with pytest.raises(phihat.ArgumentError, match="beside"):
        phihat.Controller(gains, kp=[1.0])
    with pytest.raises(phihat.ArgumentError, match="gains"):
        phihat.Controller()


def test_the_plant_goes_sample_by_sample_where_simulate_goes() -> None:
    plant = phihat.Plant(STUDY)
    times = []
    while not plant.done:
        times.append(plant.sample.t)
        plant.step(pd(plant.sample))
    with_list = phihat.simulate(STUDY, controller=lambda s: list(pd(s)))
    trace = plant.trace()
    assert np.array_equal(trace["q"], with_list["q"])
    assert np.allclose(times, trace.t, atol=1e-12, rtol=0) and len(times) == 2000
    assert np.array_equal(trace["q_desired"][0], with_list["q_desired"][0])
    # The world is that of the study: what pushes there pushes here.
    push = {"joint": "joint3", "torque_nm": 4.0, "start_s": 1.2, "duration_s": 0.3}
    pushed = phihat.simulate({**STUDY, "world": {**STUDY["world"], "push": [push]}}, controller=pd)
    assert np.abs(pushed["e"][1000:]).max() > 2.0 * np.abs(trace["e"][1000:]).max()


def test_limits_of_the_study_act_on_an_own_law() -> None:
    trace = phihat.simulate(STUDY, controller=lambda s: np.full(3, 1e3))
    assert trace["tau_command"].max() == 20.0 and trace["saturated"].any()
    assert trace.divergence is not None or not trace.within_spec


def test_what_cannot_be_is_refused() -> None:
    plant = phihat.Plant(STUDY)
    with pytest.raises(phihat.ArgumentError, match="joint2.*finite|finite.*joint2"):
        plant.step([0.0, np.nan, 0.0])
    with pytest.raises(phihat.ArgumentError, match="shape"):
        plant.step([0.0])
    with pytest.raises(phihat.ArgumentError, match="done"):
        plant.trace()
    with pytest.raises(phihat.ArgumentError, match="beside"):
        phihat.simulate(STUDY, controller=pd, uncertified=True)
    with pytest.raises(phihat.ArgumentError, match="controller"):
        phihat.simulate(STUDY, controller=3)  # type: ignore[arg-type]
    with pytest.raises(phihat.StudyError) as caught:
        phihat.Plant({**STUDY, "loop": {"rate_khz": 1.0}})
    assert str(caught.value).startswith('study["loop"]["rate_khz"]: ') and caught.value.line == 0
    with pytest.raises(ZeroDivisionError):
        phihat.simulate(STUDY, controller=lambda s: 1 / 0)


def test_a_record_without_gains_is_read_back_and_has_a_page(tmp_path: Path) -> None:
    trace = phihat.simulate(STUDY, controller=pd)
    trace.save(tmp_path)
    assert not (tmp_path / "gains.json").exists()
    again = phihat.read_run(tmp_path)
    assert np.array_equal(again["e"], trace["e"])
    assert again.metrics == trace.metrics and again.run["form"] == "outside"
    page = phihat.report(tmp_path / "trace.parquet").read_text()
    assert "another controller" in page and "No certificate backs these figures" in page
    # Gains do not vanish from a record of phihat's own law without a word.
    phihat.simulate(STUDY).save(tmp_path)
    (tmp_path / "gains.json").unlink()
    with pytest.raises(phihat.Error, match="gains.json"):
        phihat.read_run(tmp_path)


@long
def test_an_own_law_is_a_rival_like_the_others(tmp_path: Path) -> None:
    study = tmp_path / "own.toml"
    study.write_text(
        "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\nerror_bound_rad = 0.05\n"
        "[design]\npayload_max_kg = 0.3\n[loop]\nform = \"observer\"\n[world]\nsubsteps = 4\n[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n"
        "[reference]\nkind = \"sines\"\ncenter = \"ready\"\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\n"
    )
    result = phihat.compare(
        study, laws=[PdPlus], only=["my-pd", "pd"], worlds=["exact"], quick=True, out=tmp_path / "out"
    )
    mine, theirs = (next(r for r in result["rows"] if r["rival"] == rival) for rival in ("my-pd", "pd"))
    assert mine["tuning"]["cost_tuned"] <= mine["tuning"]["cost_default"]
    assert set(mine["cells"][0]) == set(theirs["cells"][0])
    assert mine.get("cost") is None

    class Broken(PdPlus):
        name = "broken"

        def update(self, s: phihat.Sample) -> Array:
            raise RuntimeError("a mistake of mine")

    with pytest.raises(RuntimeError, match="a mistake of mine"):
        phihat.compare(study, laws=[Broken], only=["broken"], worlds=["exact"], quick=True, out=tmp_path / "b")
    for name, scalars in (("Not A Name", {}), ("fine", {"kp": (1.0, 2.0, 3.0)})):
        law = type("L", (PdPlus,), {"name": name, "scalars": scalars})
        with pytest.raises(phihat.ArgumentError, match="law"):
            phihat.compare(study, laws=[law], out=tmp_path / "c")
    taken = type("L", (PdPlus,), {"name": "pd"})
    with pytest.raises(phihat.Error, match="another name"):
        phihat.compare(study, laws=[taken], out=tmp_path / "d")


def test_a_plant_tells_what_the_robot_clamps() -> None:
    """A robot's own interface clamps below what the study's loop does: a law is told the smaller of the two."""
    gains = {**STUDY["gains"], "inertia_kg_m2": 0.2}
    panda: dict[str, Any] = {**STUDY, "robot": {"name": "panda"}, "gains": gains}
    panda["loop"] = {"delay_samples": 1, "torque_max_nm": 50.0}
    panda["reference"] = {**STUDY["reference"], "sine": [{"amplitude_rad": 0.02, "frequency_hz": 0.5}]}
    panda["profile"] = {"name": "franka"}
    most = phihat.Plant(panda).torque_max
    assert most is not None and np.array_equal(most, [50.0] * 4 + [12.0] * 3)


def test_notebooks_show_figures_and_no_markup_of_a_users() -> None:
    """Names come from files of other people."""
    for trace in (phihat.simulate(STUDY), phihat.simulate(STUDY, controller=pd)):
        shown = trace._repr_html_()
        assert shown.count("<tr>") == 4 and " mrad</td>" in shown and "0.000" not in shown
    gains = phihat.simulate(STUDY).gains._repr_html_()
    assert gains.count("<tr>") == 4 and "kg·m²" in gains and "400" in gains
    named = {
        **STUDY,
        "joint": [{"name": "a<i>", "inertia_min_kg_m2": 0.2, "inertia_max_kg_m2": 0.4, "phi_rate_max_nm_s": 1.0, "phi_jump_max_nm": 0.1}],
        "gains": {**STUDY["gains"], "inertia_kg_m2": 0.3},
        "reference": {"kind": "sines", "center_rad": [0.0], "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.5}]},
        "world": {},
    }
    del named["robot"]
    trace = phihat.simulate(named)
    assert "a&lt;i&gt;" in trace._repr_html_() and "<i>" not in trace._repr_html_() + trace.gains._repr_html_()
