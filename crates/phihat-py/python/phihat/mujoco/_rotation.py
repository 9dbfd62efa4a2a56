"""Rotations between MuJoCo's quaternions, matrices, and URDF's roll, pitch, yaw."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


def matrix(quaternion: Any) -> Matrix:
    """Rotation matrix of a unit quaternion ``w, x, y, z``."""
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, np.asarray(quaternion, dtype=float))
    return flat.reshape(3, 3)


def quaternion(rotation: Matrix) -> Matrix:
    """Unit quaternion ``w, x, y, z`` of a rotation matrix."""
    found = np.zeros(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(rotation).reshape(9))
    return found


def rpy(rotation: Matrix) -> tuple[float, float, float]:
    """Roll, pitch, yaw with ``R = Rz(yaw) Ry(pitch) Rx(roll)``.

    One angle after the other, each from what the one before has left over: exact to rounding also where the pitch is a
    right angle and yaw alone means nothing.
    """
    yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    left = about(2, -yaw) @ rotation
    pitch = math.atan2(-left[2, 0], left[0, 0])
    left = about(1, -pitch) @ left
    return math.atan2(left[2, 1], left[1, 1]), pitch, yaw


def about(axis: int, angle: float) -> Matrix:
    """Rotation about a coordinate axis."""
    c, s = math.cos(angle), math.sin(angle)
    turned = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turned[i, i] = turned[j, j] = c
    turned[i, j], turned[j, i] = -s, s
    return turned
