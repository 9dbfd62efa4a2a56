"""03: a robot's description and dynamics, with NumPy in and out."""

import numpy as np
import phihat

print("arms at hand:", ", ".join(phihat.robots()))
panda = phihat.Robot.from_name("panda")
q = np.array(panda.poses["ready"])
zero = np.zeros(7)

# %% Held by gravity's torque and nothing else, an arm at rest stays at rest.
ddq = panda.forward_dynamics(q, zero, panda.gravity(q))
assert np.abs(ddq).max() < 1e-12

# %% M, C and g in one: inverse dynamics of a moving arm, and back.
rng = np.random.default_rng(1)
dq, ddq = rng.normal(size=7), rng.normal(size=7)
tau = panda.inverse_dynamics(q, dq, ddq)
np.testing.assert_allclose(panda.mass_matrix(q) @ ddq + panda.bias(q, dq), tau, atol=1e-12)

# %% Rotor inertia, viscous and dry friction count only where asked for.
whole = panda.inverse_dynamics(q, dq, ddq, armature=True, damping=True, friction=True)
print("rotors and friction ask for", np.round(whole - tau, 2), "N·m more")

# %% A thousand postures at once.
many = q + 0.1 * rng.normal(size=(1000, 7))
poses = panda.frame_pose(many)
print("the flange is at", np.round(poses[:, :3, 3].mean(axis=0), 3), "m on average")
assert panda.mass_matrix(many).shape == (1000, 7, 7)

# %% With a kilogram welded to the flange, joint 2 carries more.
loaded = panda.with_payload("panda_link8", 1.0, [0.0, 0.0, 0.05], [0.0] * 6)
print("joint 2 holds", round(loaded.gravity(q)[1] - panda.gravity(q)[1], 2), "N·m more with 1 kg")
