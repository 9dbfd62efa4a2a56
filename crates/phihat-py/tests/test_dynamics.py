"""Our dynamics against Pinocchio and MuJoCo: on our arms, and on arms that others described."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import phihat
import pinocchio
import pytest
from arms import load, middle, written
from fetch_arms import ARMS
from phihat.mujoco import build

ROBOTS = Path(__file__).parents[2] / "phihat-model" / "robots"
STATES = 40


def relative(ours: Any, theirs: Any) -> float:
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def states(robot: phihat.Robot) -> Any:
    """Postures inside the joint limits, velocities, and a third column for accelerations or torques."""
    rng = np.random.default_rng(3)
    n = len(robot.joint_names)
    low = np.maximum(robot.joint_values("position_min"), -3.0)
    high = np.minimum(robot.joint_values("position_max"), 3.0)
    q = low + (0.02 + 0.96 * rng.random((STATES, n))) * (high - low)
    return q, rng.normal(size=(STATES, n)), 10.0 * rng.normal(size=(STATES, n))


def check_against_pinocchio(robot: phihat.Robot, urdf: Path) -> None:
    theirs = pinocchio.buildModelFromUrdf(str(urdf))
    data = theirs.createData()
    assert list(theirs.names)[1:] == robot.joint_names
    frame = theirs.getFrameId(robot.tip)
    q, dq, third = states(robot)
    armature = np.array(robot.joint_values("armature"))
    damping = np.array(robot.joint_values("viscous"))
    rows = {
        "bias": robot.bias(q, dq),
        "gravity": robot.gravity(q),
        "mass": robot.mass_matrix(q),
        "inverse": robot.inverse_dynamics(q, dq, third, armature=True, damping=True),
        "forward": robot.forward_dynamics(q, dq, third, armature=True, damping=True),
        "pose": robot.frame_pose(q),
        "jacobian": robot.jacobian(q),
        "regressor": robot.regressor(q, dq, third) @ robot.dynamic_parameters.ravel(),
    }
    worst = dict.fromkeys(rows, 0.0)
    joints_are_angles = [joint.nq == 1 for joint in theirs.joints][1:]
    for k in range(STATES):
        # Pinocchio writes an endless joint as cosine and sine.
        pieces = [[x] if plain else [np.cos(x), np.sin(x)] for x, plain in zip(q[k], joints_are_angles)]
        posture = np.array([x for piece in pieces for x in piece])
        # Damping here is ours to add; without it Pinocchio computes the rigid bodies alone.
        theirs.damping = np.zeros(theirs.nv)
        theirs.armature = np.zeros(theirs.nv)
        expected = {
            "bias": np.array(pinocchio.nonLinearEffects(theirs, data, posture, dq[k])),
            "gravity": np.array(pinocchio.computeGeneralizedGravity(theirs, data, posture)),
            "regressor": np.array(pinocchio.rnea(theirs, data, posture, dq[k], third[k])),
        }
        upper = np.triu(np.array(pinocchio.crba(theirs, data, posture)))
        expected["mass"] = upper + np.triu(upper, 1).T
        theirs.armature = armature
        expected["inverse"] = np.array(pinocchio.rnea(theirs, data, posture, dq[k], third[k])) + damping * dq[k]
        expected["forward"] = np.array(pinocchio.aba(theirs, data, posture, dq[k], third[k] - damping * dq[k]))
        pinocchio.framesForwardKinematics(theirs, data, posture)
        expected["pose"] = data.oMf[frame].homogeneous
        axes = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        expected["jacobian"] = pinocchio.computeFrameJacobian(theirs, data, posture, frame, axes)
        for name, ours in rows.items():
            worst[name] = max(worst[name], relative(ours[k], expected[name]))
    assert max(worst.values()) < 1e-10, worst


def check_against_mujoco(robot: phihat.Robot, model: Any) -> None:
    model.dof_frictionloss[:] = 0.0
    model.opt.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(model)
    q, dq, third = states(robot)
    bias = robot.bias(q, dq)
    mass = robot.mass_matrix(q, armature=True)
    forward = robot.forward_dynamics(q, dq, third, armature=True, damping=True)
    inverse = robot.inverse_dynamics(q, dq, forward, armature=True, damping=True)
    worst = dict.fromkeys(("bias", "mass", "forward", "inverse"), 0.0)
    for k in range(STATES):
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q[k], dq[k], third[k]
        mujoco.mj_forward(model, data)
        columns = np.zeros((model.nv, model.nv))
        for i, unit in enumerate(np.eye(model.nv)):
            mujoco.mj_mulM(model, data, columns[i], unit)
        errors = {
            "bias": relative(bias[k], data.qfrc_bias),
            "mass": relative(mass[k], columns),
            "forward": relative(forward[k], data.qacc),
            "inverse": relative(inverse[k], third[k]),
        }
        worst = {name: max(worst[name], errors[name]) for name in worst}
    assert max(worst.values()) < 1e-9, worst


@pytest.mark.parametrize("name", phihat.robots())
def test_our_arms(name: str) -> None:
    robot = phihat.Robot.from_name(name)
    check_against_pinocchio(robot, ROBOTS / f"{name}.urdf")
    check_against_mujoco(robot, build(robot))


@pytest.mark.parametrize("arm", ARMS)
def test_arms_of_others(arm: str, tmp_path: Path) -> None:
    """Each is read by MuJoCo and by us from its authors' file, by Pinocchio from the URDF that we make of it."""
    model = load(arm)
    (tmp_path / f"{arm}.xml").write_text(written(arm))
    robot = phihat.Robot.from_file(tmp_path / f"{arm}.xml")
    (tmp_path / f"{arm}.urdf").write_text(robot.as_urdf())
    assert robot.joint_names == [model.joint(i).name for i in range(model.njnt)]
    assert robot.joint_values("torque_max") == list(model.actuator_ctrlrange[:, 1])
    check_against_pinocchio(robot, tmp_path / f"{arm}.urdf")
    check_against_mujoco(robot, model)


def test_locked_loaded_tilted() -> None:
    robot = phihat.Robot.from_name("ur5", gravity=(3.0, -2.0, -9.0))
    robot = robot.with_locked({"elbow_joint": 0.7})
    robot = robot.with_payload("tool0", 2.0, [0.01, 0.02, 0.1], [0.01, 0.001, 0.0, 0.02, 0.0, 0.015])
    check_against_mujoco(robot, build(robot))


def test_middle_is_inside() -> None:
    model = load("panda")
    assert ((middle(model) > model.jnt_range[:, 0]) & (middle(model) < model.jnt_range[:, 1])).all()


def test_a_part_of_a_robot_is_the_reduced_model(tmp_path: Path) -> None:
    urdf = tmp_path / "alone.urdf"
    urdf.write_text((ROBOTS / "panda.urdf").read_text())
    locked = {"panda_joint1": 0.4, "panda_joint2": -0.3, "panda_joint7": 0.9}
    robot = phihat.Robot.from_file(urdf, base="panda_link2", tip="panda_link6", locked=locked)
    whole = pinocchio.buildModelFromUrdf(str(urdf))
    posture = np.array([locked.get(name, 0.0) for name in list(whole.names)[1:]])
    theirs = pinocchio.buildReducedModel(whole, [whole.getJointId(name) for name in locked], posture)
    assert list(theirs.names)[1:] == robot.joint_names == [f"panda_joint{i}" for i in range(3, 7)]
    data = theirs.createData()
    theirs.damping = np.zeros(theirs.nv)
    q, dq, ddq = states(robot)
    expected = np.array([pinocchio.rnea(theirs, data, *state) for state in zip(q, dq, ddq)])
    assert relative(robot.inverse_dynamics(q, dq, ddq), expected) < 1e-13
    with pytest.raises(phihat.RobotError, match="did you mean"):
        phihat.Robot.from_file(urdf, tip="panda_lnk6")
