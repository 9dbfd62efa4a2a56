"""10: a robot of your own under the checks, the supervisor, the loop and the record of `phihat drive`.

Needs: pip install mujoco

Here the robot is an arm in MuJoCo. Anything with `joint_names`, `period`, `read()` and `write(tau)` is one.
"""

import tempfile
from pathlib import Path

import mujoco
import numpy as np
import phihat
import phihat.mujoco

STUDY = """
title = "Three joints on a robot of one's own"
duration_s = 5.0
[robot]
name = "planar3r"
[spec]
settle_s = 1.5
error_bound_rad = 5e-3
[design]
payload_max_kg = 0.5
[loop]
form = "observer"
delay_samples = 1
[world]
friction = "none"
[supervisor]
error_stop_rad = 0.2
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.4
"""

# %% The arm with 0.3 kg at its tip, of which nobody told the controller, in an engine that knows nothing of phihat.
robot = phihat.Robot.from_name("planar3r")
loaded = robot.with_payload(robot.tip, 0.3, [0.0, 0.0, 0.0], [1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4])
model = phihat.mujoco.build(loaded, timestep=5e-4, damping=False, friction=False)

with tempfile.TemporaryDirectory() as folder:
    study, out = Path(folder) / "own_robot.toml", Path(folder) / "out"
    study.write_text(STUDY)

    # %% An arm that stands elsewhere is refused before anything moves.
    arm = phihat.mujoco.Arm(model, mujoco.MjData(model), rate_hz=1000.0, delay_samples=1)
    try:
        phihat.drive(study, arm, out=out)
    except phihat.Error as why:
        print(why)
    else:
        raise AssertionError("it stands elsewhere")

    # %% Where the motion begins, it is driven.
    data = mujoco.MjData(model)
    data.qpos[:] = phihat.simulate(study)["q_desired"][0]
    driven = phihat.drive(study, phihat.mujoco.Arm(model, data, rate_hz=1000.0, delay_samples=1), out=out)
    print(driven)
    for check in driven.drive["checks"]:
        print(check["state"], check["name"])
    worst = np.abs(driven.trace["e"][driven.trace.t > 1.5]).max(axis=0)
    print("largest error in MuJoCo", np.round(1e3 * worst, 2), "of 5 mrad")
    assert driven.good and (worst <= 5e-3).all()
