"""`phihat.sweep(on="ray")` on a cluster of this machine: a head and two nodes of one core each, workers and a node killed half-way.

    python ray_cluster.py FOLDER PROGRAM        PROGRAM: the command `phihat`

Wrong if any file were another than the command's; tells the times that `schedule.py` reckons with.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import phihat
import ray
from phihat import _sweep
from ray.cluster_utils import Cluster

VARY = {"world.payload.mass_kg": "0.05..0.9", "world.coulomb_extra_nm": "log:0.05..0.5"}
RUNS = 240
SEED = 9


def files(folder: Path) -> dict[str, bytes]:
    """What a sweep left, but how far it was."""
    paths = (p for p in folder.rglob("*") if p.is_file() and p.name not in ("journal.jsonl", ".phihat.lock"))
    return {str(p.relative_to(folder)): p.read_bytes() for p in paths}


def workers() -> list[int]:
    """Processes of this program's cluster that do a shard, by what they call themselves."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            above = int(Path(f"/proc/{parent}/stat").read_text().rsplit(")", 1)[1].split()[1])
        except (OSError, ValueError, IndexError):
            continue
        if words[0].startswith(b"ray::_shard_files") and os.getpid() in (parent, above):
            found.append(int(entry.name))
    return found


def main() -> None:
    folder, program = Path(sys.argv[1]), sys.argv[2]
    shutil.rmtree(folder / "sweep", ignore_errors=True)
    (folder / "sweep").mkdir(parents=True)
    study = Path("studies/first.toml").resolve()
    vary = [word for key, how in VARY.items() for word in ("--vary", f"{key}={how}")]
    call = [program, "sweep", str(study), *vary, "--runs", str(RUNS), "--seed", str(SEED), "--jobs", "1", "--out", "sweep/command", "-q"]
    begun = time.monotonic()
    if subprocess.run(call, cwd=folder, stdout=subprocess.DEVNULL).returncode not in (0, 1):
        raise SystemExit("the command's sweep failed")
    print(f"command, one thread: {(time.monotonic() - begun) / RUNS * 1e3:.2f} ms a run")
    os.chdir(folder / "sweep")
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
    ray.init(address=cluster.address, log_to_driver=False)

    @ray.remote(num_cpus=1)
    def nothing() -> None:
        import phihat  # noqa: F401

    begun = time.monotonic()
    ray.get([nothing.remote() for _ in range(2)])
    print(f"first task of a node's process: {time.monotonic() - begun:.2f} s")
    begun = time.monotonic()
    ray.get([nothing.remote() for _ in range(200)])
    print(f"an empty task: {(time.monotonic() - begun) / 200 * 1e3:.1f} ms")

    def swept(name: str, strike: Any) -> None:
        done: list[int] = []
        struck = threading.Thread(target=strike, args=(done,), daemon=True)
        struck.start()
        begun = time.monotonic()
        asked: dict[str, Any] = {"runs": RUNS, "seed": SEED, "on": "ray", "shards": 12, "out": name}
        phihat.sweep(study, VARY, progress=lambda runs, _: done.append(runs), **asked)
        struck.join(timeout=1.0)
        same = files(Path("command")) == files(Path(name))
        print(f"{name}: {time.monotonic() - begun:.1f} s, {'the same bytes' if same else 'OTHER BYTES'}")
        if not same or struck.is_alive():
            raise SystemExit(f"{name}: other bytes than the command's, or nothing was struck")

    swept("nothing-struck", lambda done: None)

    def kill_a_worker(done: list[int]) -> None:
        while not done or done[-1] < RUNS // 4:
            time.sleep(0.02)
        while not (found := workers()):
            time.sleep(0.02)
        os.kill(found[0], signal.SIGKILL)
        print(f"killed a worker after {done[-1]} runs")

    swept("worker-killed", kill_a_worker)

    def take_a_node(done: list[int]) -> None:
        while not done or done[-1] < RUNS // 4:
            time.sleep(0.02)
        cluster.remove_node(nodes[1], allow_graceful=False)
        print(f"took a node away after {done[-1]} runs")

    swept("node-lost", take_a_node)
    ray.shutdown()
    cluster.shutdown()
    print(f"a shard is tried {_sweep.TRIES + 1} times at most; every file was the command's")


main()
