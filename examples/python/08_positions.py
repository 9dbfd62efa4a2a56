"""08: the law from positions: an encoder, no velocity, one sample of delay.

The pendulum of 01_controller.py. Every torque acts one millisecond late, and the joint tells its angle alone, in steps of
0.024 mrad. The law predicts across the delay, and asks to know what the motion needs in the interval in which its torque
acts. The same in C: examples/c/03_positions.c.
"""

import numpy as np
import phihat

T = 1e-3
MASS, LENGTH = 2.0, 0.4
INERTIA = MASS * LENGTH**2
STEP = 2 * np.pi / 2**18
DELAY = 1

# %% Gains: bandwidth 20 rad/s; all three poles of the observer at r, per sample.
r = 0.85
gains = phihat.PositionGains(
    joint_names=["pivot"],
    rate_hz=1.0 / T,
    inertia=[0.25],  # a guess: the true one is 0.32
    kp=[20.0**2],
    kd=[2 * 20.0],
    correction=[[1 - r**3, 1.5 * (1 - r**2) * (1 - r) / T, -((1 - r) ** 3) / T**2]],
    share=[0.5],
    delay_samples=[DELAY],
)
controller = phihat.Controller(gains, torque_max=[40.0])

# %% A motion that starts at rest, and its velocity.
w = 2 * np.pi * 0.3


def q_wanted(t: float) -> float:
    return 0.5 * np.sin(w * t) ** 2


def dq_wanted(t: float) -> float:
    return 0.5 * w * np.sin(2 * w * t)


# %% The loop: every millisecond.
q, dq, acting, coming = np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1)
worst = 0.0
for k in range(10_000):
    t = k * T
    # The mean acceleration of the interval in which this torque acts.
    ddq_des = (dq_wanted(t + (DELAY + 1) * T) - dq_wanted(t + DELAY * T)) / T
    q_des, dq_des = np.array([q_wanted(t)]), np.array([dq_wanted(t)])
    tau = controller.update(STEP * np.round(q / STEP), np.zeros(1), q_des, dq_des, np.array([ddq_des]), acting)
    if t > 1.0:
        worst = max(worst, abs(q[0] - q_des[0]))

    # The pendulum, which the controller does not know, under the torque of the sample before.
    acting, coming = coming, tau
    friction = 0.5 * dq / np.sqrt(dq**2 + 1e-4)
    ddq = (acting - friction - MASS * 9.81 * LENGTH * np.sin(q)) / INERTIA
    q = q + T * (dq + 0.5 * T * ddq)
    dq = dq + T * ddq

print(f"largest error after 1 s: {1e3 * worst:.2f} mrad")
assert worst < 3e-3
