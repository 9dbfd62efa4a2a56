"""01: one joint under control.

A pendulum of 2 kg on 0.4 m with dry friction. The controller knows neither mass, length, gravity nor friction: one
nominal inertia, a bandwidth, and the torque that acted. The same in C: examples/c/01_controller.c.
"""

import numpy as np
import phihat

T = 1e-3
MASS, LENGTH = 2.0, 0.4
INERTIA = MASS * LENGTH**2

# %% Gains: bandwidth 20 rad/s, second-order estimator with both poles at 70 rad/s.
controller = phihat.Controller(
    rate_hz=1.0 / T,
    inertia=[0.25],  # a guess: the true one is 0.32
    kp=[20.0**2],
    kd=[2 * 20.0],
    a=[[70.0**2, 2 * 70.0]],
    torque_max=[40.0],
)

# %% The loop: every millisecond.
q, dq, tau = np.zeros(1), np.zeros(1), np.zeros(1)
w = 2 * np.pi * 0.3
worst = 0.0
for k in range(10_000):
    t = k * T
    q_des = np.array([0.5 * np.sin(w * t) ** 2])
    dq_des = np.array([0.5 * w * np.sin(2 * w * t)])
    ddq_des = np.array([w**2 * np.cos(2 * w * t)])
    tau = controller.update(q, dq, q_des, dq_des, ddq_des, tau, t_ns=k * 1_000_000)
    if t > 1.0:
        worst = max(worst, abs(q[0] - q_des[0]))

    # The pendulum, which the controller does not know.
    friction = 0.5 * dq / np.sqrt(dq**2 + 1e-4)
    ddq = (tau - friction - MASS * 9.81 * LENGTH * np.sin(q)) / INERTIA
    dq = dq + T * ddq
    q = q + T * dq

print(f"largest error after 1 s: {1e3 * worst:.2f} mrad")
assert worst < 5e-3
