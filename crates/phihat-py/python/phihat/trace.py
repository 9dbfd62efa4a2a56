"""What a run leaves: every signal of every joint at every sample."""

from __future__ import annotations

import os
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _phihat
from ._errors import ArgumentError, Error

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

SIGNALS = (
    "q",
    "dq",
    "ddq",
    "q_desired",
    "dq_desired",
    "ddq_desired",
    "e",
    "e_integral",
    "de",
    "q_measured",
    "dq_measured",
    "tau_command",
    "tau_applied",
    "phi",
    "phi_hat",
)
"""Names of the signals; units as in docs, SI and radians."""

FLAGS = ("saturated", "rate_limited")

SHARE = "error_share"
"""The measured error as a share of its certified bound, where a class of motions has one."""

_LABELS = {
    "q": "q [rad]",
    "dq": "q̇ [rad/s]",
    "ddq": "q̈ [rad/s²]",
    "q_desired": "q_d [rad]",
    "dq_desired": "q̇_d [rad/s]",
    "ddq_desired": "q̈_d [rad/s²]",
    "e": "e = q − q_d [rad]",
    "e_integral": "∫e [rad·s]",
    "de": "ė [rad/s]",
    "q_measured": "q measured [rad]",
    "dq_measured": "q̇ measured [rad/s]",
    "tau_command": "τ command [N·m]",
    "tau_applied": "τ applied [N·m]",
    "phi": "φ [N·m]",
    "phi_hat": "φ̂ [N·m]",
}


class Trace:
    """The record of a run; ``trace["e"]`` is the position error, samples down and joints across.

    Signals (:data:`SIGNALS`): ``q, dq, ddq`` as they truly are, ``q_desired, dq_desired, ddq_desired``, ``e, e_integral,
    de`` (measured minus desired), ``q_measured, dq_measured`` as the controller saw them, ``tau_command``,
    ``tau_applied`` (mean over the sample), ``phi`` and ``phi_hat``; flags: ``saturated``, ``rate_limited``; and
    ``error_share``, where the gains have a bound for a class of motions: measured ``|e|`` over its bound.
    """

    def __init__(self, record: _phihat.Trace) -> None:
        self._record = record

    def __getitem__(self, signal: str) -> NDArray[Any]:
        """A signal of every joint, shape ``(samples, joints)``."""
        if signal in FLAGS:
            return self._record.flag(signal)
        if signal in SIGNALS or (signal == SHARE and self._record.bounded):
            return self._record.column(signal)
        limit = ", ".join(SIGNALS + FLAGS)
        raise ArgumentError(
            f"signal: there is no {signal!r}; there are {limit}", field="signal", value=signal, limit=limit
        )

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        verdict = "within spec" if self.within_spec else "NOT within spec"
        return f"Trace({len(self)} samples, {len(self.joint_names)} joints, {verdict})"

    @property
    def t(self) -> NDArray[np.float64]:
        """Time of each sample [s]."""
        return self._record.t

    @property
    def period(self) -> float:
        """Time between samples [s]."""
        return self._record.period

    @property
    def joint_names(self) -> list[str]:
        """Joints, in the order of the columns."""
        return self._record.joint_names

    @property
    def gains(self) -> _phihat.Gains:
        """The gains that ran.

        Raises:
            Error: another controller drove the run.
        """
        return self._record.gains

    @property
    def metrics(self) -> dict[str, Any]:
        """The figures of the run, as in ``metrics.json``."""
        return self._record.metrics

    @property
    def within_spec(self) -> bool:
        """Whether every bound that the study states held, and the run came to its end."""
        return self._record.within_spec

    @property
    def divergence(self) -> tuple[float, str] | None:
        """When [s] and at which joint the run left every plausible state; ``None`` if it did not."""
        return self._record.divergence

    @property
    def mode(self) -> list[str] | None:
        """The supervisor's mode at each sample, as in ``"tracking"``; ``None`` where there was no supervisor."""
        return self._record.mode

    @property
    def events(self) -> list[list[str]] | None:
        """What the supervisor noted at each sample; ``None`` where there was no supervisor."""
        return self._record.events

    @property
    def fault(self) -> list[str | None] | None:
        """What had stopped the arm at each sample, if anything; ``None`` where there was no supervisor."""
        return self._record.fault

    @property
    def run(self) -> dict[str, Any]:
        """Where the run came from, as in ``run.json``: study, seed, version, world, warnings."""
        return self._record.run

    @property
    def contact(self) -> dict[str, Any] | None:
        """Contacts and payload, as ``contact`` in run.json; None where nothing was watched.

        ``events`` lists contacts with time, joint, torque and, where there is one, the force at the tip; ``payloads``
        has the intervals of mass [kg] and centre of mass [m] of each part of the run.
        """
        watched: dict[str, Any] | None = self.run.get("contact")
        return watched

    def to_pandas(self) -> pandas.DataFrame:
        """All signals, one row per sample, columns ``(signal, joint)``; the index is the time [s]."""
        pd = _optional("pandas", "pandas")
        names = self.joint_names
        columns = pd.MultiIndex.from_product([SIGNALS + FLAGS, names], names=["signal", "joint"])
        table: pandas.DataFrame = pd.concat(
            [pd.DataFrame(self[signal]) for signal in SIGNALS + FLAGS], axis=1
        )
        table.columns = columns
        table.index = pd.Index(self.t, name="t_s")
        return table

    def plot(self, *signals: str) -> Figure:
        """Draw signals over time, one panel each, one line per joint; ``e`` and ``tau_applied`` if none is named."""
        pyplot = _optional("matplotlib.pyplot", "plot")
        chosen = signals or ("e", "tau_applied")
        figure: Figure
        figure, axes = pyplot.subplots(
            len(chosen), 1, sharex=True, squeeze=False, figsize=(8, 2.6 * len(chosen)), layout="constrained"
        )
        for signal, panel in zip(chosen, axes[:, 0]):
            panel.plot(self.t, self[signal], linewidth=1.0, label=self.joint_names)
            panel.set_ylabel(_LABELS.get(signal, signal))
            panel.grid(alpha=0.3)
        axes[0, 0].legend(fontsize="x-small", ncols=4)
        axes[-1, 0].set_xlabel("t [s]")
        # A notebook shows what a cell returns, and what pyplot holds: once is enough.
        if "inline" in pyplot.get_backend():
            pyplot.close(figure)
        return figure

    def save(self, folder: str | os.PathLike[str], *, csv: bool = False) -> None:
        """Write study, gains, origin, metrics and ``trace.parquet`` into a folder, as ``phihat simulate`` does.

        Args:
            folder: made where it is not there; an older record in it is replaced.
            csv: the trace as a text, ``trace.csv``, in place of ``trace.parquet``: several times larger, and slower.
        """
        self._record.write(os.fspath(folder), csv)

    def report(self, path: str | os.PathLike[str]) -> None:
        """Write the report, one self-contained HTML page, and its figures into ``figures/`` beside it."""
        self._record.write_report(os.fspath(path))

    def _repr_html_(self) -> str:
        """What notebooks show: the figures that a run is judged by, beside what was asked and promised."""
        promised: Sequence[float | None] = [None] * len(self.joint_names)
        try:
            promised = self.gains.error_bound or promised
        except Error:
            # Another controller drove the run, which promises nothing.
            pass
        cells = []
        for joint, bound in zip(self.metrics["joints"], promised, strict=True):
            unit = "mm" if joint.get("slides") else "mrad"
            errors = (joint["error_bound_rad"], bound, joint["error_steady_max_rad"])
            row = [escape(joint["name"]), *(f"{_digits(1e3, error)} {unit}" if error else "–" for error in errors)]
            force = "N" if joint.get("slides") else "N·m"
            cells.append([*row, f"{_digits(1.0, joint['tau_max_nm'])} {force}"])
        return f"<p>{escape(repr(self))}</p>" + _table(["joint", "|e| asked", "promised", "largest", "peak |τ|"], cells)


def _digits(scale: float, value: float) -> str:
    """Three significant digits, never 0.000.

    >>> _digits(1e3, 1.2345e-4), _digits(1.0, 87.0), _digits(1e3, 5e-9)
    ('0.123', '87', '5e-06')
    """
    return f"{scale * value:.3g}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def line(tag: str, cells: Sequence[str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in cells) + "</tr>"

    return f"<table>{line('th', head)}{''.join(line('td', row) for row in rows)}</table>"


def _optional(module: str, extra: str) -> Any:
    """A package that only some users need."""
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as why:
        package = module.split(".", maxsplit=1)[0]
        raise Error(f"{package} is missing: pip install 'phihat[{extra}]'") from why
