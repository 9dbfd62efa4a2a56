"""A robot that Python code talks to, under ``phihat drive``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _phihat
from .trace import Trace


class Link(Protocol):
    """A robot, or another simulator, for :func:`drive`.

    Optional: ``name``, a word for it in the record; ``adds_gravity``, whether it adds the torque that holds the arm to what it
    is told (default ``False``); ``finish()``, called at the end.
    """

    @property
    def joint_names(self) -> Sequence[str]:
        """Joints, in the order of all its arrays; the study's joints have to be among them."""

    @property
    def period(self) -> float:
        """Time between samples [s], as the study's ``rate_hz`` says."""

    def read(self) -> Sequence[ArrayLike] | None:
        """The sample that is due: position [rad, m], velocity, and, where it is known, the torque [N m] that acted since the sample
        before. ``None``: this sample did not come. It is called once before the drive begins, to see where the arm stands."""

    def write(self, tau: NDArray[np.float64], /) -> None:
        """The torque of each joint [N m], in answer to that sample."""


@dataclass(frozen=True)
class Driven:
    """A drive that is over.

    Attributes:
        trace: its record, as of a simulation, of what the robot told: the error is the measured one, and ``phi`` is from measured
            positions and torques.
        drive: what only a drive has, as in ``drive.json``: checks, why it ended, lost samples, the supervisor's faults.
        good: whether the arm followed its motion to the end and kept every bound.
        folder: where the record is.
    """

    trace: Trace
    drive: dict[str, Any]
    good: bool
    folder: Path

    def __repr__(self) -> str:
        verdict = "good" if self.good else "not good"
        return f"Driven({verdict}: {self.drive['end']} after {self.drive['samples']} samples, in {self.folder})"


def drive(
    study: str | os.PathLike[str],
    link: Link,
    *,
    gains: str | os.PathLike[str] | None = None,
    reference: str | os.PathLike[str] | None = None,
    accept: Sequence[str] = (),
    out: str | os.PathLike[str] | None = None,
    log: str | os.PathLike[str] | None = None,
    csv: bool = False,
) -> Driven:
    """Drive a robot that Python code talks to: the checks, the loop and the record of ``phihat drive``.

    Everything waits for the robot's samples: whoever answers ``read`` owns the clock. The loop runs in a thread of its own, which
    takes Python's lock for ``read`` and ``write``; a hard real-time loop belongs into Rust, C++ or ``phihat drive --on fci://``.
    Ctrl-C is a safe stop, after which the record is written and ``KeyboardInterrupt`` raised.

    Args:
        study: path of a study with a supervisor.
        link: the robot.
        gains: a gains document, as ``phihat design`` leaves; by default those that the study states or asks for.
        reference: a motion (CSV) in place of the study's.
        accept: checks that you go on in spite of: certificate, window, motion, profile, supervisor, robot, description, real-time,
            rehearsal.
        out: folder for the record; ``out/STUDY`` unless given.
        log: a log for ROS tools and viewers (MCAP), where this package was built with them.
        csv: the trace of the record as a text, ``trace.csv``, in place of ``trace.parquet``.

    Raises:
        Error: a check does not pass, or study, gains or folder cannot be used.
        Exception: whatever the link raised, once the record is written.
    """
    own = {
        "object": link,
        "name": str(getattr(link, "name", type(link).__name__)),
        "joint_names": list(link.joint_names),
        "period": float(link.period),
        "adds_gravity": bool(getattr(link, "adds_gravity", False)),
    }
    asked = {"study": study, "gains": gains, "reference": reference, "out": out, "log": log, "csv": csv}
    trace, document, good, folder = _phihat.drive({**asked, "accept": list(accept), "link": own})
    return Driven(Trace(trace), document, good, Path(folder))
