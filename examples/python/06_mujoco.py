"""06: the controller on a MuJoCo model that knows nothing of phihat.

Needs: pip install mujoco
"""

import tempfile
from pathlib import Path

import mujoco
import numpy as np
import phihat
import phihat.mujoco

# %% Somebody's arm, in MuJoCo's own language: two links, torque motors, rotor inertia, friction.
ARM = """
<mujoco>
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body name="upper">
      <inertial mass="3" pos="0 0 0.2" diaginertia="0.05 0.05 0.004"/>
      <joint name="shoulder" axis="0 1 0" range="-170 170" armature="0.15" damping="0.5" frictionloss="0.3"/>
      <body name="lower" pos="0 0 0.4">
        <inertial mass="1.5" pos="0 0 0.15" diaginertia="0.015 0.015 0.001"/>
        <joint name="elbow" axis="0 1 0" range="-150 150" armature="0.1" damping="0.3" frictionloss="0.2"/>
        <body name="hand" pos="0 0 0.3">
          <inertial mass="LOAD" pos="0 0 0" diaginertia="1e-4 1e-4 1e-4"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="shoulder" ctrlrange="-80 80"/>
    <motor joint="elbow" ctrlrange="-40 40"/>
  </actuator>
</mujoco>
"""

# %% What the design needs to know: the description, the largest payload, the error to live with.
with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "arm.xml"
    file.write_text(ARM.replace("LOAD", "0.01"))
    robot = phihat.Robot.from_file(file, tip="hand")
    gains = phihat.design(
        {
            "duration_s": 6.0,
            "robot": {"file": str(file), "tip": "hand"},
            "spec": {"settle_s": 2.0, "error_bound_rad": 4e-3},
            "design": {"payload_max_kg": 1.0},
            "world": {"substeps": 20},
            "reference": {
                "kind": "sines",
                "center_rad": [0.3, 0.8],
                "fade_in_s": 0.0,
                "sine": [{"amplitude_rad": [0.5, 0.4], "frequency_hz": [0.2, 0.3]}],
            },
        }
    )
gains.verify()
bound = np.array(gains.error_bound)
print(robot, "certified |e| ≤", np.round(1e3 * bound, 2), "mrad")

# %% The same arm with 0.7 kg in its hand, of which nobody told the controller.
model = mujoco.MjModel.from_xml_string(ARM.replace("LOAD", "0.7"))
data = mujoco.MjData(model)
center, amplitude = np.array([0.3, 0.8]), np.array([0.5, 0.4])
w = 2 * np.pi * np.array([0.2, 0.3])


def motion(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    s, c = np.sin(w * t), np.cos(w * t)
    return center + amplitude * s, amplitude * w * c, -amplitude * w**2 * s


data.qpos[:], data.qvel[:], _ = motion(0.0)
worst = np.zeros(2)
with phihat.mujoco.attach(model, data, gains, reference=motion):
    while data.time < 6.0:
        mujoco.mj_step(model, data)
        if data.time > 2.0:
            worst = np.maximum(worst, np.abs(data.qpos - motion(data.time)[0]))
print("largest error in MuJoCo:", np.round(1e3 * worst, 2), "mrad")
assert (worst <= bound).all()
