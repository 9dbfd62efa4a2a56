"""phihat and MuJoCo: a robot out of any MuJoCo model, the controller on it, and our robots as MuJoCo models.

Needs the package ``mujoco`` (``pip install 'phihat[mujoco]'``); tested with MuJoCo 3.3 and 4.0.

- :func:`describe` writes the URDF that a design needs from a MuJoCo model's own numbers.
- :func:`attach` runs the controller on a MuJoCo model.
- :class:`Arm` is a MuJoCo model as a robot, for :func:`phihat.drive`.
- :func:`build` makes a MuJoCo model of a :class:`phihat.Robot`: a second opinion on its dynamics.
"""

from ._arm import Arm
from ._attach import Attached, attach
from ._build import build
from ._describe import describe

__all__ = ["Arm", "Attached", "attach", "build", "describe"]
