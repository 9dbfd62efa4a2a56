"""Traces read back: wrong if a bit, a joint or a sample were another, or a broken file were taken."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import phihat
import pytest
from phihat.trace import FLAGS, SIGNALS

STUDY: dict[str, Any] = {
    "duration_s": 0.3,
    "robot": {"name": "planar3r"},
    "spec": {"settle_s": 0.1, "error_max_rad": 0.05},
    "gains": {"bandwidth_rad_s": 20.0, "estimator_bandwidth_rad_s": 60.0, "inertia_kg_m2": [0.42, 0.18, 0.14]},
    "sensor": {"encoder_bits": 18},
    "reference": {"kind": "sines", "center": "ready", "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.5}]},
}


@pytest.mark.parametrize("supervised", [False, True])
def test_what_was_recorded_is_read(tmp_path: Path, supervised: bool) -> None:
    trace = phihat.simulate(STUDY | ({"supervisor": {}} if supervised else {}), uncertified=True)
    trace.save(tmp_path)
    for path in (tmp_path, tmp_path / "trace.csv"):
        read = phihat.read_trace(path)
        assert read["joint_names"].tolist() == trace.joint_names
        assert np.array_equal(read["t"], trace.t) and read["t_ns"].dtype == np.int64
        for name in SIGNALS + FLAGS:
            assert np.array_equal(read[name], trace[name]) and read[name].dtype == trace[name].dtype, name
        assert ("mode" in read) == supervised
        if supervised:
            assert read["mode"].tolist() == trace.mode and read["brake"].dtype == np.bool_


def test_parquet_is_read_alike(tmp_path: Path) -> None:
    """A file that another library wrote, with the columns of the schema."""
    arrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    trace = phihat.simulate(STUDY, uncertified=True)
    k, n = trace["q"].shape
    trace.save(tmp_path)
    read = phihat.read_trace(tmp_path / "trace.csv")
    columns = {"t_ns": np.repeat(read["t_ns"], n), "joint": np.tile(read["joint_names"], k), "e_rad": trace["e"].ravel()}
    parquet.write_table(arrow.table(columns), tmp_path / "other.parquet")
    other = phihat.read_trace(tmp_path / "other.parquet")
    assert np.array_equal(other["e"], trace["e"]) and np.array_equal(other["t"], trace.t)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: ["time,joint", *lines[1:]], "line 1"),
        (lambda lines: [*lines[:5], lines[5].replace(",", ",x", 2), *lines[6:]], "line 6|every joint"),
        (lambda lines: lines[:-1], "every joint"),
        (lambda lines: [*lines[:4], lines[4] + ",1", *lines[5:]], "line 5: .* fields"),
        (lambda lines: lines[:1], "every joint"),
    ],
)
def test_a_broken_file_is_refused(tmp_path: Path, change: Any, said: str) -> None:
    phihat.simulate(STUDY, uncertified=True).save(tmp_path)
    file = tmp_path / "trace.csv"
    file.write_text("\n".join(change(file.read_text().splitlines())) + "\n")
    with pytest.raises(phihat.Error, match=said):
        phihat.read_trace(file)
    with pytest.raises(phihat.Error, match="none.csv"):
        phihat.read_trace(tmp_path / "none.csv")
