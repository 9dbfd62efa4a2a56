"""A robot's description from a MuJoCo model."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np

from .. import _phihat
from .._errors import ArgumentError
from ._joints import FREE, HINGE, body_names, joint_ids, joint_names, motors, torque_limits
from ._rotation import about, matrix, rpy


def describe(
    model: mujoco.MjModel,
    path: str | os.PathLike[str],
    *,
    joints: Sequence[str] | None = None,
    tip: str | None = None,
) -> _phihat.Robot:
    """Write what a MuJoCo model says of an arm as a URDF, with a TOML file beside it for what URDF lacks.

    Bodies, inertias, joint axes and limits, rotor inertia (``armature``), viscous (``damping``) and dry friction
    (``frictionloss``), and torque limits of motors are taken over; geometry, contacts and equality constraints are not.
    Joints and bodies without a name are called ``joint`` or ``body`` and their number. A base that floats is held fixed,
    and the robot's ``warnings`` say so.

    Args:
        path: the URDF to write; its name without ``.urdf`` is the robot's.
        joints: the arm's joints, by name; all others stay where the model's reference posture has them. Default: all; of
            a scene in which more than one tree has joints, they must be named.
        tip: the body at which payloads are held; default: the last that the last joint moves.

    Returns:
        The robot, as :meth:`phihat.Robot.from_urdf` reads it from the TOML file, under the model's gravity.
    """
    path = Path(path)
    moving = joint_ids(model, joints)
    if not moving:
        raise ArgumentError("joints: the model has no hinge or slide", field="joints")
    _check_one_tree(model, moving, joints)
    if not re.fullmatch(r"[a-z0-9_-]{1,64}", path.stem):
        raise ArgumentError(
            f"path: the robot's name {path.stem!r} must be 1 to 64 of a-z, 0-9, _ and -", field="path", value=path.stem
        )
    last = int(model.jnt_bodyid[moving[-1]])
    inside = [b for b in range(1, model.nbody) if model.body_rootid[b] == model.body_rootid[last]]
    names = body_names(model)
    tip = tip if tip is not None else names[max(b for b in inside if _below(model, b, last))]
    if tip not in [names[b] for b in inside]:
        limit = ", ".join(names[b] for b in inside)
        raise ArgumentError(
            f"tip: the arm has no body {tip!r}; there are {limit}", field="tip", value=tip, limit=limit
        )
    lines = [f"<robot name={quoteattr(path.stem)}>", '  <link name="world"/>']
    for body in inside:
        lines += _body(model, body, moving)
    companion, rest = path.with_suffix(".toml"), _toml(model, moving, path, tip)
    path.write_text("\n".join([*lines, "</robot>"]) + "\n")
    companion.write_text(rest)
    x, y, z = (float(g) for g in model.opt.gravity)
    return _phihat.Robot.from_urdf(companion, gravity=(x, y, z))


def _check_one_tree(model: Any, moving: list[int], asked: Sequence[str] | None) -> None:
    """An arm's joints all hang on one body that stands in the world."""
    joints, bodies = joint_names(model), body_names(model)
    trees: dict[str, list[str]] = {}
    for joint in moving:
        root = bodies[int(model.body_rootid[int(model.jnt_bodyid[joint])])]
        trees.setdefault(root, []).append(joints[joint])
    if len(trees) == 1:
        return
    found = "; ".join(f"{root}: {', '.join(own)}" for root, own in trees.items())
    remedy = "name those of the arm" if asked is None else "an arm's hang on one body"
    raise ArgumentError(
        f"joints: they hang on {len(trees)} bodies of the scene ({found}); {remedy}", field="joints", value=found
    )


def _body(model: Any, body: int, moving: list[int]) -> list[str]:
    """A link, and the joints between it and its parent's, each with a link of its own at its anchor."""
    names, parent = body_names(model), int(model.body_parentid[body])
    name, above = names[body], "world" if parent == 0 else names[parent]
    at, turn = np.array(model.body_pos[body]), matrix(model.body_quat[body])
    first = int(model.body_jntadr[body])
    own = [j for j in range(first, first + int(model.body_jntnum[body])) if j in moving]
    lines = []
    for joint in own:
        # The axis is fixed in the body's reference posture; the body turns about its anchor.
        anchor, axis = at + turn @ model.jnt_pos[joint], model.jnt_axis[joint]
        reference = float(model.qpos0[model.jnt_qposadr[joint]])
        hinge = int(model.jnt_type[joint]) == HINGE
        back = _about_axis(axis, -reference) if hinge else np.eye(3)
        start = anchor if hinge else anchor - reference * (turn @ axis)
        middle = f"{name}/{joint_names(model)[joint]}"
        lines.append(f"  <link name={quoteattr(middle)}/>")
        lines += _joint(model, joint, above, middle, start, turn @ back)
        above, at, turn = middle, -np.array(model.jnt_pos[joint]), np.eye(3)
    lines.append(f"  <link name={quoteattr(name)}>")
    mass = float(model.body_mass[body])
    if mass > 0.0:
        frame = matrix(model.body_iquat[body])
        inertia = frame @ np.diag(model.body_inertia[body]) @ frame.T
        lines += [
            "    <inertial>",
            f"      <origin xyz={_numbers(model.body_ipos[body])}/>",
            f"      <mass value={_numbers([mass])}/>",
            "      <inertia " + " ".join(f"i{k}={_numbers([v])}" for k, v in _six(inertia)) + "/>",
            "    </inertial>",
        ]
    lines.append("  </link>")
    floats = any(int(model.jnt_type[j]) == FREE for j in range(first, first + int(model.body_jntnum[body])))
    kind = "floating" if floats else "fixed"
    lines.append(f'  <joint name={quoteattr("to " + name)} type="{kind}">')
    lines += [*_ends(above, name), _origin(at, turn), "  </joint>"]
    return lines


def _joint(model: Any, joint: int, above: str, below: str, at: Any, turn: Any) -> list[str]:
    hinge, limited = int(model.jnt_type[joint]) == HINGE, bool(model.jnt_limited[joint])
    kind = "prismatic" if not hinge else "revolute" if limited else "continuous"
    lines = [f'  <joint name={quoteattr(joint_names(model)[joint])} type="{kind}">', *_ends(above, below)]
    lines += [_origin(at, turn), f"    <axis xyz={_numbers(model.jnt_axis[joint])}/>"]
    if limited:
        low, high = model.jnt_range[joint]
        # URDF wants effort and speed; 0 says that there is no figure.
        lines.append(f'    <limit lower={_numbers([low])} upper={_numbers([high])} effort="0" velocity="0"/>')
    elif not hinge:
        name = joint_names(model)[joint]
        raise ArgumentError(f"joint {name}: a slide without range; URDF has no such joint", field="range", joint=name)
    return [*lines, "  </joint>"]


def _toml(model: Any, moving: list[int], path: Path, tip: str) -> str:
    dofs = [int(model.jnt_dofadr[j]) for j in moving]
    source = "the MuJoCo model"
    text = [
        f'name = "{path.stem}"',
        f'description = "{path.stem}, from a MuJoCo model"',
        f'urdf = "{path.name}"',
        f"tip = {_string(tip)}",
        'licence = "that of the MuJoCo model"',
        f'provenance = "phihat.mujoco.describe, MuJoCo {mujoco.__version__}"',
        "joints = [" + ", ".join(_string(joint_names(model)[j]) for j in moving) + "]",
        "\n[rotor]",
        f"armature_kg_m2 = {_list(model.dof_armature[dofs])}",
        f'source = "{source}: armature"',
        "\n[friction]",
        f"viscous_nm_s_rad = {_list(model.dof_damping[dofs])}",
        f"coulomb_nm = {_list(model.dof_frictionloss[dofs])}",
        f'source = "{source}: damping, frictionloss"',
    ]
    try:
        limits = torque_limits(model, moving, *motors(model, moving))
    except ArgumentError:
        limits = np.full(len(moving), np.inf)
    if np.isfinite(limits).all():
        text += ["\n[limits]", f"torque_max_nm = {_list(limits)}", f'source = "{source}: its motors"']
    return "\n".join(text) + "\n"


def _below(model: Any, body: int, root: int) -> bool:
    while body not in (0, root):
        body = int(model.body_parentid[body])
    return body == root


def _about_axis(axis: Any, angle: float) -> Any:
    if angle == 0.0:
        return np.eye(3)
    z = np.asarray(axis, dtype=float)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    frame = np.column_stack([x, np.cross(z, x), z])
    return frame @ about(2, angle) @ frame.T


def _six(inertia: Any) -> list[tuple[str, float]]:
    return [(a + b, float(inertia["xyz".index(a), "xyz".index(b)])) for a, b in ("xx", "xy", "xz", "yy", "yz", "zz")]


def _ends(above: str, below: str) -> list[str]:
    return [f"    <parent link={quoteattr(above)}/>", f"    <child link={quoteattr(below)}/>"]


def _origin(at: Any, turn: Any) -> str:
    return f"    <origin xyz={_numbers(at)} rpy={_numbers(rpy(turn))}/>"


def _numbers(values: Any) -> str:
    return '"' + " ".join(repr(float(x)) for x in values) + '"'


def _list(values: Any) -> str:
    return "[" + ", ".join(repr(float(x)) for x in values) + "]"


def _string(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
