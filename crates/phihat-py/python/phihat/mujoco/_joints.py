"""Joints of a MuJoCo model by name, and the motors that drive them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._errors import ArgumentError

HINGE, SLIDE, FREE = (
    int(kind) for kind in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_FREE)
)


def joint_names(model: Any) -> list[str]:
    """Names of all joints; one that has none is called ``joint`` and its number."""
    return _named([str(model.joint(i).name) for i in range(model.njnt)], "joint")


def _named(names: list[str], what: str) -> list[str]:
    taken, all_named = set(names), []
    for at, name in enumerate(names):
        if not name:
            name = f"{what}{at}"
            while name in taken:
                name += "_"
            taken.add(name)
        all_named.append(name)
    return all_named


def joint_ids(model: Any, names: Sequence[str] | None) -> list[int]:
    """Joints by name, hinges and slides only; all of them if no name is given."""
    own = joint_names(model)
    if names is None:
        return [i for i in range(model.njnt) if model.jnt_type[i] in (HINGE, SLIDE)]
    found = []
    for name in names:
        if name not in own:
            known = ", ".join(own)
            raise ArgumentError(
                f"joints: the model has no joint {name!r}; there are {known}",
                field="joints",
                joint=name,
                value=name,
                limit=known,
            )
        at = own.index(name)
        if model.jnt_type[at] not in (HINGE, SLIDE):
            raise ArgumentError(
                f"joints: {name!r} is neither hinge nor slide", field="joints", joint=name, value=name
            )
        found.append(at)
    return found


def motors(model: Any, joints: Sequence[int]) -> tuple[NDArray[np.int_], NDArray[np.float64]]:
    """The motor of each joint and its torque per unit of control.

    A motor's torque is its control times a constant: no gain, bias or dynamics that depend on the state.
    """
    ids, factors = [], []
    for joint in joints:
        name = joint_names(model)[joint]
        on_joint = model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)
        own = np.flatnonzero(on_joint & (model.actuator_trnid[:, 0] == joint))
        if len(own) != 1:
            raise _no_motor(name, f"{len(own)} actuators", "exactly one motor")
        at = int(own[0])
        plain = (
            model.actuator_gaintype[at] == int(mujoco.mjtGain.mjGAIN_FIXED)
            and model.actuator_biastype[at] == int(mujoco.mjtBias.mjBIAS_NONE)
            and model.actuator_dyntype[at] == int(mujoco.mjtDyn.mjDYN_NONE)
        )
        if not plain:
            raise _no_motor(name, "an actuator that is no torque motor", "<motor>, without gain, bias or dynamics")
        ids.append(at)
        factors.append(float(model.actuator_gainprm[at, 0] * model.actuator_gear[at, 0]))
    return np.array(ids), np.array(factors)


def torque_limits(
    model: Any, joints: Sequence[int], ids: NDArray[np.int_], factors: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Largest torque of each joint's motor [N m]; infinite where nothing limits it."""
    limits = np.full(len(ids), np.inf)
    for i, (joint, at, factor) in enumerate(zip(joints, ids, factors)):
        if model.actuator_ctrllimited[at]:
            low, high = model.actuator_ctrlrange[at]
            limits[i] = min(limits[i], abs(factor) * min(-low, high))
        if model.actuator_forcelimited[at]:
            low, high = model.actuator_forcerange[at]
            limits[i] = min(limits[i], abs(model.actuator_gear[at, 0]) * min(-low, high))
        if model.jnt_actfrclimited[joint]:
            low, high = model.jnt_actfrcrange[joint]
            limits[i] = min(limits[i], -low, high)
    return limits


def _no_motor(joint: str, found: str, limit: str) -> ArgumentError:
    message = f"joint {joint}: {found}; it must be driven by {limit}"
    return ArgumentError(message, field="actuator", joint=joint, value=found, limit=limit)
