"""09: your own law in phihat's world.

PD plus acceleration on the planar arm of the first study, with a payload and a push that it does not know: by the hand,
sample by sample, and as one call; beside it what phihat's law makes of the same study.
"""

from pathlib import Path

import numpy as np
import phihat

STUDY = Path(__file__).parents[2] / "studies/first.toml"


class Pd:
    """tau = M (ddq_des - kd de - kp e)"""

    def __init__(self, inertia, kp=400.0, kd=40.0):
        self.inertia, self.kp, self.kd = inertia, kp, kd

    def update(self, s):
        e, de = s.q - s.q_des, s.dq - s.dq_des
        return self.inertia * (s.ddq_des - self.kd * de - self.kp * e)


# %% Sample by sample: the loop is yours.
plant = phihat.Plant(STUDY)
law = Pd(plant.inertia)
while not plant.done:
    tau = law.update(plant.sample)
    plant.step(tau)
by_hand = plant.trace()

# %% Or in one call. The same world, the same torques: the same trace, bit for bit.
at_once = phihat.simulate(STUDY, controller=Pd(plant.inertia))
assert np.array_equal(by_hand["q"], at_once["q"])

# %% Beside it phihat. phihat.compare(STUDY, laws=[...]) tunes an own law and the others alike, in harder worlds.
ours = phihat.simulate(STUDY)
for name, trace in (("own law", by_hand), ("phihat", ours)):
    error = 1e3 * np.abs(trace["e"][trace.t > 1.5]).max()
    print(f"{name}: largest |e| after 1.5 s {error:.2f} mrad")
assert not by_hand.within_spec and ours.within_spec
