"""04: gains for an error bound, with a certificate that anyone can check again."""

from pathlib import Path

import phihat

STUDY = Path(__file__).parents[2] / "studies" / "panda_design.toml"

# %% The study states the largest error and the largest payload; phihat finds the gains.
gains = phihat.design(STUDY)
gains.verify()
assert gains.window is not None and gains.error_bound is not None
for name, (low, high), bound in zip(gains.joint_names, gains.window, gains.error_bound):
    print(f"{name}: stable while the inertia is {low:.2f} to {high:.2f} times M̄; |e| ≤ {1e3 * bound:.3f} mrad")

# %% What cannot be had is refused, with the clause in the way and what is possible.
try:
    phihat.design(
        {
            "duration_s": 3.0,
            "robot": {"name": "planar3r"},
            "spec": {"error_bound_rad": 1e-7},
            "design": {"payload_max_kg": 1.0},
            "reference": {
                "kind": "sines",
                "center": "ready",
                "sine": [{"amplitude_rad": 0.2, "frequency_hz": 0.3}],
            },
        }
    )
    raise SystemExit("1e-7 rad should not be possible")
except phihat.Infeasible as no:
    print(no)
