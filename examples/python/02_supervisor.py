"""02: a joint under supervision: armed, held, tracked; then the link to the robot is lost, and comes back.

The pendulum of 01_controller.py. The same in C: examples/c/02_supervisor.c.
"""

import json

import numpy as np
import phihat

T_NS = 1_000_000
MASS, LENGTH = 2.0, 0.4
INERTIA = MASS * LENGTH**2
START = 0.4

gains = phihat.Gains.from_json(
    json.dumps(
        {
            "format": "phihat-gains",
            "version": 3,
            "study": "pendulum",
            "study_sha256": "",
            "rate_hz": 1000.0,
            "method": "by hand",
            "joints": [
                {"name": "pivot", "inertia_kg_m2": 0.25, "kp_per_s2": 400.0, "kd_per_s": 40.0, "a": [4900.0, 140.0]}
            ],
        }
    )
)
arm = phihat.Supervisor(
    gains,
    torque_max=[40.0],
    torque_rate_max=[1000.0],
    velocity_max=[4.0],
    position_range=[(-1.5, 1.5)],
    error_stop=[0.1],
)


def wish(k: int) -> str:
    """What a person asks for: arm, hold, track; and after the stop, once the link is back, the same again."""
    for until, request in ((10, "arm"), (1000, "hold"), (6100, "track"), (7000, "stop"), (7010, "arm"), (8333, "hold")):
        if k < until:
            return request
    return "track"


q, dq, tau = np.array([START]), np.zeros(1), np.zeros(1)
w = 2 * np.pi * 0.3
seen, worst, modes = 0, 0.0, ["idle"]
for k in range(12_000):
    t = 1e-9 * k * T_NS
    q_des = np.array([START + 0.3 * np.sin(w * t) ** 2])
    dq_des = np.array([0.3 * w * np.sin(2 * w * t)])
    ddq_des = np.array([0.6 * w**2 * np.cos(2 * w * t)])
    if not 6000 <= k < 6500:  # the link is lost for half a second
        seen = k
    tau = arm.step(q, dq, q_des, dq_des, ddq_des, tau, request=wish(k), sequence=seen, now_ns=k * T_NS)
    if arm.mode != modes[-1]:
        print(f"{t:6.3f} s  {arm.mode}", *(arm.fault or ()))
        modes.append(arm.mode)
    if arm.mode == "tracking" and (k > 10_000 or 2500 < k < 6000):
        worst = max(worst, abs(q[0] - q_des[0]))

    # The pendulum, and its brake.
    friction = 0.5 * dq / np.sqrt(dq**2 + 1e-4)
    dq = dq + 1e-3 * (tau - friction - MASS * 9.81 * LENGTH * np.sin(q)) / INERTIA
    if arm.brake:
        dq = np.zeros(1)
    q = q + 1e-3 * dq

print(f"largest error while tracking: {1e3 * worst:.2f} mrad")
once = ["armed", "holding", "tracking"]
assert modes == ["idle", *once, "safe-stop", *once] and worst < 5e-3
