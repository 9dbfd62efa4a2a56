"""An arm in MuJoCo as a robot that can be driven."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from ._clock import viewer
from ._joints import joint_ids, joint_names
from ._motors import Motors, steps_per

Array = NDArray[np.float64]


class Arm:
    """An arm in MuJoCo, for :func:`phihat.drive`.

    >>> arm = phihat.mujoco.Arm(model, data, rate_hz=1000.0)                     # doctest: +SKIP
    >>> driven = phihat.drive("studies/panda.toml", arm, accept=["supervisor"])  # doctest: +SKIP

    It is driven in lock-step: the model's time goes on when a sample is answered.

    Args:
        model: with a torque motor on each joint that is driven.
        data: its state; the arm stands where ``data.qpos`` says.
        rate_hz: samples per second, a whole part of the model's steps per second.
        joints: the study's name of each joint and the model's; default: every hinge and slide, under the model's own names.
        gravity: ``"acting"``: the motors bear the arm's weight; ``"compensated"``: the interface adds the weight's torque to what
            is commanded, as a Franka or a KUKA FRI does (``adds_gravity = true`` in the study's ``[profile]``).
        delay_samples: samples between a command and its torque, as ``delay_samples`` in the study's ``[loop]``.
        real_time: keep to the clock, and show the model where there is a display. For looking at: no figure depends on it.

    Raises:
        ArgumentError: a joint is not there or not driven by exactly one torque motor, or the time step does not divide the period.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        rate_hz: float,
        joints: Mapping[str, str] | None = None,
        gravity: Literal["acting", "compensated"] = "acting",
        delay_samples: int = 0,
        real_time: bool = False,
    ) -> None:
        all_names = joint_names(model)
        named = dict(joints) if joints is not None else {n: n for n in (all_names[i] for i in joint_ids(model, None))}
        self.name = f"{model.names.split(bytes(1), 1)[0].decode() or 'an arm'} in MuJoCo"
        self.model, self.data = model, data
        self.joint_names = list(named)
        self.period = 1.0 / rate_hz
        self.adds_gravity = gravity == "compensated"
        self._motors = Motors(model, data, list(named.values()), gravity)
        self._steps = steps_per(self.period, model, "the loop")
        self._late = deque(np.zeros(len(named)) for _ in range(delay_samples))
        self._acted = np.zeros(len(named))
        self._real_time, self._viewer, self._due = real_time, None, 0.0

    def read(self) -> tuple[Array, Array, Array]:
        """Position, velocity, and the torque that acted since the sample before."""
        return self._motors.q, self._motors.dq, self._acted

    def write(self, tau: Array) -> None:
        """Answer a sample: the model's time goes on by one period."""
        self._late.append(np.array(tau))
        self._motors.command(self._late.popleft())
        for _ in range(self._steps):
            mujoco.mj_step(self.model, self.data)
        self._acted = self._motors.applied()
        if self._real_time:
            self._wait()

    def finish(self) -> None:
        """Close what shows the model."""
        if self._viewer is not None:
            self._viewer.close()

    def _wait(self) -> None:
        if self._due == 0.0:
            self._viewer, self._due = viewer(self), time.perf_counter()
        self._due += self.period
        time.sleep(max(0.0, self._due - time.perf_counter()))
        if self._viewer is not None:
            self._viewer.sync()
