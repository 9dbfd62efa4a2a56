"""The verbs: a study in, gains or a trace out."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _phihat
from ._document import Study, source
from ._errors import ArgumentError
from .own import Controller, declared, drive
from .trace import Trace

def design(study: Study, *, name: str = "python") -> _phihat.Gains:
    """Find gains that keep a study's specification, with a certificate.

    Args:
        study: a study with ``spec`` and ``design``.
        name: the study's name where it is a document, ``[a-z0-9_-]``.

    Raises:
        Infeasible: no gains keep every clause; its ``clauses`` say which, and what is possible.
        StudyError: the study cannot be used.
    """
    path, document = source(study)
    return _phihat.design(path, document, name)


def simulate(
    study: Study,
    *,
    gains: _phihat.Gains | None = None,
    controller: Controller | None = None,
    uncertified: bool = False,
    name: str = "python",
) -> Trace:
    """Run a study's closed loop; the same study gives the same trace, bit for bit.

    Args:
        study: a study with ``spec``, ``reference`` and either ``gains`` or ``design``.
        gains: used in place of those the study states or asks for.
        controller: your own law, in place of phihat's: a function of a :class:`Sample` that returns a torque per joint, an
            object with ``update(sample)``, or a :class:`Controller`. Sensors, delay, limits and faults are the study's;
            its gains, design and supervisor are not asked, and nothing is certified.
        uncertified: run gains even where the arm's inertia is not inside their window; marked in the record.
        name: the study's name where it is a document, ``[a-z0-9_-]``.

    Raises:
        StudyError, Error: the study cannot be used, or the gains may not run.
    """
    if controller is not None:
        if gains is not None or uncertified:
            limit = "without gains and uncertified"
            message = f"controller: given beside them; it must be {limit}"
            raise ArgumentError(message, field="controller", value=controller, limit=limit)
        return drive(study, controller, name)
    path, document = source(study)
    return Trace(_phihat.simulate(path, document, name, gains, uncertified))


def read_run(folder: str | os.PathLike[str]) -> Trace:
    """Read the record of a run, as ``phihat run`` and :meth:`Trace.save` leave it.

    Args:
        folder: where ``run.json`` and the trace are.

    Raises:
        Error: a file is missing, or is not the one that the run left.
    """
    return Trace(_phihat.recorded(os.fspath(folder)))


def faults(
    *studies: str | os.PathLike[str],
    orders: Sequence[int] = (1, 2),
    seeds: int = 3,
    quick: bool = False,
    only: str | None = None,
    threads: int | None = None,
    out: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """Break everything an arm can meet, one fault at a time; what became of it, as in ``faults.json``.

    Writes journal, answer and a page with a heat map to ``out/STUDY/faults``; an interrupted matrix goes on where
    it was. ``result["totals"]["good"]`` says whether the bars were kept, ``result["runs"]`` what each run came to.

    Args:
        studies: paths of study files, one per arm.
        orders: estimator orders, each with its own gains.
        seeds: runs per fault and severity.
        quick: one order, one seed.
        only: only runs whose name ``ARM/mORDER/FAULT/SEVERITY/SEED`` contains this.
        threads: runs at a time; one per core unless given.
        out: folder for the results.

    Raises:
        Error: an argument or a study cannot be used, or a result not be written.
    """
    asked = {"studies": studies, "orders": list(orders), "seeds": seeds, "quick": quick}
    return _phihat.faults({**asked, "only": only, "threads": threads, "out": out})


def compare(
    *studies: str | os.PathLike[str],
    laws: Sequence[Any] = (),
    only: Sequence[str] = (),
    worlds: Sequence[str] = (),
    seeds: int | None = None,
    quick: bool = False,
    fresh: bool = False,
    threads: int | None = None,
    out: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """Measure the rivals of the paper's Table 1 on your arms; what came of it, as in ``compare.json``.

    Every law is tuned by one optimiser with one budget, then runs in every world with its default and its tuned
    gains. Writes journal, answer and page to ``out/STUDY/compare`` (``out/compare`` for several studies); an
    interrupted comparison goes on where it was. ``result["rows"]`` has one entry for each arm and rival.

    Your own law is one more rival: a class with a ``name``, its free ``scalars`` as ``{name: (default, least, largest)}``,
    made as ``law(scalars, arm)`` with the :class:`ArmFacts` of an arm, with ``update(sample)`` that returns a torque per
    joint, and its equation as docstring. It is tuned and judged as the others are; what it needs is what it says. With
    ``preview = True`` its ``sample.ddq_des`` is that of the interval in which its torque acts. What a law raises ends the
    comparison, and counts as refused until its module's text changes.

    Args:
        studies: paths of study files, one per arm.
        laws: your own laws.
        only: ids of rivals; all unless given. ``phihat compare --list`` lists them.
        worlds: of exact, encoder, delay, payload, friction, saturation; all unless given.
        seeds: motions that are scored; 3 unless given, or 1 where ``quick``.
        quick: few tuning runs, one motion of some seconds.
        fresh: do everything again, whatever the journal holds.
        threads: runs at a time; one per core unless given.
        out: folder for the results.

    Raises:
        Error: an argument or a study cannot be used, or a result not be written.
    """
    asked: dict[str, Any] = {"studies": studies, "laws": [declared(law) for law in laws], "only": list(only)}
    asked |= {"worlds": list(worlds), "seeds": seeds}
    return _phihat.compare({**asked, "quick": quick, "fresh": fresh, "threads": threads, "out": out})


def reproduce(
    *,
    only: str | None = None,
    quick: bool = False,
    threads: int | None = None,
    out: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """Compute the paper's statements, figures and tables again; each with a verdict, as in ``reproduction.json``.

    Writes data, page, figures and studies to ``out/reproduction``. ``result["sections"]`` has the statements.

    Args:
        only: one part, by its name or by what is in it: ``"theory"``, ``"fig. 9"``, ``"theorem 2"``.
        quick: coarser maps and sweeps.
        threads: parts at a time; one per core unless given.
        out: folder for the results.

    Raises:
        Error: an argument cannot be used, or a result not be written.
    """
    return _phihat.reproduce(only, quick, threads, out)


def verify(gains: _phihat.Gains | str | os.PathLike[str]) -> None:
    """Check every claim of a certificate again, from the gains alone.

    Raises:
        Refuted: the first claim that does not hold, with both sides of its inequality.
    """
    if not isinstance(gains, _phihat.Gains):
        gains = _phihat.Gains.from_file(gains)
    gains.verify()


def bound(
    gains: _phihat.Gains | str | os.PathLike[str],
    t: ArrayLike,
    q: ArrayLike,
    *,
    study: Study | None = None,
    name: str = "python",
) -> dict[str, Any]:
    """Compare a motion with the class of motions that gains are certified for: inside or outside, and its bound.

    A natural cubic spline joins the samples. The answer has ``inside``; ``worst``, the joint and the limit (``position``,
    ``speed``, ``acceleration``, ``jerk``, ``rest``) of which the motion takes up the largest share; ``slow_down``, the factor
    on its times that brings it inside (1 if it is, ``None`` if no time does); and ``joints``, each with its ``clauses`` and,
    inside, its ``error_bound_rad`` and ``velocity_error_bound_rad_s``.

    Args:
        gains: gains with a bound for a class (``kind = "any"`` in their study's ``reference``), or their file.
        t: time of each sample [s], from 0.
        q: positions [rad], samples down, joints across.
        study: the study that the gains are for: ``along`` then has the bound for this motion alone, derived from its own
            postures, speeds and accelerations.
        name: the study's name where it is a document, ``[a-z0-9_-]``.

    Raises:
        Error: the gains bound no class of motions.
        ArgumentError: the samples are no motion of these joints.
        StudyError: the study cannot be used.
    """
    if not isinstance(gains, _phihat.Gains):
        gains = _phihat.Gains.from_file(gains)
    path, document = (None, None) if study is None else source(study)
    times = [float(time) for time in np.asarray(t, dtype=np.float64)]
    found: dict[str, Any] = _phihat.bound(gains, times, np.asarray(q, dtype=np.float64), path, document, name)
    return found


def report(trace: str | os.PathLike[str], path: str | os.PathLike[str] | None = None) -> Path:
    """Make the report of a recorded trace again, named by its file or the folder of its run; returns the page's path.

    Raises:
        Error: the files beside the trace are not of one run, or the page cannot be written.
    """
    file, _ = _phihat.trace_file(os.fspath(trace))
    page = Path(path) if path is not None else Path(file).with_name("report.html")
    _phihat.report(file, os.fspath(page))
    return page


def robots() -> list[str]:
    """Names of the arms that come with phihat, for :meth:`Robot.from_name`."""
    return _phihat.Robot.names_built_in()
