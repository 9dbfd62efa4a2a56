"""MJCF as phihat reads it, against MuJoCo's own compiler: mass matrix and bias, names, limits."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import phihat
import pytest
from random_mjcf import Draft

WRITTEN = Path(__file__).parents[2] / "phihat-model" / "tests" / "mjcf"
DRAWN = 2000 if "PHIHAT_ALL" in os.environ else 300
STATES = 5


def joint_of(model: Any, name: str) -> int:
    """MuJoCo's number of a joint, which may have no name."""
    own = [model.joint(i).name or f"joint{i}" for i in range(model.njnt)]
    return own.index(name)


def apart(robot: phihat.Robot, model: Any, held: dict[str, float], seed: int) -> float:
    """Largest difference of mass matrix and bias over the largest entry, at random states."""
    rng = np.random.default_rng(seed)
    model.dof_frictionloss[:] = 0.0
    model.opt.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.gravity[:] = robot.gravity_m_s2
    data = mujoco.MjData(model)
    joints = [joint_of(model, name) for name in robot.joint_names]
    at, dofs = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
    low = np.maximum(robot.joint_values("position_min"), -3.0)
    high = np.minimum(robot.joint_values("position_max"), 3.0)
    worst = 0.0
    for _ in range(STATES):
        q, dq = low + rng.random(len(low)) * (high - low), rng.normal(size=len(low))
        data.qpos[:], data.qvel[:] = model.qpos0, 0.0
        for name, position in held.items():
            data.qpos[model.jnt_qposadr[joint_of(model, name)]] = position
        data.qpos[at], data.qvel[dofs] = q, dq
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        for row, unit in zip(mass, np.eye(model.nv)):
            mujoco.mj_mulM(model, data, row, unit)
        ours = robot.mass_matrix(q, armature=True)
        theirs = mass[np.ix_(dofs, dofs)]
        worst = max(worst, float(np.abs(ours - theirs).max() / np.abs(theirs).max()))
        bias = data.qfrc_bias[dofs]
        worst = max(worst, float(np.abs(robot.bias(q, dq) - bias).max() / max(1e-3, np.abs(bias).max())))
    return worst


@pytest.mark.parametrize("name", sorted(path.stem for path in WRITTEN.glob("*.xml")))
def test_written_in_the_manner_of_public_ones(name: str) -> None:
    path = WRITTEN / f"{name}.xml"
    model = mujoco.MjModel.from_xml_path(str(path))
    robot = phihat.Robot.from_file(path)
    held = {"finger_joint1": 0.0} if name == "seven_with_hand" else {}
    assert apart(robot, model, held, 1) < 1e-12
    joints = [joint_of(model, joint) for joint in robot.joint_names]
    low, high = robot.joint_values("position_min"), robot.joint_values("position_max")
    for joint, *limits in zip(joints, low, high):
        if model.jnt_limited[joint]:
            np.testing.assert_allclose(limits, model.jnt_range[joint], rtol=1e-15)
    dofs = model.jnt_dofadr[joints]
    np.testing.assert_allclose(robot.joint_values("viscous"), model.dof_damping[dofs], rtol=1e-15)


def test_random_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as a few seconds allow, of every feature that is read; some include another file."""
    monkeypatch.chdir(tmp_path)  # MuJoCo logs a warning into a file where it runs.
    worst, compared = 0.0, 0
    for seed in range(DRAWN):
        path = Draft(seed).write(tmp_path)
        model = mujoco.MjModel.from_xml_path(str(path))
        robot = phihat.Robot.from_file(path)
        found = apart(robot, model, {}, seed)
        assert found < 1e-9, (seed, found, path.read_text())
        worst, compared = max(worst, found), compared + 1
    print(f"{compared} files, largest difference {worst:.1e}")
    assert compared >= 200


STRANGE = """
<mujoco><compiler angle="radian"/><worldbody>
  <body name="fixed" pos="0.1 0.2 0.3" quat="0.5 0.5 -0.5 0.5">
    <inertial mass="3" pos="0 0 0" diaginertia="1 1 1"/>
    <body name="a" pos="0 0 0.5" quat="0.9 0.1 0.2 0.3">
      <inertial mass="2" pos="0.1 -0.2 0.05" quat="0.3 0.8 0.1 0.5" diaginertia="0.04 0.03 0.02"/>
      <joint name="a1" axis="1 2 -1" pos="0.05 0 0.1" ref="0.4" armature="0.2" damping="0.3"/>
      <joint name="a2" type="slide" axis="0 1 0.5" range="-1 1" limited="true" ref="-0.2" armature="0.3"/>
      <body name="b" pos="0.3 0.1 0" euler="0 1.5707963267948966 0.2">
        <inertial mass="1" pos="0 0.1 0.1" diaginertia="0.01 0.02 0.015"/>
        <joint name="b1" axis="0 0 1" pos="0 0.02 0" armature="0.1"/>
      </body>
      <body name="c" pos="-0.2 0 0.1">
        <inertial mass="0.7" pos="0.1 0 0" diaginertia="0.01 0.01 0.01"/>
        <joint name="c1" axis="0 1 0" ref="1.1" armature="0.1" damping="0.2"/>
      </body>
    </body>
  </body>
</worldbody></mujoco>
"""


def test_strange_joints() -> None:
    """Skew axes, anchors, reference angles, two joints in one body, a tree, and a right-angled pitch."""
    model = mujoco.MjModel.from_xml_string(STRANGE)
    robot = phihat.Robot.from_text(STRANGE)
    assert robot.joint_names == ["a1", "a2", "b1", "c1"]
    assert apart(robot, model, {}, 1) < 1e-12
    assert apart(phihat.Robot.from_text(robot.as_urdf()), mujoco.MjModel.from_xml_string(STRANGE), {}, 1) > 1e-3
    model.dof_armature[:] = 0.0
    assert apart(phihat.Robot.from_text(robot.as_urdf()), model, {}, 1) < 1e-12
    data = mujoco.MjData(model)
    data.qpos[:] = [0.3, -0.4, 0.8, -0.5]
    mujoco.mj_forward(model, data)
    for body in ("a", "b", "c"):
        pose = robot.frame_pose(np.array(data.qpos), body)
        np.testing.assert_allclose(pose[:3, 3], data.body(body).xpos, atol=1e-12)
        np.testing.assert_allclose(pose[:3, :3].ravel(), data.body(body).xmat, atol=1e-12)


def test_a_part_stays_where_it_is_drawn(tmp_path: Path) -> None:
    (tmp_path / "strange.xml").write_text(STRANGE)
    part = phihat.Robot.from_file(tmp_path / "strange.xml", joints=["a1", "b1"])
    model = mujoco.MjModel.from_xml_string(STRANGE)
    data = mujoco.MjData(model)
    data.qpos[:] = [0.3, -0.2, 0.8, 1.1]
    mujoco.mj_forward(model, data)
    pose = part.frame_pose(np.array([0.3, 0.8]), "b")
    np.testing.assert_allclose(pose[:3, 3], data.body("b").xpos, atol=1e-12)


def test_joints_and_bodies_without_names() -> None:
    """They are called by their number, and by another name where one has that already; nothing else changes."""
    text = STRANGE
    for name in ("a1", "b1", "a", "b"):
        text = text.replace(f'name="{name}"', "")
    text = text.replace('name="c1"', 'name="joint0"').replace('name="a2"', 'name="joint1"')
    robot = phihat.Robot.from_text(text)
    assert robot.joint_names == ["joint0_", "joint1", "joint2", "joint0"]
    assert {"body2", "body3"} <= set(robot.frame_names)


SCENE = """
<mujoco><worldbody>
  <body name="stand" pos="0 0 0.3"><freejoint/><inertial mass="9" pos="0 0 0" diaginertia="1 1 1"/>
    <body name="arm"><inertial mass="1" pos="0.1 0 0" diaginertia="0.01 0.01 0.01"/><joint name="lift" axis="0 1 0"/></body>
  </body>
  <body name="cupboard"><inertial mass="9" pos="0 0 0" diaginertia="1 1 1"/>
    <body><inertial mass="1" pos="0 0.2 0" diaginertia="0.1 0.1 0.1"/><joint axis="0 0 1"/></body>
  </body>
</worldbody></mujoco>
"""


def test_a_scene_with_several_trees(tmp_path: Path) -> None:
    (tmp_path / "scene.xml").write_text(SCENE)
    robot = phihat.Robot.from_file(tmp_path / "scene.xml", tip="arm")
    assert robot.joint_names == ["lift"]
    # 1 kg on 0.1 m, level: a pendulum's weight. The stand floats in the scene; here it is fixed, and that is said.
    np.testing.assert_allclose(robot.gravity(np.zeros(1)), [-0.981], rtol=1e-12)
    assert any("free, held fixed" in warning for warning in robot.warnings)
    with pytest.raises(phihat.RobotError, match='there is no link "hand"'):
        phihat.Robot.from_file(tmp_path / "scene.xml", tip="hand")
