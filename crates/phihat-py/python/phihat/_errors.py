"""The exceptions of phihat: each says what was wrong, where, with which value, and what would be right."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Error(Exception):
    """The root of phihat's exceptions.

    Attributes are ``None`` where they do not apply.

    Attributes:
        field: the argument, key or member that was refused.
        joint: the joint's name.
        value: the value that was refused.
        limit: what would be valid.
    """

    def __init__(
        self,
        message: str,
        *,
        field: str | None = None,
        joint: str | None = None,
        value: Any = None,
        limit: Any = None,
    ) -> None:
        super().__init__(message)
        self.field = field
        self.joint = joint
        self.value = value
        self.limit = limit


class ArgumentError(Error, ValueError):
    """An argument cannot be: wrong type, shape, memory order, or range."""


class RobotError(Error, ValueError):
    """A robot's description was refused."""


class GainsError(Error, ValueError):
    """Gains were refused, or do not fit."""


class StudyError(Error, ValueError):
    """A study was refused; ``field`` is the key, ``limit`` what would be right.

    Attributes:
        file, line, column: the place, from 1; 0 where the whole file is meant.
    """

    def __init__(
        self, message: str, *, file: str = "", line: int = 0, column: int = 0, **carried: Any
    ) -> None:
        super().__init__(message, **carried)
        self.file = file
        self.line = line
        self.column = column


class Infeasible(Error):
    """No gains keep every clause of a specification.

    Attributes:
        clauses: the clauses in the way, each with ``key``, ``joint``, ``wanted`` and ``possible``.
        budget: what the error of the law that missed the least is spent on, joint by joint, and the front of error
            against torque noise, as in budget.json; ``None`` where there is none. Which changes help is left to
            ``phihat design``, which designs for each.
    """

    def __init__(
        self, message: str, *, clauses: list[dict[str, Any]], budget: dict[str, Any] | None = None
    ) -> None:
        super().__init__(message)
        self.clauses = clauses
        self.budget = budget


class Refuted(Error):
    """A claim of a certificate does not hold: ``left`` and ``right`` of its ``inequality``."""

    def __init__(
        self, message: str, *, claim: str, inequality: str, left: float, right: float
    ) -> None:
        super().__init__(message, field=claim, value=left, limit=right)
        self.claim = claim
        self.inequality = inequality
        self.left = left
        self.right = right


class SampleRefused(Error, ValueError):
    """A sample held a value that is not finite, or beyond 2^32; the controller's state is as before.

    Attributes:
        tau: the torque to hold, the last one that was commanded [N m].
    """

    def __init__(
        self, message: str, *, tau: NDArray[np.float64] | None = None, **carried: Any
    ) -> None:
        super().__init__(message, **carried)
        self.tau = tau
