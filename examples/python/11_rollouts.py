"""11: many runs at once, and what the worst of them have in common."""

from pathlib import Path

import numpy as np
import phihat

STUDY = Path(__file__).parents[2] / "studies" / "first.toml"

# %% Sixty-four arms, each with a payload, a friction and a seed of its own.
rng = np.random.default_rng(1)
told = {
    "payload_kg": rng.uniform(0.05, 0.9, 64),
    "friction_nm": rng.uniform(0.0, 0.3, (64, 3)),  # one per run and joint
    "loop.delay_samples": 1,  # the same in all of them
}
rolled = phihat.rollouts(STUDY, told, seeds=range(64))
print(rolled, f"{rolled.in_lanes} in lanes")

# %% Figures are arrays: runs down, joints across.
worst = rolled["error_steady_max_rad"].max(axis=1)
for k in np.argsort(worst)[-3:][::-1]:
    print(f"run {k}: {1e3 * worst[k]:.3f} mrad with {told['payload_kg'][k]:.2f} kg")

# %% Each one is a study: the same run alone has the same bits.
k = int(worst.argmax())
alone = phihat.simulate(rolled.study(k), gains=rolled.gains, uncertified=True)
assert max(joint["error_steady_max_rad"] for joint in alone.metrics["joints"]) == worst[k]
