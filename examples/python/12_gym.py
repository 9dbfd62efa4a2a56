"""12: the study's world as an environment of Gymnasium; the agent corrects the torque of phihat's own law. Needs `gymnasium`."""

from pathlib import Path

import numpy as np

from phihat.gym import VectorEnv

STUDY = Path(__file__).parents[2] / "studies" / "first.toml"

# %% Eight worlds with payloads of their own; an action holds for ten samples.
envs = VectorEnv(STUDY, 8, action="correction", repeat=10, randomise={"payload_kg": (0.1, 0.9)})


def episode(gain: float) -> float:
    """Mean reward of agents that push against the velocity error."""
    seen, _ = envs.reset(seed=1)
    total = 0.0
    for _ in range(60):
        q, dq, tau, q_des, dq_des, ddq_des = np.split(seen, 6, axis=1)
        seen, reward, *_ = envs.step(-gain * (dq - dq_des))
        total += float(reward.mean())
    return total / 60


# %% The law alone, and with an agent that damps.
print("law alone:", round(episode(0.0), 3), " with damping:", round(episode(0.5), 3))
assert episode(0.0) == episode(0.0)
