"""Sweeps from Python: wrong if one file were another than the command's, or a killed process cost anything but its time."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Literal

import numpy as np
import phihat
import pytest
from phihat import _phihat, _sweep

ROOT = Path(__file__).parents[3]
COMMAND = Path(os.environ.get("PHIHAT_PROGRAM", ROOT / "target" / "release" / "phihat"))

STUDY = """
duration_s = 0.3
[robot]
name = "planar3r"
[spec]
settle_s = 0.1
error_bound_rad = 0.01
[gains]
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 60.0
inertia_kg_m2 = [0.42, 0.18, 0.14]
[reference]
kind = "hold"
pose = "ready"
"""
VARY = {"world.payload.mass_kg": "0.05..0.8", "gains.inertia_kg_m2": "times:log:0.8..1.2"}
RUNS = 150


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep by the command, in its folder, with its study beside it."""
    place = tmp_path_factory.mktemp("sweep")
    (place / "held.toml").write_text(STUDY)
    vary = [word for key, how in VARY.items() for word in ("--vary", f"{key}={how}")]
    call = [str(COMMAND), "sweep", "held.toml", *vary, "--runs", str(RUNS), "--seed", "3", "--out", "whole", "-q"]
    done = subprocess.run(call, cwd=place, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return place


def same(place: Path, other: Path) -> None:
    def files(folder: Path) -> dict[str, bytes]:
        paths = sorted(p for p in folder.rglob("*") if p.is_file())
        # How far the work was, in the order in which it was done.
        left_out = ("journal.jsonl", ".phihat.lock")
        return {str(p.relative_to(folder)): p.read_bytes() for p in paths if p.name not in left_out}

    one, two = files(place / "whole"), files(other)
    assert {"runs.npy", "sweep.json", "report.html", "study.toml", "gains.json"} < one.keys() == two.keys()
    assert [name for name in one if one[name] != two[name]] == []


@pytest.mark.parametrize("on", [None, "processes"])
def test_the_files_are_those_of_the_command(
    whole: Path, on: Literal["processes"] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(whole)
    told: list[tuple[int, int]] = []
    answer = phihat.sweep(
        "held.toml", VARY, runs=RUNS, seed=3, out=f"on-{on}", on=on, shards=5 if on else None, workers=2,
        progress=lambda done, of: told.append((done, of)),
    )
    same(whole, Path(f"on-{on}"))
    rows = np.load(f"on-{on}/runs.npy")
    assert len(rows) == RUNS and answer["totals"]["within_spec"] == int(rows["within_spec"].sum())
    assert told[-1] == (RUNS, RUNS)


def test_a_killed_process_is_begun_again(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(whole)
    begun, killed = _sweep._begun, list[int]()

    def struck(asked: dict[str, Any], unit: int, said: Any) -> Any:
        process = begun(asked, unit, said)
        if unit == 1 and len(killed) < 2:
            killed.append(process.pid)
            process.kill()
        return process

    monkeypatch.setattr(_sweep, "_begun", struck)
    phihat.sweep("held.toml", VARY, runs=RUNS, seed=3, out="killed", on="processes", shards=3, workers=2)
    assert len(killed) == 2
    same(whole, Path("killed"))


def test_an_interrupted_sweep_goes_on_where_it_was(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(whole)

    class Enough(Exception):
        pass

    def stop(done: int, of: int) -> None:
        if done >= 50:
            raise Enough

    told: list[int] = []
    asked: dict[str, Any] = {"runs": RUNS, "seed": 3, "out": "stopped", "on": "processes", "shards": 6, "workers": 1}
    with pytest.raises(Enough):
        phihat.sweep("held.toml", VARY, progress=stop, **asked)
    phihat.sweep("held.toml", VARY, progress=lambda done, of: told.append(done), **asked)
    assert told[0] >= 25
    same(whole, Path("stopped"))
    assert not (Path("stopped") / ".shards").exists()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"vary": {"world.payload.mass_g": "0..1"}}, "world.payload.mass_kg"),
        ({"vary": "world.payload.mass_kg=0..1"}, "vary: "),
        ({"on": "mpi"}, "'processes' or 'ray'"),
        ({"runs": 0}, "runs: 0; it must be an integer from 1"),
        ({"study": "none.toml"}, "none.toml"),
    ],
)
def test_what_cannot_be_is_said(whole: Path, asked: dict[str, Any], said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(whole)
    told: dict[str, Any] = {"study": "held.toml", "vary": VARY, "runs": 8, "out": "no", **asked}
    with pytest.raises(phihat.Error, match=said):
        phihat.sweep(told.pop("study"), told.pop("vary"), **told)


def test_a_missing_ray_is_named(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(whole)
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(phihat.Error, match=r"pip install 'phihat\[ray\]'"):
        phihat.sweep("held.toml", VARY, runs=8, out="no", on="ray")
