"""Arms that others described: the MJCF files of robosuite's arms, out of its wheel, into a folder.

    python fetch_arms.py FOLDER
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

PACKAGE = "robosuite==1.5.2"
ARMS = ("iiwa", "jaco", "kinova3", "panda", "sawyer", "ur5e", "xarm7")


def fetch(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as room:
        download = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", room, PACKAGE]
        subprocess.run(download, check=True)
        (wheel,) = Path(room).glob("robosuite-*.whl")
        with zipfile.ZipFile(wheel) as archive:
            for arm in ARMS:
                text = archive.read(f"robosuite/models/assets/robots/{arm}/robot.xml")
                (folder / f"{arm}.xml").write_bytes(text)


if __name__ == "__main__":
    fetch(Path(sys.argv[1]))
