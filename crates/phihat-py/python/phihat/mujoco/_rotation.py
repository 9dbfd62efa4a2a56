"""Rotation matrices as MuJoCo's quaternions."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


def quaternion(rotation: Matrix) -> Matrix:
    """Unit quaternion ``w, x, y, z`` of a rotation matrix."""
    found = np.zeros(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(rotation).reshape(9))
    return found
