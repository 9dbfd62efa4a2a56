"""05: a run with everything that hurts in a laboratory, as NumPy arrays, a figure and a report."""

import tempfile
from pathlib import Path

import numpy as np
import phihat

STUDY = Path(__file__).parents[2] / "studies" / "panda_hand.toml"

# %% Unknown payload and friction, 18-bit encoders, no velocity sensor, one sample of delay.
trace = phihat.simulate(STUDY)
print(trace)
steady = trace.t > 2.0
worst = np.abs(trace["e"][steady]).max(axis=0)
for name, e in zip(trace.joint_names, worst):
    print(f"{name}: {1e3 * e:.3f} mrad")
assert trace.within_spec and worst.max() < 5e-4

# %% φ̂ is the controller's estimate of everything it was not told.
missed = trace["phi"] - trace["phi_hat"]
print("largest unknown torque:", np.abs(trace["phi"]).max().round(1), "N·m; missed:", np.abs(missed[steady]).max().round(2))

# %% The same study, the same bits.
assert (phihat.simulate(STUDY)["q"] == trace["q"]).all()

# %% The report: one page, no network.
with tempfile.TemporaryDirectory() as folder:
    trace.report(Path(folder) / "report.html")
    print("report:", (Path(folder) / "report.html").stat().st_size // 1000, "kB")
