"""MuJoCo's own rollouts of an arm, one thread: `python mujoco_rollout.py ARM.urdf SECONDS` prints one JSON line per block.

The arm without contacts, geometry or friction, 1 kHz, RK4 (four forward dynamics per step), under MuJoCo's position servos along one
sinusoid per joint: a loop that MuJoCo closes by itself, so that nothing of it waits for Python.
"""

from __future__ import annotations

import json
import sys
import time
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
from mujoco import rollout

ARMS, STEPS, PERIOD = 64, 1000, 1e-3


def model_of(path: str) -> mujoco.MjModel:
    tree = ElementTree.parse(path).getroot()
    for link in tree.iter("link"):
        for part in [child for child in link if child.tag in ("visual", "collision")]:
            link.remove(part)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(tree, encoding="unicode"))
    spec.option.timestep = PERIOD
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    for joint in spec.joints:
        servo = spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.gainprm[0], servo.biastype = 400.0, mujoco.mjtBias.mjBIAS_AFFINE
        servo.biasprm[1], servo.biasprm[2] = -400.0, -40.0
    model = spec.compile()
    model.dof_armature[:], model.dof_damping[:], model.dof_frictionloss[:] = 0.1, 0.0, 0.0
    return model


def main() -> None:
    path, seconds = sys.argv[1], float(sys.argv[2])
    model = model_of(path)
    data = mujoco.MjData(model)
    t = PERIOD * np.arange(STEPS)[:, None]
    control = 0.2 * np.sin(2.0 * np.pi * (0.2 + 0.02 * np.arange(model.nu)) * t)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.empty(size)
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    starts, states = np.tile(start, (ARMS, 1)), np.empty((ARMS, STEPS, size))
    with rollout.Rollout(nthread=0) as pool:
        end = time.monotonic() + seconds
        blocks = []
        while not blocks or time.monotonic() < end:
            begun = time.process_time()
            pool.rollout(model, data, starts, control[None], state=states)
            blocks.append(ARMS * STEPS * PERIOD / (time.process_time() - begun))
    q = states[:, -1, 1 : 1 + model.nq]
    if not np.all(np.abs(q - control[-1]) < 0.5):
        sys.exit(f"{path}: MuJoCo's servos lost their reference: {q[0]} instead of {control[-1]}")
    figure = {"algorithm": "closed_loop_panda_rk4_many", "times_real_time": float(np.median(blocks))}
    print(json.dumps(figure))


if __name__ == "__main__":
    main()
