"""One study many times, its numbers told run by run: arrays in, arrays out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _phihat
from ._document import Study, source
from ._errors import ArgumentError

ALIASES = {"payload_kg": "world.payload.mass_kg", "friction_nm": "world.coulomb_extra_nm"}
"""Short names of keys that are told often: the mass at the tool, and dry friction beyond the robot's."""

ENDS = ("whole", "diverged", "stopped")
"""What ``ended`` of a run counts: to its end, left every plausible state, stopped by the robot's interface."""


@dataclass(frozen=True)
class Rollouts:
    """What came of many runs; run ``k`` is ``phihat.simulate(result.study(k), gains=result.gains)`` to the last bit.

    Attributes:
        figures: arrays ``(runs, joints)`` by the names that ``metrics["joints"]`` of a trace has: ``error_rms_rad``,
            ``error_peak_rad``, ``error_steady_max_rad``, ``error_integral_steady_max_rad_s``,
            ``velocity_error_steady_max_rad_s``, ``tau_max_nm``, ``tau_step_max_nm``, ``limited_steady_share``, ``phi_max_nm``,
            ``phi_error_steady_max_nm``. Those of a run that ended early are of the samples that it had.
        within_spec: whether a run kept every bound that its study states, to its end; ``(runs,)``.
        ended: how it ended, ``(runs,)``: places in :data:`ENDS`.
        samples: control samples that it had; ``(runs,)``.
        tip_error_steady_max_m: largest error of the tip after ``settle_s`` [m], ``(runs,)``; NaN where the robot names no tip.
        signals: arrays ``(runs, kept samples, joints)`` by name, those that were asked for; NaN after a run's end.
        t: times of the kept samples [s].
        joint_names: joints, in the order of all arrays.
        gains: the gains of all runs, but of those whose study states its own.
        in_lanes: how many runs moved in lanes beside others, which changes no bit and takes less time.
    """

    figures: dict[str, NDArray[np.float64]]
    within_spec: NDArray[np.bool_]
    ended: NDArray[np.uint8]
    samples: NDArray[np.uint64]
    tip_error_steady_max_m: NDArray[np.float64]
    signals: dict[str, NDArray[np.float64]]
    t: NDArray[np.float64]
    joint_names: list[str]
    gains: _phihat.Gains
    in_lanes: int
    _made: _phihat.Rollouts = field(repr=False)

    def __len__(self) -> int:
        return len(self.ended)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """A figure or a signal by its name."""
        for kept in (self.figures, self.signals):
            if name in kept:
                return kept[name]
        limit = ", ".join([*self.figures, *self.signals])
        message = f"rollouts: nothing is kept as {name!r}; there are {limit}"
        raise ArgumentError(message, field="name", value=name, limit=limit)

    def __repr__(self) -> str:
        kept = int(self.within_spec.sum())
        return f"Rollouts({len(self)} runs, {len(self.joint_names)} joints, {kept} within spec)"

    def study(self, run: int) -> dict[str, Any]:
        """The study that a run is, as a document; negative places count from the end."""
        place = run + len(self) if run < 0 else run
        if not 0 <= place < len(self):
            limit = f"0 to {len(self) - 1}"
            raise ArgumentError(f"run: {run}; it must be {limit}", field="run", value=run, limit=limit)
        return self._made.study(place)


def rollouts(
    study: Study,
    values: Mapping[str, ArrayLike] | None = None,
    *,
    seeds: Sequence[int] | NDArray[np.integer[Any]] | None = None,
    gains: _phihat.Gains | None = None,
    uncertified: bool = False,
    signals: Sequence[str] = (),
    every: int = 1,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    name: str = "python",
) -> Rollouts:
    """Run a study's closed loop many times, each with numbers and a seed of its own; figures of every run as arrays.

    >>> masses = np.linspace(0.1, 1.0, 200)
    >>> rolled = phihat.rollouts("studies/first.toml", {"payload_kg": masses}, seeds=range(200))
    >>> worst = rolled["error_steady_max_rad"].max(axis=1)

    Gains are chosen and checked once, for the study as it stands: those given, else those that it states, else designed ones.
    Gains that a study states can be told run by run (``"gains.inertia_kg_m2"``). Arms of one structure move in lanes, eight at a
    time, on every core; the global interpreter lock is not held. Ctrl-C ends it within a fraction of a second.

    Args:
        study: a study: a path, or a document.
        values: numbers of the study by the path of their key, as ``phihat sweep --vary`` takes it (``"world.payload.mass_kg"``,
            ``"fault[0].size"``, ``"world.coulomb_extra_nm.joint2"``) or by an alias (:data:`ALIASES`). An array of shape
            ``(runs,)`` has one number per run, for all joints where the key has one per joint; ``(runs, n)`` one per run and
            joint, or entry of a list; a single number is that of every run.
        seeds: the seed of each run, below 2^53; ``None``: the study's own in all of them.
        gains: run these gains.
        uncertified: run gains even where the arm's inertia is not inside their window.
        signals: signals of a trace to keep (``"q"``, ``"e"``, ``"tau_applied"``, …; as :class:`Trace` names them).
        every: keep every so many samples of them, the first included.
        threads: runs at a time; one per core unless given.
        progress: called as ``progress(done, all)`` now and then, from this thread; what it raises ends the runs.
        name: the study's name where it is a document, ``[a-z0-9_-]``.

    Raises:
        ArgumentError: a number cannot be, as in ``payload_kg[17] = nan``; there are not as many as runs, or no such key.
        StudyError, Error: the study cannot be used, or what it becomes in some run, which is named.
    """
    runs, numbers = _numbers(values or {}, seeds)
    path, document = source(study)
    asked = {"path": path, "document": document, "name": name, "numbers": numbers, "runs": runs}
    told = None if seeds is None else [_seed(k, seed) for k, seed in enumerate(seeds)]
    every, threads = _whole("every", every), None if threads is None else _whole("threads", threads)
    made = _phihat.Rollouts({**asked, "seeds": told, "gains": gains, "uncertified": uncertified})
    came = made.run(list(signals), every, threads, progress)
    kept = max((signal.shape[1] for signal in came["signals"].values()), default=0)
    t = np.arange(kept) * every * made.period
    return Rollouts(**came, t=t, joint_names=made.joint_names, gains=made.gains, _made=made)


def _numbers(
    values: Mapping[str, ArrayLike], seeds: Any
) -> tuple[int, list[tuple[str, list[str], list[float]]]]:
    """How many runs, and of each number its name, its paths, and its values run by run."""
    arrays = {}
    for key, value in values.items():
        try:
            arrays[key] = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise _refused(key, value, "an array of numbers") from None
        if arrays[key].ndim > 2:
            raise _refused(key, arrays[key].shape, "of shape (runs,) or (runs, n)", "shape ")
    lengths = {key: len(array) for key, array in arrays.items() if array.ndim > 0}
    if seeds is not None:
        lengths["seeds"] = len(seeds)
    if not lengths:
        raise _refused("values", dict(values), "arrays with one entry per run, or seeds must be given")
    first, runs = next(iter(lengths.items()))
    for key, length in lengths.items():
        if length != runs:
            raise _refused(key, length, f"for {runs} runs, as {first} is", "values for runs: ")
    if runs == 0:
        raise _refused(first, [], "at least one run")
    told = []
    for key, array in arrays.items():
        path = ALIASES.get(key, key)
        whole = np.broadcast_to(array, (runs,)) if array.ndim == 0 else array
        paths = [path] if whole.ndim == 1 else [f"{path}[{i}]" for i in range(whole.shape[1])]
        if not paths:
            raise _refused(key, whole.shape, "of shape (runs,) or (runs, n)", "shape ")
        told.append((key, paths, whole.ravel().tolist()))
    return runs, told


def _seed(k: int, seed: Any) -> int:
    whole = isinstance(seed, (int, np.integer)) and not isinstance(seed, bool)
    if not whole or not 0 <= int(seed) < 2**53:
        limit = "an integer from 0 to 2^53 - 1"
        raise ArgumentError(f"seeds[{k}] = {seed!r}: it must be {limit}", field="seeds", value=seed, limit=limit)
    return int(seed)


def _whole(name: str, value: Any) -> int:
    most = 65535
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or not 1 <= value <= most:
        raise _refused(name, value, f"an integer from 1 to {most}")
    return int(value)


def _refused(key: str, value: Any, limit: str, what: str = "") -> ArgumentError:
    shown = repr(value)
    shown = shown if len(shown) <= 60 else f"{shown[:57]}..."
    return ArgumentError(f"{key}: {what}{shown}; it must be {limit}", field=key, value=value, limit=limit)
