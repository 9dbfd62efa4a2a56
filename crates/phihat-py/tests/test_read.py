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
    "spec": {"settle_s": 0.1, "error_bound_rad": 0.05},
    "gains": {"bandwidth_rad_s": 20.0, "estimator_bandwidth_rad_s": 60.0, "inertia_kg_m2": [0.42, 0.18, 0.14]},
    "sensor": {"encoder_bits": 18},
    "reference": {"kind": "sines", "center": "ready", "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.5}]},
}


@pytest.mark.parametrize("supervised", [False, True])
@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_what_was_recorded_is_read(tmp_path: Path, kind: str, supervised: bool) -> None:
    trace = phihat.simulate(STUDY | ({"supervisor": {}} if supervised else {}), uncertified=True)
    trace.save(tmp_path, csv=kind == "csv")
    assert [path.name for path in tmp_path.glob("trace.*")] == [f"trace.{kind}"]
    for path in (tmp_path, tmp_path / f"trace.{kind}"):
        read = phihat.read_trace(path)
        assert read["joint_names"].tolist() == trace.joint_names
        assert np.array_equal(read["t"], trace.t) and read["t_ns"].dtype == np.int64
        for name in SIGNALS + FLAGS:
            assert np.array_equal(read[name], trace[name]) and read[name].dtype == trace[name].dtype, name
        assert ("mode" in read) == supervised
        if supervised:
            assert read["mode"].tolist() == trace.mode and read["brake"].dtype == np.bool_


def test_both_kinds_are_the_same(tmp_path: Path) -> None:
    trace = phihat.simulate(STUDY | {"supervisor": {}}, uncertified=True)
    trace.save(tmp_path / "csv", csv=True)
    trace.save(tmp_path / "parquet")
    csv, parquet = phihat.read_trace(tmp_path / "csv"), phihat.read_trace(tmp_path / "parquet")
    assert list(csv) == list(parquet)
    for name, values in csv.items():
        assert np.array_equal(values, parquet[name]) and values.dtype.kind == parquet[name].dtype.kind, name
    # A record has one trace: what another kind had is gone with its record.
    trace.save(tmp_path / "csv")
    assert [path.name for path in (tmp_path / "csv").glob("trace.*")] == ["trace.parquet"]
    assert np.array_equal(phihat.read_run(tmp_path / "csv")["e"], trace["e"])


def test_other_libraries_read_it(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    trace = phihat.simulate(STUDY | {"supervisor": {}}, uncertified=True)
    trace.save(tmp_path)
    table, read = parquet.read_table(tmp_path / "trace.parquet"), phihat.read_trace(tmp_path)
    k, n = trace["q"].shape
    assert table.num_rows == k * n and not any(field.nullable for field in table.schema)
    types = {str(field.type) for field in table.schema}
    assert types == {"int64", "string", "double", "bool"}
    assert np.array_equal(table["t_ns"].to_numpy(), np.repeat(read["t_ns"], n))
    assert table["joint"].to_pylist() == trace.joint_names * k
    units = ("_rad_s2", "_rad_s", "_rad", "_nm")
    for name in table.column_names[2:]:
        signal = next((name.removesuffix(unit) for unit in units if name.endswith(unit)), name)
        wanted = read[signal]
        wanted = np.repeat(wanted, n) if wanted.ndim == 1 else wanted.ravel()
        assert np.array_equal(np.array(table[name].to_pylist()), wanted), name
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_parquet(tmp_path / "trace.parquet").pivot(index="t_ns", columns="joint", values="e_rad")
    assert np.array_equal(frame[trace.joint_names].to_numpy(), trace["e"])


@pytest.mark.parametrize(
    "written",
    [
        {},
        {"compression": "none"},
        {"use_dictionary": False},
        {"data_page_version": "2.0", "row_group_size": 100},
        {"use_dictionary": False, "column_encoding": {"e_rad": "BYTE_STREAM_SPLIT"}},
    ],
)
def test_parquet_of_others_is_read_alike(tmp_path: Path, written: dict[str, Any]) -> None:
    """A file that another library wrote, with columns of the schema."""
    arrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    trace = phihat.simulate(STUDY, uncertified=True)
    k, n = trace["q"].shape
    trace.save(tmp_path)
    read = phihat.read_trace(tmp_path)
    columns = {"t_ns": np.repeat(read["t_ns"], n), "joint": np.tile(read["joint_names"], k), "e_rad": trace["e"].ravel()}
    columns["saturated"] = trace["saturated"].ravel()
    parquet.write_table(arrow.table(columns), tmp_path / "other.parquet", **written)
    other = phihat.read_trace(tmp_path / "other.parquet")
    assert np.array_equal(other["e"], trace["e"]) and np.array_equal(other["t"], trace.t)
    assert np.array_equal(other["saturated"], trace["saturated"])
    parquet.write_table(arrow.table(columns), tmp_path / "other.parquet", compression="zstd")
    with pytest.raises(phihat.Error, match="t_ns.*compressed by ZSTD; SNAPPY or none is read"):
        phihat.read_trace(tmp_path / "other.parquet")
    parquet.write_table(arrow.table({"e_rad": columns["e_rad"]}), tmp_path / "other.parquet")
    with pytest.raises(phihat.Error, match="no column t_ns"):
        phihat.read_trace(tmp_path / "other.parquet")


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
    phihat.simulate(STUDY, uncertified=True).save(tmp_path, csv=True)
    file = tmp_path / "trace.csv"
    file.write_text("\n".join(change(file.read_text().splitlines())) + "\n")
    with pytest.raises(phihat.Error, match=said):
        phihat.read_trace(file)
    with pytest.raises(phihat.Error, match="none.csv"):
        phihat.read_trace(tmp_path / "none.csv")
    phihat.simulate(STUDY, uncertified=True).save(tmp_path)
    file = tmp_path / "trace.parquet"
    file.write_bytes(file.read_bytes()[:-9])
    with pytest.raises(phihat.Error, match="no whole Parquet file"):
        phihat.read_trace(file)
