"""Logs in other people's readers. Wrong if a reader refused one, or a count or a number were another than in the trace beside it."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

# `cargo xtask test Python` makes them before it runs the tests.
FOLDER = Path(os.environ.get("PHIHAT_LOGS", ""))
STUDIES = sorted(path.stem for path in FOLDER.glob("*.mcap")) if os.environ.get("PHIHAT_LOGS") else []

SIGNALS = {
    "/joint_states": ("q_measured_rad", "dq_measured_rad_s", "tau_applied_nm"),
    "/phihat/reference": ("q_desired_rad", "dq_desired_rad_s", None),
    "/phihat/error": ("e_rad", "de_rad_s", None),
    "/phihat/torque_command": (None, None, "tau_command_nm"),
    "/phihat/phi": (None, None, "phi_nm"),
    "/phihat/phi_hat": (None, None, "phi_hat_nm"),
}


class Trace:
    """The trace beside a log, as its CSV file has it."""

    def __init__(self, study: str) -> None:
        with (FOLDER / study / "trace.csv").open(encoding="utf-8") as file:
            self.rows = list(csv.DictReader(file))
        self.joints = list(dict.fromkeys(row["joint"] for row in self.rows))
        self.samples = len(self.rows) // len(self.joints)

    def signal(self, name: str) -> Any:
        """A column, samples by joints."""
        return np.array([float(row[name]) for row in self.rows]).reshape(self.samples, len(self.joints))

    def words(self, name: str) -> list[str]:
        """A column of the supervisor's, one entry per sample."""
        return [row[name] for row in self.rows[:: len(self.joints)]]


def test_logs_are_there() -> None:
    """One with a supervisor, and one without."""
    if "PHIHAT_LOGS" not in os.environ:
        pytest.skip("run by `cargo xtask test Python`")
    assert len(STUDIES) == 2


@pytest.mark.parametrize("study", STUDIES)
def test_rosbags_reads_every_number(study: str) -> None:
    """Each message of each topic, by its own definition in the file, with the bits of the trace."""
    trace = Trace(study)
    store = get_typestore(Stores.EMPTY)
    with AnyReader([FOLDER / f"{study}.mcap"], default_typestore=store) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
        found: dict[str, list[Any]] = {}
        times: dict[str, list[int]] = {}
        for connection, time_ns, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append(message)
            times.setdefault(connection.topic, []).append(time_ns)
    for topic, columns in SIGNALS.items():
        messages = found[topic]
        assert len(messages) == counts[topic] == trace.samples
        assert all(message.name == trace.joints for message in messages)
        for field, column in zip(("position", "velocity", "effort"), columns, strict=True):
            if column is None:
                assert all(len(getattr(message, field)) == 0 for message in messages)
                continue
            values = np.array([getattr(message, field) for message in messages])
            np.testing.assert_array_equal(values, trace.signal(column))
        stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
        assert stamps == times[topic]
        expected = np.array([float(row["t_s"]) for row in trace.rows[:: len(trace.joints)]])
        np.testing.assert_allclose(1e-9 * np.array(stamps), expected, rtol=0, atol=1e-12)
    if "mode" in trace.rows[0]:
        assert [message.data for message in found["/phihat/mode"]] == trace.words("mode")
        assert any(mode == "safe-stop" for mode in trace.words("mode"))
        eventful = [words for words, fault in zip(trace.words("events"), trace.words("fault"), strict=True) if words or fault]
        assert len(found.get("/phihat/events", [])) == len(eventful)
    else:
        assert "/phihat/mode" not in found


@pytest.mark.parametrize("study", STUDIES)
def test_mcap_reads_counts_and_documents(study: str) -> None:
    """The summary counts what is there, checksums hold, and gains and study come out as they are in the record."""
    trace = Trace(study)
    with (FOLDER / f"{study}.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        topics = {channel.id: channel.topic for channel in summary.channels.values()}
        counts = {topics[key]: count for key, count in summary.statistics.channel_message_counts.items()}
        assert all(counts[topic] == trace.samples for topic in SIGNALS)
        seen = sum(1 for _ in reader.iter_messages())
        assert seen == summary.statistics.message_count == sum(counts.values())
        documents = {attachment.name: attachment.data for attachment in reader.iter_attachments()}
    for name in ("gains.json", "study.toml"):
        assert documents[name] == (FOLDER / study / name).read_bytes()
