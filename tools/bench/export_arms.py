"""Print the arms in the text form that pinocchio.cpp reads. Arguments: robots folder, oracle folder, names.

Per arm a line `arm NAME JOINTS`, per joint a line `body TYPE PARENT` followed by position (3), rotation (9,
row by row), mass, centre of mass (3) and inertia about it (6: xx xy yy xz yz zz), after fixed joints
are merged. Then `check`: q, qd, qdd and torque of one sample of the oracle, the same numbers that
phihat-model is tested against. The C++ side builds its models from this, because the wheel's URDF
library is not compatible with the alignment that -march=native gives Eigen.
"""

import json
import sys
from pathlib import Path

import pinocchio as pin

SAMPLE = 3  # the first one that moves

robots, oracle, names = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]


def text(values):
    """Numbers so that they read back bit for bit."""
    return " ".join(repr(float(v)) for v in values)


for name in names:
    model = pin.buildModelFromUrdf(str(robots / f"{name}.urdf"))
    print("arm", name, model.nv)
    for i in range(1, model.njoints):
        placement, body = model.jointPlacements[i], model.inertias[i]
        inertia = body.inertia
        numbers = [*placement.translation, *placement.rotation.flatten(), body.mass, *body.lever]
        numbers += [inertia[k] for k in [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)]]
        print("body", model.joints[i].shortname(), model.parents[i], text(numbers))
    sample = json.loads((oracle / f"{name}.json").read_text())["samples"][SAMPLE]
    print("check", " ".join(text(sample[key]) for key in ("q", "qd", "qdd", "rnea")))
