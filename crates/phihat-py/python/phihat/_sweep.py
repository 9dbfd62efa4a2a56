"""A sweep: a study many times, its numbers drawn anew in each run; on this machine, or on a cluster of Ray."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from queue import Empty, Queue
from typing import Any, Literal

from . import _phihat
from ._errors import ArgumentError, Error

Progress = Callable[[int, int], object]

TRIES = 5
"""How often a shard is begun again whose process was killed."""

_FILES = ("runs.npy", "gains.json", "shard.json")
"""What a finished shard leaves; the last of them says that the others are whole."""

_SHARDS = ".shards"


def sweep(
    study: str | os.PathLike[str],
    vary: Mapping[str, str] | Sequence[str],
    *,
    runs: int = 1000,
    seed: int = 1,
    gains: str | os.PathLike[str] | None = None,
    uncertified: bool = False,
    out: str | os.PathLike[str] | None = None,
    on: Literal["processes", "ray"] | None = None,
    shards: int | None = None,
    workers: int | None = None,
    resume: bool = True,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run a study many times with numbers drawn at random; what holds for how many runs, as in ``sweep.json``.

    Leaves what ``phihat sweep`` leaves, byte for byte, wherever the runs were done: ``runs.npy`` (``numpy.load`` reads it, a row
    per run), ``sweep.json``, ``report.html`` and the studies of the worst runs, in ``out/STUDY/sweep``. The unit of work is a
    shard. An interrupted sweep (Ctrl-C, a kill, a lost machine) goes on where it was when it is called again.

    Args:
        study: path of a study file.
        vary: numbers of the study and how they are drawn, as ``--vary KEY=HOW``: ``{"world.payload.mass_kg": "0..2"}`` or
            ``["world.payload.mass_kg=0..2"]``.
        runs: how many runs.
        seed: decides what every run draws.
        gains: a gains document in place of those that the study states or leaves to the design.
        uncertified: run gains even where they may not run on this arm.
        out: folder for the results.
        on: ``None``: one process with a thread per core; ``"processes"``: a process per shard, some at a time; ``"ray"``: tasks of
            the Ray cluster that this process is connected to, else of a local one (``pip install 'phihat[ray]'``). Tasks read the
            study by its path, and send their rows back: nodes need the study and this package, and no common disk for results.
        shards: units of work; four per worker unless given. One machine's sweep is never cut.
        workers: processes at a time (one per core), or threads of the one process; of Ray, for how many workers to cut.
        resume: go on where an earlier call was; ``False`` does every run again.
        progress: called as ``progress(done, all)`` with runs, from this thread; what it raises ends the sweep.

    Raises:
        ArgumentError: an argument cannot be.
        Error: the study or what varies cannot be used, a result cannot be written, or Ray is missing.
    """
    varied = [f"{key}={how}" for key, how in vary.items()] if isinstance(vary, Mapping) else list(vary)
    if isinstance(vary, str) or not all(isinstance(text, str) for text in varied):
        raise _refused("vary", vary, "a dictionary of texts, or a list of KEY=HOW")
    for name, value in (("runs", runs), ("shards", shards), ("workers", workers)):
        whole = isinstance(value, int) and not isinstance(value, bool)
        if value is not None and not (whole and 1 <= value <= 1_000_000_000):
            raise _refused(name, value, "an integer from 1")
    document = None if gains is None else os.fspath(gains)
    asked: dict[str, Any] = {"study": os.fspath(study), "gains": document, "vary": varied, "runs": runs, "seed": seed}
    place = None if out is None else os.fspath(out)
    asked |= {"shard": None, "fresh": not resume, "uncertified": uncertified, "threads": None, "out": place}
    folder = Path(_phihat.sweep_folder(asked))
    told = _Told(progress, runs)
    if on is None:
        asked["threads"] = workers
        return _on_processes([asked], 1, told)[0]
    if on not in ("processes", "ray"):
        raise _refused("on", on, "None, 'processes' or 'ray'")
    parts = folder / _SHARDS / _fingerprint(asked)
    if not resume:
        shutil.rmtree(folder / _SHARDS, ignore_errors=True)
    run = _on_ray if on == "ray" else _on_processes
    at_once = workers or (_ray_cores() if on == "ray" else os.cpu_count() or 1)
    count = min(shards or 4 * at_once, runs)
    units = [{**asked, "shard": f"{k}/{count}", "threads": 1, "out": str(parts)} for k in range(1, count + 1)]
    waiting = [unit for unit in units if not (_place(unit) / "shard.json").exists()]
    told.begun(sum(_runs_of(unit) for unit in units if unit not in waiting))
    run(waiting, at_once, told)
    answer: dict[str, Any] = _phihat.merge([str(_place(unit)) for unit in units], str(folder))["sweep"]
    shutil.rmtree(folder / _SHARDS, ignore_errors=True)
    return answer


class _Told:
    """Tells how many runs are done, of all units together."""

    def __init__(self, progress: Progress | None, runs: int) -> None:
        self.progress, self.runs, self.done = progress, runs, dict[int, int]()

    def begun(self, before: int) -> None:
        self.done[-1] = before

    def __call__(self, unit: int, done: int) -> None:
        self.done[unit] = done
        if self.progress:
            self.progress(min(sum(self.done.values()), self.runs), self.runs)


def _on_processes(units: list[dict[str, Any]], at_once: int, told: _Told) -> list[dict[str, Any]]:
    """Units in processes of their own, so many at a time; a process that is killed is begun again and goes on by its journal."""
    said: Queue[tuple[int, dict[str, Any] | None]] = Queue()
    waiting, answers, tries = list(range(len(units))), dict[int, dict[str, Any]](), [0] * len(units)
    running: dict[int, subprocess.Popen[str]] = {}
    try:
        while len(answers) < len(units):
            while waiting and len(running) < at_once:
                unit = waiting.pop(0)
                running[unit] = _begun(units[unit], unit, said)
            try:
                # Not for ever: a signal is met in between.
                unit, line = said.get(timeout=0.2)
            except Empty:
                continue
            if line is None:
                code = running.pop(unit).wait()
                if unit in answers:
                    continue
                tries[unit] += 1
                if tries[unit] >= TRIES:
                    shard = units[unit]["shard"] or "1/1"
                    raise Error(f"sweep: the process of shard {shard} ended {TRIES} times with code {code} and no answer")
                # Begun before, so that not everything is done again.
                units[unit]["fresh"] = False
                waiting.append(unit)
            elif "error" in line:
                raise Error(line["error"])
            elif "answer" in line:
                answers[unit] = line["answer"]
            else:
                told(unit, line["done"])
    finally:
        for process in running.values():
            process.kill()
            process.wait()
    return [answers[unit] for unit in range(len(units))]


def _begun(asked: dict[str, Any], unit: int, said: Queue[tuple[int, dict[str, Any] | None]]) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}
    call = [sys.executable, "-c", "from phihat._sweep import _child; _child()"]
    process = subprocess.Popen(call, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdin is not None and process.stdout is not None
    lines = process.stdout
    try:
        process.stdin.write(json.dumps(asked))
        process.stdin.close()
    except BrokenPipeError:
        pass

    def listen() -> None:
        for line in lines:
            if line.endswith("\n"):
                said.put((unit, json.loads(line)))
        said.put((unit, None))

    threading.Thread(target=listen, daemon=True).start()
    return process


def _child() -> None:
    """The process of one unit: told on its input, tells on its output."""
    # Whoever began it ends it; the journal bears that at any moment.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    out = os.fdopen(os.dup(1), "w")

    def say(what: dict[str, Any]) -> None:
        try:
            out.write(json.dumps(what) + "\n")
            out.flush()
        except OSError:
            # Nobody listens any more: the journal keeps what is done.
            os._exit(1)

    asked = json.loads(sys.stdin.read())
    try:
        answer = _phihat.sweep(asked, lambda done, _all: say({"done": done}))
    except Error as why:
        say({"error": str(why)})
    else:
        say({"answer": answer["sweep"]})


def _ray() -> Any:
    try:
        import ray
    except ImportError as why:
        raise Error("ray is missing: pip install 'phihat[ray]'") from why
    if not ray.is_initialized():
        # A local cluster, which this process's end takes down.
        ray.init(include_dashboard=False, log_to_driver=False, configure_logging=False)
    return ray


def _ray_cores() -> int:
    return max(1, int(_ray().cluster_resources().get("CPU", 1)))


def _on_ray(units: list[dict[str, Any]], at_once: int, told: _Told) -> None:
    """Units as tasks of Ray, which begins those of a lost worker or machine again elsewhere; their files are put down here."""
    ray = _ray()
    task = ray.remote(num_cpus=1, max_retries=TRIES)(_shard_files)
    asked = [{**unit, "study": os.path.abspath(unit["study"])} for unit in units]
    for unit in asked:
        unit["gains"] = unit["gains"] and os.path.abspath(unit["gains"])
    waiting = {task.remote(unit): k for k, unit in enumerate(asked)}
    try:
        while waiting:
            # Not for ever: a signal is met in between.
            ready, _ = ray.wait(list(waiting), num_returns=1, timeout=0.5)
            for reference in ready:
                k = waiting.pop(reference)
                try:
                    files = ray.get(reference)
                except ray.exceptions.RayTaskError as why:
                    raise Error(str(why.cause)) from why
                except ray.exceptions.RayError as why:
                    shard = units[k]["shard"]
                    raise Error(f"sweep: Ray lost shard {shard} {TRIES + 1} times: {why}") from why
                _put(_place(units[k]), files)
                told(k, _runs_of(units[k]))
    finally:
        for reference in waiting:
            ray.cancel(reference, force=True)


def _shard_files(asked: dict[str, Any]) -> dict[str, bytes]:
    """A shard, done wherever Ray has it done; its files."""
    with tempfile.TemporaryDirectory() as folder:
        _phihat.sweep({**asked, "out": folder}, None)
        place = _place({**asked, "out": folder})
        return {name: (place / name).read_bytes() for name in _FILES}


def _put(place: Path, files: dict[str, bytes]) -> None:
    """Files of a finished shard; what says that they are whole comes last, whole."""
    place.mkdir(parents=True, exist_ok=True)
    for name in _FILES:
        beside = place / f".{name}.part"
        with beside.open("wb") as file:
            file.write(files[name])
            file.flush()
            os.fsync(file.fileno())
        beside.replace(place / name)


def _place(unit: dict[str, Any]) -> Path:
    """The folder of a shard."""
    part, count = unit["shard"].split("/")
    return Path(unit["out"]) / f"shard-{part}-of-{count}"


def _runs_of(unit: dict[str, Any]) -> int:
    """About how many runs a shard has."""
    runs, count = int(unit["runs"]), int(unit["shard"].split("/")[1])
    return runs // count


def _fingerprint(asked: dict[str, Any]) -> str:
    """Changes with all that decides a shard's rows, as far as it is seen here; merging looks at the rest."""
    parts = [_phihat.version(), asked["vary"], asked["runs"], asked["seed"], asked["uncertified"]]
    told = hashlib.sha256(json.dumps(parts).encode())
    for file in (asked["study"], asked["gains"]):
        told.update(b"|")
        if file is not None and Path(file).is_file():
            told.update(Path(file).read_bytes())
    return told.hexdigest()[:16]


def _refused(name: str, value: Any, limit: str) -> ArgumentError:
    return ArgumentError(f"{name}: {value!r}; it must be {limit}", field=name, value=value, limit=limit)
