"""A second opinion: the same study with the same gains in our plant and in MuJoCo.

MuJoCo runs the study under the *same equations* (our friction law, Runge-Kutta of order 4, the same steps), and with *its
own* integrator and friction (implicit, dry friction as a constraint that can stick), which shows what these choices are worth.

Whether the engines agree is judged sample by sample: under the same equations, from the state that our plant has at a
sample, MuJoCo must come to the state that ours has at the next. Whole trajectories are compared too, but encoder steps and
dry friction make them sensitive: rounding alone grows by a factor of 30 each second in the study of the Panda.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _phihat
from ._errors import Error
from ._document import Study, source
from .study import simulate
from .trace import Trace

Array = NDArray[np.float64]

TOLERANCE = 1e-9
"""Largest difference after one sample under the same equations [rad, rad/s]."""

STEP_S = 2.5e-4
"""Longest step of MuJoCo's own integrator."""

MODELLED: dict[str, set[str]] = {
    "robot": {"name", "file", "locked"},
    "loop": {"rate_hz", "delay_samples", "form", "torque_max_nm", "torque_rate_max_nm_s"},
    "sensor": {"encoder_bits", "velocity", "velocity_filter_hz"},
    "world": {
        "gravity_m_s2",
        "friction",
        "coulomb_extra_nm",
        "viscous_extra_nm_s_rad",
        "drive_bandwidth_hz",
        "substeps",
        "payload",
        "push",
    },
}
"""Keys of a study that the MuJoCo side knows; those of other sections do not concern the plant."""

OTHERS = {"title", "seed", "duration_s", "spec", "design", "gains", "start", "reference"}


@dataclass(frozen=True)
class Crosscheck:
    """What :func:`crosscheck` found; ``str()`` of it is a table with its explanation.

    Attributes:
        study: the study's name.
        joint_names: the order of all arrays.
        ours: the trace of our plant.
        q_same: positions in MuJoCo under the same equations, samples down [rad].
        q_own: positions in MuJoCo with its own integrator and friction [rad].
        step: largest difference that one sample makes under the same equations, of each joint, ``dq`` [rad/s] and ``q``
            [rad] alike.
        same: largest ``|q_same - q|`` of each joint [rad].
        own: largest ``|q_own - q|`` of each joint [rad].
        errors: largest ``|e|`` after the transient: ours, same, own [rad].
    """

    study: str
    joint_names: list[str]
    ours: Trace
    q_same: Array
    q_own: Array
    step: Array
    same: Array
    own: Array
    errors: tuple[Array, Array, Array]

    @property
    def agrees(self) -> bool:
        """Whether each sample takes MuJoCo under the same equations where it takes our plant, to ``TOLERANCE``."""
        return bool(self.step.max() <= TOLERANCE)

    def __str__(self) -> str:
        width = max(len(name) for name in self.joint_names)
        head = f"{'':{width}}   max |e| after the transient [mrad]   max |Δq| [rad]      one sample"
        names = f"{'joint':{width}}   ours      same      MuJoCo's      same      MuJoCo's   [rad/s]"
        rows = [
            f"{name:{width}}   {1e3 * a:<9.4f} {1e3 * b:<9.4f} {1e3 * c:<9.4f}     {d:<9.1e} {e:<9.1e}  {f:.1e}"
            for name, a, b, c, d, e, f in zip(self.joint_names, *self.errors, self.same, self.own, self.step)
        ]
        verdict = "agree" if self.agrees else "DO NOT agree"
        return "\n".join(
            [
                f"{self.study}: our plant and MuJoCo",
                head,
                names,
                *rows,
                f"same equations (RK4, our friction law, the same steps): sample by sample they {verdict} to {TOLERANCE:.0e} rad/s;",
                "over a run, encoder steps and dry friction let rounding grow",
                "MuJoCo's own (implicitfast, damping, frictionloss): its integrator, and dry friction that sticks where ours,",
                "smooth within 1 mrad/s of rest, creeps",
            ]
        )

    def as_document(self) -> dict[str, Any]:
        """The figures, for ``--json``."""
        return {
            "study": self.study,
            "agrees": self.agrees,
            "joints": [
                {
                    "name": name,
                    "error_ours_rad": a,
                    "error_same_equations_rad": b,
                    "error_mujoco_rad": c,
                    "difference_same_equations_rad": d,
                    "difference_mujoco_rad": e,
                    "difference_one_sample_rad_s": f,
                }
                for name, a, b, c, d, e, f in zip(
                    self.joint_names,
                    *(x.tolist() for x in self.errors),
                    self.same.tolist(),
                    self.own.tolist(),
                    self.step.tolist(),
                )
            ],
        }


def crosscheck(
    study: Study, *, gains: _phihat.Gains | None = None, uncertified: bool = False, name: str = "python"
) -> Crosscheck:
    """Run a study in our plant and in MuJoCo, with the same gains, sensors, delay and drives, and compare.

    Raises:
        Error: the study has something in its world that is not modelled on the MuJoCo side.
    """
    path, document = source(study)
    plan, robot = _phihat.study_document(path, document, name)
    _refuse_what_is_not_modelled(plan["as_written"])
    ours = simulate(study, gains=gains, uncertified=uncertified, name=name)
    if ours.divergence is not None:
        raise Error(f"our plant diverged at {ours.divergence[0]} s; there is nothing to compare")
    loop = Loop(plan, robot, ours)
    q_same, q_own = loop.run(own=False), loop.run(own=True)
    q, desired = ours["q"], ours["q_desired"]
    steady = ours.t >= plan["settle_s"]

    def worst(positions: Array) -> Array:
        return np.asarray(np.abs(positions - desired)[steady].max(axis=0))

    return Crosscheck(
        study=plan["name"],
        joint_names=ours.joint_names,
        ours=ours,
        q_same=q_same,
        q_own=q_own,
        step=loop.step_by_step(),
        same=np.abs(q_same - q).max(axis=0),
        own=np.abs(q_own - q).max(axis=0),
        errors=(worst(q), worst(q_same), worst(q_own)),
    )


class Loop:
    """The control loop around a MuJoCo plant: sensors, controller, delay, drives, as the study says."""

    def __init__(self, plan: dict[str, Any], robot: _phihat.Robot, ours: Trace) -> None:
        payload = plan["payload"]
        if payload is not None:
            body = payload["mass_kg"], payload["com_m"], payload["inertia_kg_m2"]
            robot = robot.with_payload(payload["frame"], *body)
        self.plan, self.robot, self.ours = plan, robot, ours
        self.n = len(ours.joint_names)
        self.period = 1e-9 * plan["period_ns"]

    def plant(self, own: bool) -> Plant:
        """A fresh plant at the study's start."""
        return Plant(self.plan, self.robot, own, (self.ours["q"][0], self.ours["dq"][0]))

    def controller(self) -> _phihat.Controller:
        """The study's controller, behind its limits."""
        none = [math.inf] * self.n
        return _phihat.Controller(
            self.ours.gains,
            torque_max=self.plan["torque_max_nm"] or none,
            torque_rate_max=self.plan["torque_rate_max_nm_s"] or none,
            form=self.plan["form"],
        )

    def step_by_step(self) -> Array:
        """From our state at every sample to the next: largest difference of each joint, position and velocity."""
        q, dq = self.ours["q"], self.ours["dq"]
        worst = np.zeros(self.n)

        def compare(k: int, plant: Plant) -> None:
            nonlocal worst
            if not k:
                return
            worst = np.maximum(worst, np.maximum(np.abs(plant.q - q[k]), np.abs(plant.dq - dq[k])))
            plant.set(q[k], dq[k])

        self.run(own=False, before=compare)
        return worst

    def run(
        self,
        own: bool,
        before: Callable[[int, Plant], None] | None = None,
        after: Callable[[int], None] | None = None,
    ) -> Array:
        """Positions at every sample; ``before`` and ``after`` are told of each."""
        plant, controller = self.plant(own), self.controller()
        sensor = Sensor(self.plan, self.n)
        line = [np.zeros(self.n) for _ in range(self.plan["delay_samples"])]
        applied = np.zeros(self.n)
        desired = [self.ours[name] for name in ("q_desired", "dq_desired", "ddq_desired")]
        positions = np.zeros((len(self.ours), self.n))
        for k in range(len(self.ours)):
            if before is not None:
                before(k, plant)
            positions[k] = plant.q
            q, dq = sensor.sense(plant.q, plant.dq)
            tau = controller.update(q, dq, desired[0][k], desired[1][k], desired[2][k], applied)
            line.append(tau)
            applied = plant.advance(line.pop(0))
            if after is not None:
                after(k)
        return positions


class Sensor:
    """Encoders and velocities, as docs/study.md describes them."""

    def __init__(self, plan: dict[str, Any], n: int) -> None:
        bits, cutoff = plan["encoder_bits"], plan["velocity_filter_hz"]
        self.period = 1e-9 * plan["period_ns"]
        self.quantum = None if bits is None else 2.0 * np.pi / 2.0 ** np.array(bits, dtype=float)
        self.measured = bool(plan["velocity_measured"])
        self.share = 1.0 if cutoff is None else -math.expm1(-2.0 * math.pi * cutoff * self.period)
        self.last: tuple[Array, Array] | None = None

    def sense(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Position and velocity as the controller gets them."""
        position = np.array(q) if self.quantum is None else self.quantum * _round(q / self.quantum)
        if self.last is None:
            self.last = position, np.array(dq)
            return self.last
        before, filtered = self.last
        raw = dq if self.measured else (position - before) / self.period
        velocity = filtered + self.share * (raw - filtered) if self.share < 1.0 else np.array(raw)
        self.last = position, velocity
        return self.last


class Plant:
    """A MuJoCo model with the study's drives, friction and pushes as forces of its own."""

    def __init__(self, plan: dict[str, Any], robot: _phihat.Robot, own: bool, start: tuple[Array, Array]) -> None:
        import mujoco

        from .mujoco._build import build
        from .mujoco._joints import joint_ids

        self.mujoco, self.robot, self.own = mujoco, robot, own
        self.period_ns, self.period, substeps = plan["period_ns"], 1e-9 * plan["period_ns"], plan["substeps"]
        self.steps = max(substeps, math.ceil(self.period / STEP_S)) if own else substeps
        self.identified = bool(plan["robot_friction"])
        self.viscous, self.coulomb = np.array(plan["extra_viscous_nm_s_rad"]), np.array(plan["extra_coulomb_nm"])
        self.model = build(
            robot,
            timestep=self.period / self.steps,
            integrator="implicitfast" if own else "RK4",
            damping=own and self.identified,
            friction=own and self.identified,
        )
        ids = joint_ids(self.model, robot.joint_names)
        self.at, self.dof = self.model.jnt_qposadr[ids].copy(), self.model.jnt_dofadr[ids].copy()
        if own:
            self.model.dof_damping[self.dof] += self.viscous
            self.model.dof_frictionloss[self.dof] += self.coulomb
        self.data = mujoco.MjData(self.model)
        self.data.qpos[self.at], self.data.qvel[self.dof] = start
        bandwidth = plan["drive_bandwidth_hz"]
        n = len(ids)
        self.rate = np.full(n, np.inf) if bandwidth is None else 2.0 * np.pi * np.array(bandwidth, dtype=float)
        self.demand, self.gap, self.began, self.step_began = np.zeros(n), np.zeros(n), 0.0, 0.0
        self.pushes = plan["pushes"]
        self.samples = 0

    @property
    def q(self) -> Array:
        """Position [rad]."""
        return np.array(self.data.qpos[self.at])

    @property
    def dq(self) -> Array:
        """Velocity [rad/s]."""
        return np.array(self.data.qvel[self.dof])

    def set(self, q: Array, dq: Array) -> None:
        """Put the arm into a state; the drives stay as they are."""
        self.data.qpos[self.at], self.data.qvel[self.dof] = q, dq

    def advance(self, demand: Array) -> Array:
        """Hold a torque demand for one period; returns the mean torque that acted [N m]."""
        lagging = np.isfinite(self.rate)
        self.gap = np.where(lagging, self.gap + self.demand - demand, 0.0)
        self.demand, self.began = demand, 1e-9 * (self.samples * self.period_ns)
        self.mujoco.set_mjcb_passive(self._forces)
        try:
            for step in range(self.steps):
                # Pushes begin and end with a step.
                self.step_began = self.began + step * (self.period / self.steps)
                self.data.time = self.step_began
                self.mujoco.mj_step(self.model, self.data)
        finally:
            self.mujoco.set_mjcb_passive(None)
        self.samples += 1
        angle = np.where(lagging, self.rate, 1.0) * self.period
        mean = demand - np.where(lagging, self.gap * np.expm1(-angle) / angle, 0.0)
        self.gap = np.where(lagging, self.gap * np.exp(-angle), 0.0)
        return np.asarray(mean)

    def _forces(self, _model: Any, data: Any) -> None:
        """MuJoCo asks at every stage of its integrator."""
        t, speed = float(data.time), np.array(data.qvel[self.dof])
        tau = self.demand.copy()
        lagging = np.isfinite(self.rate)
        if lagging.any():
            tau[lagging] += self.gap[lagging] * np.exp(-self.rate[lagging] * (t - self.began))
        for push in self.pushes:
            if push["start_s"] <= self.step_began < push["start_s"] + push["duration_s"]:
                tau[push["joint"]] += push["torque_nm"]
        if self.own:
            tau -= self.robot.smooth_friction(speed) if self.identified else 0.0
        else:
            own = self.identified
            tau -= self.robot.friction_torque(speed, own, self.viscous.tolist(), self.coulomb.tolist())
        data.qfrc_passive[self.dof] += tau


def _round(x: Array) -> Array:
    """To the nearest whole number, halves away from zero."""
    return np.asarray(np.copysign(np.floor(np.abs(x) + 0.5), x))


def _refuse_what_is_not_modelled(written: dict[str, Any]) -> None:
    for section, keys in written.items():
        if section in OTHERS:
            continue
        known = MODELLED.get(section)
        extra = [section] if known is None else [f"{section}.{key}" for key in keys if key not in known]
        if section == "world" and any("force_n" in push for push in keys.get("push", [])):
            extra.append("world.push.force_n")
        if extra:
            raise Error(
                f"{extra[0]}: not modelled on the MuJoCo side; a crosscheck without it would compare two worlds",
                field=extra[0],
            )


def main(arguments: Sequence[str]) -> int:
    """``phihat crosscheck``; exit code 1 where the plants do not agree."""
    parser = argparse.ArgumentParser(
        prog="phihat crosscheck",
        description="Run a study in our plant and in MuJoCo, with the same gains, and compare. Exit code 1: they do not agree.",
    )
    parser.add_argument("study", help="the study file (TOML)")
    parser.add_argument("--gains", metavar="FILE", help="use these gains (a gains.json) in place of the study's")
    parser.add_argument("--uncertified", action="store_true", help="run gains even where they may not run")
    parser.add_argument("--json", action="store_true", help="print one JSON document in place of the table")
    parser.add_argument(
        "--real-time",
        action="store_true",
        help="also run MuJoCo by the clock, in its viewer where there is a display, and print how late samples were",
    )
    given = parser.parse_args(arguments)
    import sys

    try:
        gains = _phihat.Gains.from_file(given.gains) if given.gains else None
        found = crosscheck(given.study, gains=gains, uncertified=given.uncertified)
        print(json.dumps(found.as_document(), indent=2) if given.json else found)
        if given.real_time:
            from .mujoco._clock import real_time

            plan, robot = _phihat.study_document(given.study, None, "python")
            print(real_time(Loop(plan, robot, found.ours)), file=sys.stderr if given.json else sys.stdout)
    except Error as why:
        print(f"error: {why}", file=sys.stderr)
        return 2
    except ImportError:
        print("error: mujoco is missing: pip install 'phihat[mujoco]'", file=sys.stderr)
        return 2
    return 0 if found.agrees else 1
