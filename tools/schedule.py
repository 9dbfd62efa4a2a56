"""A sweep on many machines, on paper: what a scheduler would make of measured times. No machine but this one was used.

    python tools/schedule.py        prints the table of docs/book/src/how-to/rollouts.md

The model is a queue: one scheduler hands shards out one after another, each to the core that is free first; a core's first shard
waits for its process; a shard's rows come back over the scheduler's link, one after another, and are put together there at the end.
A machine that is lost takes its running shards with it, which are begun again at the end of the queue once the loss is noticed.
"""

from __future__ import annotations

import heapq
import random
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Costs:
    """What things take. Those that `cargo xtask ray` prints are to be put here by whoever has a machine to himself; these are round
    figures for a core that nothing else uses, larger than what was seen where that was possible."""

    run_s: float = 0.015
    """A run of 5 s of a Panda with friction, payload and encoder, alone on one core; in lanes it takes less."""
    run_spread: float = 0.15
    """Standard deviation of a shard's time over its mean: other work on a machine, longer steps of some runs."""
    process_s: float = 2.0
    """A worker's process, from its start to its first run: interpreter, imports, a copy of the package."""
    plan_s: float = 0.25
    """What each shard does before its first run: the study, its gains, every end of what varies."""
    task_s: float = 0.004
    """The scheduler's own time per shard."""
    row_bytes: int = 170
    """A run's row."""
    link_bytes_s: float = 100e6
    """The scheduler's link: a gigabit per second, less what protocols take."""
    merge_s: float = 1.2e-6
    """Putting together, per run."""
    noticed_s: float = 30.0
    """Until the loss of a machine is noticed."""


@dataclass(frozen=True)
class Cluster:
    """Machines, and into how many shards a sweep is cut for each core."""

    machines: int
    cores: int = 16
    shards_per_core: int = 4
    lost: int = 0
    """Machines that are lost half-way."""


def makespan(runs: int, cluster: Cluster, costs: Costs, seed: int = 1) -> float:
    """Time from the call to the whole answer [s]."""
    rng = random.Random(seed)
    cores = cluster.machines * cluster.cores
    shards = min(cluster.shards_per_core * cores, runs)
    mean = runs / shards * costs.run_s
    times = [costs.plan_s + max(0.2 * mean, rng.gauss(mean, costs.run_spread * mean)) for _ in range(shards)]
    half = 0.5 * (costs.process_s + sum(times) / cores)
    free = [(costs.process_s, core) for core in range(cores)]
    heapq.heapify(free)
    waiting, told, ends = list(enumerate(times)), 0.0, []
    waiting.reverse()
    again: list[tuple[float, int, float]] = []
    while waiting or again:
        now, core = heapq.heappop(free)
        if core // cluster.cores < cluster.lost and now >= half:
            continue
        if not waiting:
            # What was lost is begun once that is noticed, by whoever is free.
            known, shard, time = again.pop()
            now = max(now, known)
        else:
            shard, time = waiting.pop()
        told = max(told, now) + costs.task_s
        end = told + time
        if core // cluster.cores < cluster.lost and end > half:
            again.append((half + costs.noticed_s, shard, time))
            continue
        ends.append(end)
        heapq.heappush(free, (end, core))
    link = 0.0
    for end in sorted(ends):
        link = max(link, end) + runs / shards * costs.row_bytes / costs.link_bytes_s
    return link + costs.merge_s * runs


def table() -> str:
    """Rows of a table in Markdown, for a million and a hundred million runs."""
    costs = Costs()
    lines = [
        "| machines of 16 cores | shards per core | 10⁶ runs | of the ideal | 10⁸ runs | of the ideal | one machine lost half-way, 10⁸ |",
        "|---|---|---|---|---|---|---|",
    ]
    for machines in (1, 10, 100):
        for per_core in (1, 4, 16):
            cluster = Cluster(machines, shards_per_core=per_core)
            cells = [str(machines), str(per_core)]
            for runs in (10**6, 10**8):
                time = makespan(runs, cluster, costs)
                ideal = runs * costs.run_s / (machines * cluster.cores)
                cells += [shown(time), f"{100 * ideal / time:.0f} %"]
            hurt = makespan(10**8, replace(cluster, lost=1), costs) if machines > 1 else None
            lines.append("| " + " | ".join([*cells, "–" if hurt is None else shown(hurt)]) + " |")
    return "\n".join(lines)


def shown(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


if __name__ == "__main__":
    print(table())
