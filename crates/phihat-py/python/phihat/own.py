"""A researcher's own law in phihat's worlds: sample by sample, or among the rivals of a comparison."""

from __future__ import annotations

import hashlib
import inspect
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _phihat
from ._document import Study, source
from ._errors import ArgumentError
from ._phihat import Sample
from .trace import Trace


class Law(Protocol):
    """What answers a sample with a torque per joint [N m]; a function of the sample serves as well."""

    def update(self, sample: Sample, /) -> ArrayLike: ...


Controller = Law | Callable[[Sample], ArrayLike] | _phihat.Controller


class Plant:
    """The world of a study, which waits for the torque of each sample.

    >>> plant = phihat.Plant("studies/panda.toml")
    >>> while not plant.done:
    ...     s = plant.sample
    ...     plant.step(plant.inertia * (s.ddq_des - 40 * (s.dq - s.dq_des) - 400 * (s.q - s.q_des)))
    >>> trace = plant.trace()

    Sensors, delay, drives, friction, payload, faults and limits are those of the study, and so are the bounds that its trace
    is held against; gains, design and supervisor are not asked. The same torques give the same trace, bit for bit.

    Args:
        study: a study: a path, or a document.
        inertia: nominal inertia of each joint [kg m^2] that ``phi`` of the trace is about; by default that of the gains
            which the study states, else the middle of the arm's range.
        name: the study's name where it is a document, ``[a-z0-9_-]``.
    """

    def __init__(
        self,
        study: Study,
        *,
        inertia: Sequence[float] | NDArray[np.float64] | None = None,
        name: str = "python",
        _driver: str = "phihat.Plant",
    ) -> None:
        path, document = source(study)
        given = None if inertia is None else np.asarray(inertia, dtype=np.float64)
        command = f"{_driver} on {path or name}, in Python"
        self._plant = _phihat.Plant(path, document, name, given, command)
        self._sample = self._plant.sample

    @property
    def joint_names(self) -> list[str]:
        """Joints, in the order of all arrays."""
        return self._plant.joint_names

    @property
    def period(self) -> float:
        """Time between samples [s]."""
        return self._plant.period

    @property
    def inertia(self) -> NDArray[np.float64]:
        """Nominal inertia of each joint [kg m^2]."""
        return np.array(self._plant.inertia)

    @property
    def torque_max(self) -> NDArray[np.float64] | None:
        """Torque limit of each joint [N m], which acts on what :meth:`step` is told; ``None``: the study has none."""
        limits = self._plant.torque_max
        return None if limits is None else np.array(limits)

    @property
    def sample(self) -> Sample:
        """The sample that waits for its torque; once ``done``, the last that was sensed."""
        return self._sample

    @property
    def done(self) -> bool:
        """Whether the run is over: at its end, diverged, or stopped by the robot's interface."""
        return self._plant.done

    def step(self, tau: ArrayLike) -> Sample:
        """Tell the torque of each joint [N m] for the sample that waits; returns the next. Nothing happens once ``done``.

        Raises:
            ArgumentError: not one finite number per joint.
        """
        self._sample = self._plant.step(np.asarray(tau, dtype=np.float64))
        return self._sample

    def trace(self) -> Trace:
        """The record of the run, once it is ``done``; it can be taken once.

        Raises:
            ArgumentError: samples are still to come, or it was taken before.
        """
        return Trace(self._plant.trace())

    def __repr__(self) -> str:
        where = "done" if self.done else f"at t = {self._sample.t:.3f} s"
        return f"Plant({len(self.joint_names)} joints, {1 / self.period:g} Hz, {where})"


def drive(study: Study, controller: Controller, name: str) -> Trace:
    """A study's run under somebody's controller."""
    plant = Plant(study, name=name, _driver=getattr(controller, "__qualname__", type(controller).__qualname__))
    answer = _answer(controller)
    while not plant.done:
        plant.step(answer(plant.sample))
    return plant.trace()


def _answer(controller: Any) -> Callable[[Sample], ArrayLike]:
    """The function from sample to torque that a controller is."""
    if isinstance(controller, _phihat.Controller):
        return lambda s: controller.update(s.q, s.dq, s.q_des, s.dq_des, s.ddq_des, s.tau_applied)
    update = getattr(controller, "update", controller)
    if callable(update):
        return update  # type: ignore[no-any-return]
    kind, limit = type(controller).__name__, "a function of a sample, or an object with update(sample)"
    raise ArgumentError(
        f"controller: {kind}; it must be {limit}", field="controller", value=controller, limit=limit
    )


@dataclass(frozen=True)
class ArmFacts:
    """What a law is told of the arm before a comparison's run.

    Attributes:
        inertia: nominal inertia of each joint [kg m^2].
        torque_max, torque_rate_max: limits of each joint [N m], [N m/s]; ``None``: there is none.
        delay_samples: samples from a torque's command to its acting.
        period: time between samples [s].
    """

    inertia: NDArray[np.float64]
    torque_max: NDArray[np.float64] | None
    torque_rate_max: NDArray[np.float64] | None
    delay_samples: int
    period: float


def declared(law: Any) -> dict[str, Any]:
    """A law of :func:`phihat.compare`, as the Rust half takes it."""
    name = getattr(law, "name", None)
    if not (isinstance(name, str) and re.fullmatch("[a-z0-9-]+", name)):
        raise _refused("name", name, "a text of a-z, 0-9 and -")
    scalars = getattr(law, "scalars", {})
    if not isinstance(scalars, Mapping):
        raise _refused("scalars", scalars, "a dictionary: name to (default, least, largest)")

    def make(values: dict[str, float], facts: dict[str, Any]) -> Callable[[Sample], list[float]]:
        def array(key: str) -> NDArray[np.float64] | None:
            return None if facts[key] is None else np.array(facts[key])

        limits = array("torque_max"), array("torque_rate_max")
        arm = ArmFacts(np.array(facts["inertia"]), *limits, facts["delay_samples"], facts["period"])
        answer = _answer(law(values, arm))
        return lambda sample: np.asarray(answer(sample), dtype=np.float64).tolist()

    return {
        "id": name,
        "title": str(getattr(law, "title", name)),
        "source": str(getattr(law, "source", "the user's own")),
        "law": inspect.getdoc(law) or name,
        "scalars": [_scalar(key, value) for key, value in scalars.items()],
        "preview": bool(getattr(law, "preview", False)),
        "edition": _edition(law),
        "make": make,
    }


def _scalar(name: Any, value: Any) -> tuple[str, str, str, list[float]]:
    limit = "(default, least, largest) with 0 < least <= default <= largest"
    try:
        default, least, largest = (float(number) for number in value)
    except (TypeError, ValueError):
        raise _refused(f"scalars[{name!r}]", value, limit) from None
    if not (0 < least <= default <= largest and math.isfinite(largest)):
        raise _refused(f"scalars[{name!r}]", value, limit)
    return str(name), "", str(name), [default, least, largest]


def _edition(law: Any) -> str:
    """What changes whenever the law does: the text of its module, else of itself, else new each time."""
    try:
        text = Path(inspect.getfile(law)).read_bytes()
    except (OSError, TypeError):
        try:
            text = inspect.getsource(law).encode()
        except (OSError, TypeError):
            text = os.urandom(16)
    return hashlib.sha256(text).hexdigest()


def _refused(field: str, value: Any, limit: str) -> ArgumentError:
    return ArgumentError(f"law: its {field} is {value!r}; it must be {limit}", field=field, value=value, limit=limit)
