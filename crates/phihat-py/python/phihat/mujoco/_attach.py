"""The controller on a MuJoCo model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from .. import _phihat
from .._errors import ArgumentError
from ._motors import Motors, steps_per

Array = NDArray[np.float64]
Reference = Callable[[float], tuple[Array, Array, Array]]
"""Time [s] to ``q_des, dq_des, ddq_des``, float64 arrays in the gains' order."""


class Attached:
    """A controller that drives the motors of a MuJoCo model: see :func:`attach`.

    In a ``with`` block, or between :meth:`install` and :meth:`remove`, MuJoCo calls it (``mjcb_control``); without, call
    :meth:`update` before each step.

    Attributes:
        controller: what runs.
        joints: names of the joints, in the gains' order.
        samples: how many samples were answered.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        gains: _phihat.Gains,
        joints: Sequence[str] | None,
        reference: Reference | None,
        gravity: Literal["acting", "compensated"],
    ) -> None:
        names = list(joints) if joints is not None else gains.joint_names
        if len(names) != len(gains.joint_names):
            found, limit = f"{len(names)} joints", f"{len(gains.joint_names)}, as the gains have"
            raise ArgumentError(f"joints: {found}; it must be {limit}", field="joints", value=found, limit=limit)
        self.joints = names
        self._model, self._data = model, data
        self._motors = Motors(model, data, names, gravity)
        unlimited = _phihat.Controller(gains)
        most = np.minimum(unlimited.torque_max, self._motors.torque_max)
        self.controller = _phihat.Controller(gains, torque_max=most.tolist())
        steps_per(self.controller.period, model, "the gains")
        self._reference = reference if reference is not None else self._hold()
        self._start = float(data.time)
        self.samples = 0

    def update(self) -> None:
        """Answer a sample if one is due: reads the model's state, writes its motors' controls."""
        period = self.controller.period
        t = float(self._data.time) - self._start
        # A sample is due when its time has come, up to rounding of the simulator's clock.
        if t < self.samples * period - 1e-6 * period:
            return
        applied = self._motors.applied() if self.samples else np.zeros(len(self.joints))
        q_des, dq_des, ddq_des = self._reference(self.samples * period)
        tau = self.controller.update(self._motors.q, self._motors.dq, q_des, dq_des, ddq_des, applied)
        self._motors.command(tau)
        self.samples += 1

    def __call__(self, model: Any, data: Any) -> None:
        """What MuJoCo calls; other models and data are left alone."""
        if data is self._data or (model is self._model and data.time == self._data.time):
            self.update()

    def install(self) -> None:
        """Let MuJoCo call this controller; there is one such callback in a process."""
        if int(self._model.opt.integrator) == int(mujoco.mjtIntegrator.mjINT_RK4):
            limit = "an integrator of one stage, or update() before each mj_step"
            message = f"integrator: RK4 calls back inside of its steps; use {limit}"
            raise ArgumentError(message, field="integrator", value="RK4", limit=limit)
        if mujoco.get_mjcb_control() is not None:
            raise ArgumentError("attach: another control callback is installed", field="mjcb_control")
        mujoco.set_mjcb_control(self)

    def remove(self) -> None:
        """Take the callback out again."""
        mujoco.set_mjcb_control(None)

    def __enter__(self) -> Attached:
        self.install()
        return self

    def __exit__(self, *_: object) -> None:
        self.remove()

    def _hold(self) -> Reference:
        zero = np.zeros(len(self.joints))
        there = self._motors.q
        return lambda _t: (there, zero, zero)


def attach(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    gains: _phihat.Gains,
    *,
    joints: Sequence[str] | None = None,
    reference: Reference | None = None,
    gravity: Literal["acting", "compensated"] = "acting",
) -> Attached:
    """Put the controller on a MuJoCo model.

    >>> with phihat.mujoco.attach(model, data, gains, reference=motion):     # doctest: +SKIP
    ...     while data.time < 10.0:
    ...         mujoco.mj_step(model, data)

    The torque that acted is read back from the model (``qfrc_actuator``), so limits of the motors do no harm. The loop's
    period is the gains', a whole number of the model's time steps.

    Args:
        joints: the model's names of the gains' joints, in the gains' order; default: the same names.
        reference: time since now [s] to ``q_des, dq_des, ddq_des``; default: hold the present posture.
        gravity: ``"acting"``: the motors bear the arm's weight, as in MuJoCo; the controller finds it. ``"compensated"``: the
            interface adds the weight's torque to what is commanded, as a Franka or a KUKA FRI does; the model's gravity torque
            is added to every command and taken out of what is reported back.

    Raises:
        ArgumentError: a joint is not there, is not driven by exactly one torque motor, the time step does not divide the
            period, or the model compensates gravity although it is said to act.
    """
    return Attached(model, data, gains, joints, reference, gravity)
