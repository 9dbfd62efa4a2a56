"""The schedule of a sweep on many machines, on paper: wrong if it missed what is plain, or if the book told another table."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def schedule() -> Any:
    import sys

    spec = importlib.util.spec_from_file_location("schedule", ROOT / "tools" / "schedule.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["schedule"] = module
    spec.loader.exec_module(module)
    return module


def test_plain_cases_are_exact(schedule: Any) -> None:
    free = {"run_spread": 0.0, "process_s": 0.0, "plan_s": 0.0, "task_s": 0.0, "row_bytes": 0, "merge_s": 0.0}
    ideal = replace(schedule.Costs(), run_s=0.5, **free)
    two = schedule.Cluster(machines=2, cores=4)
    assert schedule.makespan(3200, two, ideal) == pytest.approx(3200 * 0.5 / 8)
    # One link, which is the slowest: nothing else counts.
    narrow = replace(ideal, run_s=1e-9, row_bytes=1000, link_bytes_s=1000.0)
    assert schedule.makespan(320, two, narrow) == pytest.approx(320.0, rel=1e-6)
    # One scheduler, which is the slowest.
    slow = replace(ideal, run_s=1e-9, task_s=2.0)
    assert schedule.makespan(320, two, slow) == pytest.approx(2.0 * 32, rel=1e-6)
    # Each process begins once, each shard is planned.
    begun = replace(ideal, process_s=10.0, plan_s=1.0)
    assert schedule.makespan(3200, two, begun) == pytest.approx(10.0 + 4 * 1.0 + 200.0)


def test_a_lost_machine_costs_time_and_nothing_else(schedule: Any) -> None:
    costs, whole = schedule.Costs(), schedule.Cluster(machines=10)
    hurt = schedule.makespan(10**7, replace(whole, lost=1), costs)
    without = schedule.makespan(10**7, whole, costs)
    assert without < hurt < 2.5 * without + costs.noticed_s


def test_the_book_tells_this_table(schedule: Any) -> None:
    page = (ROOT / "docs" / "book" / "src" / "how-to" / "rollouts.md").read_text()
    assert schedule.table() in page
