"""07: a second opinion on a simulation: the same study in MuJoCo.

Needs: pip install mujoco. On the command line: python -m phihat crosscheck studies/panda_hand.toml
"""

from pathlib import Path

import phihat

STUDY = Path(__file__).parents[2] / "studies" / "panda_hand.toml"

found = phihat.crosscheck(STUDY)
print(found)
assert found.agrees
