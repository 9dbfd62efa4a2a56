"""What a controller sees of an arm in MuJoCo, and the torques that it tells it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._errors import ArgumentError
from ._joints import joint_ids, motors, torque_limits

Array = NDArray[np.float64]


class Motors:
    """The torque motors of some joints of a model, in their order.

    Attributes:
        torque_max: largest torque of each motor [N m]; infinite where nothing limits it.
    """

    def __init__(self, model: Any, data: Any, joints: Sequence[str], gravity: Literal["acting", "compensated"]) -> None:
        ids = joint_ids(model, joints)
        self._model, self._data = model, data
        self._qpos, self._dof = model.jnt_qposadr[ids].copy(), model.jnt_dofadr[ids].copy()
        self._ids, self._factors = motors(model, ids)
        self.torque_max = torque_limits(model, ids, self._ids, self._factors)
        self._scratch = mujoco.MjData(model) if _is_compensated(model, ids, gravity) else None
        self._added = np.zeros(len(ids))

    @property
    def q(self) -> Array:
        """Position of each joint [rad, m]."""
        return np.array(self._data.qpos[self._qpos])

    @property
    def dq(self) -> Array:
        """Velocity of each joint [rad/s, m/s]."""
        return np.array(self._data.qvel[self._dof])

    def applied(self) -> Array:
        """Torque that acted in the last step, without what the interface adds [N m]."""
        return np.array(self._data.qfrc_actuator[self._dof]) - self._added

    def command(self, tau: Array) -> None:
        """Tell a torque per joint [N m]; it acts from the next step on."""
        self._added = self._gravity()
        self._data.ctrl[self._ids] = (tau + self._added) / self._factors

    def _gravity(self) -> Array:
        """The torque that the robot's own interface adds."""
        if self._scratch is None:
            return self._added
        self._scratch.qpos[:] = self._data.qpos
        self._scratch.qvel[:] = 0.0
        mujoco.mj_fwdPosition(self._model, self._scratch)
        mujoco.mj_fwdVelocity(self._model, self._scratch)
        return np.array(self._scratch.qfrc_bias[self._dof])


def steps_per(period: float, model: Any, whose: str) -> int:
    """How many steps of a model make a loop's period."""
    step = float(model.opt.timestep)
    steps = round(period / step)
    if steps < 1 or abs(steps * step - period) > 1e-9 * period:
        limit = f"a whole part of {period} s"
        raise ArgumentError(
            f"timestep: {step} s; it must be {limit}, the period of {whose}", field="timestep", value=step, limit=limit
        )
    return steps


def _is_compensated(model: Any, ids: list[int], gravity: str) -> bool:
    if gravity not in ("acting", "compensated"):
        limit = '"acting" or "compensated"'
        raise ArgumentError(f"gravity: {gravity!r}; it must be {limit}", field="gravity", value=gravity, limit=limit)
    first = int(model.jnt_bodyid[ids[0]])
    helped = [b for b in range(model.nbody) if model.body_rootid[b] == model.body_rootid[first]]
    if any(model.body_gravcomp[b] != 0.0 for b in helped):
        raise ArgumentError(
            "gravity: bodies of the arm have gravcomp, a passive force that no torque limit knows of; remove it, and say "
            'gravity="compensated" if the robot\'s interface adds gravity',
            field="gravcomp",
        )
    return gravity == "compensated"
