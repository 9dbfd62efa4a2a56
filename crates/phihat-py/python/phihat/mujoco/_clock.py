"""A loop that keeps to the clock, and how well it did."""

from __future__ import annotations

import os
import sys
import time
from typing import Any

import numpy as np


class Pace:
    """Waits for each sample's time and notes how late it began and how long it took."""

    def __init__(self, period: float, samples: int) -> None:
        self.period_ns = round(1e9 * period)
        self.late, self.took = np.zeros(samples), np.zeros(samples)
        self.start = 0
        self.viewer: Any = None

    def before(self, k: int, plant: Any) -> None:
        """Wait for sample ``k``."""
        if k == 0:
            self.viewer = viewer(plant)
            self.start = time.perf_counter_ns()
        elif self.viewer is not None and k % 16 == 0:
            self.viewer.sync()
        due = self.start + k * self.period_ns
        while (left := due - time.perf_counter_ns()) > 0:
            # Sleeping is coarse; the last stretch is waited for awake.
            if left > 300_000:
                time.sleep(1e-9 * (left - 200_000))
        self.began = time.perf_counter_ns()
        self.late[k] = 1e-3 * (self.began - due)

    def after(self, k: int) -> None:
        """Note that sample ``k`` is answered and the plant stepped."""
        self.took[k] = 1e-3 * (time.perf_counter_ns() - self.began)

    def text(self) -> str:
        """Both distributions, in microseconds."""
        period = 1e-3 * self.period_ns

        def row(name: str, values: Any) -> str:
            p50, p99, most = np.percentile(values, 50), np.percentile(values, 99), values.max()
            return f"{name}: median {p50:.0f} µs, 99 % {p99:.0f} µs, largest {most:.0f} µs"

        missed = int((self.late > period).sum())
        return "\n".join(
            [
                f"{len(self.late)} samples by the clock, period {period:.0f} µs",
                row("late", self.late),
                row("sensors, controller and plant", self.took),
                f"{missed} samples began more than a period late",
            ]
        )


def real_time(loop: Any) -> str:
    """Run a loop on MuJoCo's own physics by the clock; says how late samples were."""
    pace = Pace(loop.period, len(loop.ours))
    try:
        loop.run(own=True, before=pace.before, after=pace.after)
    finally:
        if pace.viewer is not None:
            pace.viewer.close()
    return pace.text()


def viewer(plant: Any) -> Any:
    """MuJoCo's passive viewer, where there is a display."""
    shown = sys.platform in ("darwin", "win32") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not shown:
        return None
    import mujoco.viewer

    return mujoco.viewer.launch_passive(plant.model, plant.data)
