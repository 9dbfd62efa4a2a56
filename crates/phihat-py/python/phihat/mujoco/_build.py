"""A MuJoCo model of a robot."""

from __future__ import annotations

from typing import Any
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np
from numpy.typing import NDArray

from .. import _phihat
from .._errors import ArgumentError
from ._rotation import quaternion


def build(
    robot: _phihat.Robot,
    *,
    timestep: float = 1e-3,
    integrator: str = "implicitfast",
    armature: bool = True,
    damping: bool = True,
    friction: bool = True,
) -> mujoco.MjModel:
    """Make a MuJoCo model of a robot: bodies, joints, one motor per joint; of geometry only what a viewer can show.

    The model is made from what the robot computes (poses, Jacobians, dynamic parameters), so it is the robot with its
    locked joints and payload, under its gravity.

    Args:
        timestep: of the simulation [s].
        integrator: MuJoCo's: ``Euler``, ``RK4``, ``implicit``, ``implicitfast``.
        armature: with rotor inertia.
        damping: with viscous friction, as MuJoCo's ``damping``.
        friction: with dry friction, as MuJoCo's ``frictionloss``; the smooth part of an identified law has no counterpart.
    """
    n = len(robot.joint_names)
    zero = np.zeros(n)
    poses = [robot.frame_pose(zero, frame) for frame in robot.joint_frames]
    jacobians = [robot.jacobian(zero, frame) for frame in robot.joint_frames]
    parents = [_parent(jacobians, joint) for joint in range(n)]
    children: dict[int, list[int]] = {}
    for joint, parent in enumerate(parents):
        children.setdefault(parent, []).append(joint)
    losses = {
        "armature": robot.joint_values("armature") if armature else zero,
        "damping": robot.joint_values("viscous") if damping else zero,
        "frictionloss": robot.joint_values("coulomb") if friction else zero,
    }

    def body(joint: int, parent: NDArray[np.float64]) -> list[str]:
        there = np.linalg.inv(parent) @ poses[joint]
        lines = [f"<body name={quoteattr(robot.joint_frames[joint])} {_place(there)}>"]
        lines.append(_inertial(robot, joint))
        lines.append(_joint(robot, joint, poses[joint], jacobians[joint], {k: v[joint] for k, v in losses.items()}))
        for child in children.get(joint, []):
            lines += _bone(np.linalg.inv(poses[joint]) @ poses[child])
            lines += body(child, poses[joint])
        return [*lines, "</body>"]

    gravity = _numbers(robot.gravity_m_s2)
    lines = [
        f"<mujoco model={quoteattr(robot.name)}>",
        '<compiler angle="radian" autolimits="true" balanceinertia="false" inertiafromgeom="false"/>',
        f'<option timestep="{timestep!r}" integrator="{integrator}" gravity={gravity}/>',
        '<option><flag contact="disable"/></option>',
        "<worldbody>",
    ]
    for root in children.get(-1, []):
        lines += body(root, np.eye(4))
    lines += ["</worldbody>", "<actuator>"]
    for name, most in zip(robot.joint_names, robot.joint_values("torque_max")):
        limit = f' ctrlrange="{-most!r} {most!r}"' if np.isfinite(most) else ""
        lines.append(f"<motor name={quoteattr(name)} joint={quoteattr(name)}{limit}/>")
    lines += ["</actuator>", "</mujoco>"]
    return mujoco.MjModel.from_xml_string("\n".join(lines))


def _parent(jacobians: list[NDArray[np.float64]], joint: int) -> int:
    """The joint before this one: of those that move its frame, the one moved by the most."""
    moves = [i for i in range(joint) if np.abs(jacobians[joint][:, i]).max() > 0.0]
    depth = [sum(np.abs(jacobians[i][:, k]).max() > 0.0 for k in range(i)) for i in moves]
    return moves[int(np.argmax(depth))] if moves else -1


def _inertial(robot: _phihat.Robot, joint: int) -> str:
    m, cx, cy, cz, xx, xy, yy, xz, yz, zz = robot.dynamic_parameters[joint]
    if m <= 0.0:
        name = robot.joint_frames[joint]
        raise ArgumentError(f"body {name}: no mass; MuJoCo has no such moving bodies", field="mass", value=float(m))
    com = np.array([cx, cy, cz]) / m
    about_origin = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    about_com = about_origin - m * (com @ com * np.eye(3) - np.outer(com, com))
    principal, axes = np.linalg.eigh(about_com)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    inertia = _numbers(np.maximum(principal, 1e-15))
    turned = _numbers(quaternion(axes))
    return f'<inertial mass="{float(m)!r}" pos={_numbers(com)} quat={turned} diaginertia={inertia}/>'


def _joint(
    robot: _phihat.Robot,
    joint: int,
    pose: NDArray[np.float64],
    jacobian: NDArray[np.float64],
    losses: dict[str, Any],
) -> str:
    slide = robot.joint_kinds[joint] == "prismatic"
    axis = pose[:3, :3].T @ (jacobian[:3, joint] if slide else jacobian[3:, joint])
    kind = "slide" if slide else "hinge"
    attributes = "".join(f' {key}="{float(value)!r}"' for key, value in losses.items() if value)
    return f'<joint name={quoteattr(robot.joint_names[joint])} type="{kind}" axis={_numbers(axis)}{attributes}/>'


def _bone(to: NDArray[np.float64]) -> list[str]:
    """Something to look at; it neither weighs nor touches."""
    if np.linalg.norm(to[:3, 3]) < 1e-3:
        return []
    ends = _numbers([0.0, 0.0, 0.0, *to[:3, 3]])
    return [f'<geom type="capsule" size="0.02" fromto={ends} mass="0" contype="0" conaffinity="0"/>']


def _place(pose: NDArray[np.float64]) -> str:
    return f"pos={_numbers(pose[:3, 3])} quat={_numbers(quaternion(pose[:3, :3]))}"


def _numbers(values: Any) -> str:
    return '"' + " ".join(repr(float(x)) for x in values) + '"'
