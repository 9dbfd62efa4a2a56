"""Recorded traces as arrays, without the study that they are of."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _phihat
from ._errors import Error

_UNITS = ("_rad_s2", "_rad_s", "_rad", "_nm")
_FLAGS = ("saturated", "rate_limited")
_ROWS = 1 << 16


def read_trace(path: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """Read a recorded trace: every signal of every joint, as arrays.

    >>> trace = phihat.read_trace("out/panda")
    >>> trace["e"].shape, trace["joint_names"][0]
    ((10000, 7), 'panda_joint1')

    ``t`` [s] and ``t_ns`` have one entry per sample, ``joint_names`` one per joint; the signals that :class:`Trace` names have one
    row per sample and one column per joint, SI units and radians (a joint that slides: m, N), with the bits that were recorded;
    ``saturated`` and ``rate_limited`` are flags. Where there was a supervisor, its columns have a text per sample. Nothing is
    checked against the record's other files: :func:`read_run` does that.

    Args:
        path: ``trace.parquet`` or ``trace.csv``, or the folder of a run. Parquet of other programs is read as well, where it has ``t_ns``,
            ``joint`` and columns of the trace's names, not compressed or by SNAPPY.

    Raises:
        Error: the file is missing or no trace, with line or column.
    """
    file, is_parquet = _phihat.trace_file(os.fspath(path))
    place = Path(file)
    columns = _parquet(place) if is_parquet else _csv(place)
    return _by_joint(place, columns)


def _csv(place: Path) -> dict[str, NDArray[Any]]:
    parts: dict[str, list[NDArray[Any]]] = {}
    with place.open(newline="") as file:
        rows = csv.reader(file)
        head = next(rows, [])
        if head[:2] != ["t_s", "joint"] or len(set(head)) != len(head):
            raise Error(f"{place}: line 1: a trace begins with t_s,joint", field="path", value=str(place))
        parts = {name: [] for name in head}
        for first, block in _blocks(rows):
            for k, row in enumerate(block):
                if len(row) != len(head):
                    line = first + k
                    raise Error(f"{place}: line {line}: {len(row)} fields; the header has {len(head)}", field="path")
            for name, fields in zip(head, zip(*block, strict=True)):
                parts[name].append(_typed(place, name, fields, first))
    empty: NDArray[Any] = np.array([])
    columns = {name: np.concatenate(all_of) if all_of else empty for name, all_of in parts.items()}
    # Whole nanoseconds, as they are recorded.
    t_ns = np.rint(columns.pop("t_s") * 1e9).astype(np.int64)
    return {"t_ns": t_ns, **columns}


def _blocks(rows: Iterator[list[str]]) -> Iterator[tuple[int, list[list[str]]]]:
    """Some rows at a time, with the line of the first: what is text takes far more memory than what is read."""
    line, block = 2, list[list[str]]()
    for row in rows:
        block.append(row)
        if len(block) == _ROWS:
            yield line, block
            line, block = line + len(block), []
    if block:
        yield line, block


def _typed(place: Path, name: str, fields: tuple[str, ...], first: int) -> NDArray[Any]:
    if name in _FLAGS or name == "brake":
        return np.array([field in ("true", "1") for field in fields])
    if name != "t_s" and not name.endswith(_UNITS):
        return np.array(fields)
    try:
        return np.array([float(field) for field in fields])
    except ValueError:
        for k, field in enumerate(fields):
            try:
                float(field)
            except ValueError:
                message = f"{place}: line {first + k}: {name} is {field!r}; it must be a number"
                raise Error(message, field=name, value=field, limit="a number") from None
        raise


def _parquet(place: Path) -> dict[str, NDArray[Any]]:
    columns: dict[str, NDArray[Any]] = {}
    for name, values in _phihat.parquet_columns(os.fspath(place)).items():
        if isinstance(values, tuple):
            words, rows = values
            columns[name] = np.array(words, dtype=np.str_)[rows] if words else np.array([], dtype=np.str_)
        else:
            columns[name] = values
    for name in ("t_ns", "joint"):
        if name not in columns:
            raise Error(f"{place}: there is no column {name}, which a trace has", field="path", value=str(place))
    return columns


def _by_joint(place: Path, columns: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Samples down, joints across, from one row per sample and joint."""
    t_ns, joints = columns["t_ns"], columns["joint"]
    n = _joints(joints)
    if n == 0 or len(joints) % n or (joints.reshape(-1, n) != joints[:n]).any():
        raise Error(f"{place}: its rows are not every joint of each sample in turn", field="path", value=str(place))
    if (t_ns.reshape(-1, n) != t_ns[::n, np.newaxis]).any():
        raise Error(f"{place}: joints of one sample have other times", field="t_ns", value=str(place))
    told: dict[str, NDArray[Any]] = {"t_ns": t_ns[::n].copy(), "t": t_ns[::n] * 1e-9, "joint_names": joints[:n].astype(str)}
    for name, values in columns.items():
        if name in ("t_ns", "joint"):
            continue
        unit = next((unit for unit in _UNITS if name.endswith(unit)), None)
        if unit is not None:
            told[name.removesuffix(unit)] = values.reshape(-1, n)
        elif name in _FLAGS:
            told[name] = values.reshape(-1, n).astype(np.bool_)
        else:
            told[name] = values[::n].copy()
    return told


def _joints(joints: NDArray[Any]) -> int:
    """How many rows until the first joint comes again."""
    if len(joints) == 0:
        return 0
    again = np.flatnonzero(joints[1:] == joints[0])
    return int(again[0]) + 1 if len(again) else len(joints)
