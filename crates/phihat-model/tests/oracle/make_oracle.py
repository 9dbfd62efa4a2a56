#!/usr/bin/env python3
# /// script
# requires-python = ">=3.11"
# dependencies = ["pin==4.1.0", "numpy==2.4.6"]
# ///
"""Write NAME.json, the reference numbers that the dynamics of one arm are tested against.

The numbers are Pinocchio's, computed from robots/NAME.urdf. README.md beside this file says what
each of them means. To make an arm's file again:

    python3 -m venv venv
    venv/bin/pip install pin==4.1.0 numpy==2.4.6
    venv/bin/python make_oracle.py iiwa14

To see how far this script and an existing file are apart at that file's own inputs:

    venv/bin/python make_oracle.py panda --against panda.json

Seed and versions are fixed, so the same machine writes the same bytes; another processor may differ
in the last digits.
"""

import argparse
import json
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
ROBOTS = HERE.parents[3] / "robots"
SEED = 20261122
SAMPLES = 200
WITH_REGRESSOR = 20
INSIDE_LIMITS = 150  # samples before this one; the rest take q from (-pi, pi)


def load(name):
    """The arm's Pinocchio model and the name of its tip frame. The URDF's damping plays no part."""
    tip = tomllib.loads((ROBOTS / f"{name}.toml").read_text())["tip"]
    model = pin.buildModelFromUrdf(str(ROBOTS / f"{name}.urdf"))
    if model.nq != model.nv:
        raise SystemExit(f"{name}: a continuous joint has no single coordinate here")
    return model, tip


def draw(model, rng, index):
    """Inputs q, qd, qdd, tau of one sample."""
    n = model.nv
    velocity = np.minimum(model.velocityLimit, 3.0)
    torque = np.minimum(0.5 * model.effortLimit, 50.0)
    if index < INSIDE_LIMITS:
        low, high = model.lowerPositionLimit, model.upperPositionLimit
    else:
        low, high = np.full(n, -np.pi), np.full(n, np.pi)
    q = rng.uniform(low, high)
    qd = rng.uniform(-velocity, velocity)
    qdd = rng.uniform(-10.0, 10.0, n)
    tau = rng.uniform(-torque, torque)
    if index == 0:
        q, tau = np.zeros(n), np.zeros(n)
    if index <= 2:
        qd = np.zeros(n)
    if index <= 1:
        qdd = np.zeros(n)
    return q, qd, qdd, tau


def answers(model, tip, inputs, with_regressor):
    """Everything the tests compare, at one sample's inputs."""
    q, qd, qdd, tau = inputs
    data = model.createData()
    sample = {"q": q, "qd": qd, "qdd": qdd, "tau": tau}
    sample["rnea"] = pin.rnea(model, data, q, qd, qdd).copy()
    sample["aba"] = pin.aba(model, data, q, qd, tau).copy()
    sample["nle"] = pin.nonLinearEffects(model, data, q, qd).copy()
    sample["gravity"] = pin.computeGeneralizedGravity(model, data, q).copy()
    upper = np.triu(pin.crba(model, data, q))
    sample["crba"] = upper + np.triu(upper, 1).T
    pin.framesForwardKinematics(model, data, q)
    last, tip_pose = data.oMi[model.njoints - 1], data.oMf[model.getFrameId(tip)]
    sample["last_joint_pos"] = last.translation.copy()
    sample["last_joint_rot"] = last.rotation.copy()
    sample["tip_pos"] = tip_pose.translation.copy()
    sample["tip_rot"] = tip_pose.rotation.copy()
    sample["tip_jacobian"] = pin.computeFrameJacobian(
        model, data, q, model.getFrameId(tip), pin.LOCAL_WORLD_ALIGNED
    ).copy()
    sample["kinetic"] = float(pin.computeKineticEnergy(model, data, q, qd))
    sample["potential"] = float(pin.computePotentialEnergy(model, data, q))
    if with_regressor:
        sample["regressor"] = pin.computeJointTorqueRegressor(model, data, q, qd, qdd).copy()
    return sample


def lumped_bodies(model):
    """Per joint, what is left after fixed joints are merged into their parents."""
    bodies = []
    for i in range(1, model.njoints):
        placement, inertia = model.jointPlacements[i], model.inertias[i]
        bodies.append(
            {
                "joint": model.names[i],
                "type": model.joints[i].shortname(),
                "parent": int(model.parents[i]),
                "placement_pos": placement.translation,
                "placement_rot": placement.rotation,
                "mass": float(inertia.mass),
                "com": inertia.lever,
                "inertia_com": inertia.inertia,
                "dynamic_parameters": inertia.toDynamicParameters(),
            }
        )
    return bodies


def oracle(name):
    """The whole document for one arm."""
    model, tip = load(name)
    rng = np.random.Generator(np.random.PCG64(SEED))
    return {
        "robot": name,
        "urdf": f"{name}.urdf",
        "generator": {"pinocchio": pin.__version__, "numpy": np.__version__, "seed": SEED},
        "nv": model.nv,
        "joints": list(model.names)[1:],
        "tip_frame": tip,
        "gravity": model.gravity.linear,
        "lumped_bodies": lumped_bodies(model),
        "samples": [
            answers(model, tip, draw(model, rng, k), k < WITH_REGRESSOR) for k in range(SAMPLES)
        ],
    }


def print_difference(name, path):
    """Per number, the largest difference to a file, over the largest magnitude in the sample."""
    model, tip = load(name)
    theirs = json.loads(path.read_text())
    worst = {}
    for sample in theirs["samples"]:
        inputs = [np.array(sample[key]) for key in ("q", "qd", "qdd", "tau")]
        ours = answers(model, tip, inputs, "regressor" in sample)
        for key, value in sample.items():
            value, mine = np.array(value), np.array(ours[key])
            scale = max(np.abs(value).max(), 1e-3)
            worst[key] = max(worst.get(key, 0.0), np.abs(value - mine).max() / scale)
    for body, mine in zip(theirs["lumped_bodies"], lumped_bodies(model), strict=True):
        for key in ("placement_pos", "placement_rot", "inertia_com", "dynamic_parameters"):
            gap = np.abs(np.array(body[key]) - np.array(mine[key])).max()
            worst[key] = max(worst.get(key, 0.0), gap)
    for key, value in worst.items():
        print(f"{key:20} {value:.1e}")


def main():
    """Write the file, or compare with one."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", help="an arm in robots/, such as iiwa14")
    parser.add_argument("--against", type=Path, help="compare with this file, write nothing")
    options = parser.parse_args()
    if options.against:
        print_difference(options.name, options.against)
        return
    document = oracle(options.name)
    text = json.dumps(document, default=lambda a: a.tolist(), separators=(",", ":"))
    (HERE / f"{options.name}.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
