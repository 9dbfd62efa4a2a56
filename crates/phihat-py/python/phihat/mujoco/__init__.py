"""phihat and MuJoCo: the controller on any MuJoCo model, and our robots as MuJoCo models.

Needs the package ``mujoco`` (``pip install 'phihat[mujoco]'``); tested with MuJoCo 3.3 and 4.0.

- :func:`attach` runs the controller on a MuJoCo model.
- :class:`Arm` is a MuJoCo model as a robot, for :func:`phihat.drive`.
- :func:`build` makes a MuJoCo model of a :class:`phihat.Robot`: a second opinion on its dynamics.

An MJCF file is a robot without any of it: :meth:`phihat.Robot.from_file`, or ``file`` in a study's ``[robot]``. A model that
was made or changed in memory is one by ``mujoco.mj_saveLastXML``.
"""

from ._arm import Arm
from ._attach import Attached, attach
from ._build import build

__all__ = ["Arm", "Attached", "attach", "build"]
