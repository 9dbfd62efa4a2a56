"""Expected expansions of ../xacro/*.xacro by xacro of PyPI, and values of expressions by Python.

    pip install xacro==2.1.1 pyyaml && python make_xacro.py
"""

import glob
import json
import math
import os
import random
import sys
import types

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "xacro")
packages = types.ModuleType("ament_index_python.packages")
packages.get_package_share_directory = lambda name: os.path.join(FOLDER, name)
sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
sys.modules["ament_index_python.packages"] = packages

import xacro  # noqa: E402


def expansions():
    for path in sorted(glob.glob(os.path.join(FOLDER, "*.xacro"))):
        text = xacro.process_file(path).documentElement.toprettyxml(indent="  ")
        with open(path.replace(".xacro", ".urdf"), "w") as out:
            out.write("\n".join(line for line in text.split("\n") if line.strip()) + "\n")


NAMES = {name: getattr(math, name) for name in ("sin", "cos", "sqrt", "radians", "floor", "ceil", "atan2", "pi", "hypot")}
NAMES.update(a=3, b=0.25, word="arm", flag=True, items=[1, 2.5, "x"], __builtins__={"abs": abs, "min": min, "max": max, "len": len, "str": str, "int": int, "round": round, "sum": sum})


def drawn(rng, depth):
    """A random expression."""
    if depth == 0:
        return rng.choice(["a", "b", "flag", "pi", "2", "0.5", "-1", "7", "1e-3", "items[0]", "items[1]", "len(word)"])
    one, two = drawn(rng, depth - 1), drawn(rng, depth - 1)
    return rng.choice([
        f"{one} + {two}", f"{one} - {two}", f"{one} * {two}", f"({one}) / ({two})", f"({one}) // ({two})", f"({one}) % ({two})",
        f"-{one}", f"({one}) ** 2", f"({one}) < {two}", f"{one} == {two}", f"not ({one})", f"({one}) and ({two})",
        f"({one}) or ({two})", f"({one}) if ({two}) else a", f"min({one}, {two})", f"max({one}, {two}, 1)", f"abs({one})",
        f"sin({one})", f"atan2({one}, {two})", f"sqrt(abs({one}))", f"floor({one})", f"[{one}, {two}][-1]",
        f"word + str({one})", f"word * (len(word) - 2)", f"({one}) in items", f"'r' in word", f"1 <= {one} < {two}",
        f"round({one})", f"-({one}) ** 2", f"2 ** -{rng.randint(0, 3)}", f"(({one}))", f"items[-{rng.randint(1, 3)}]", f"sum([a, b, {rng.randint(0, 9)}])",
    ])


def expressions():
    rng = random.Random(7)
    rows = []
    while len(rows) < 600:
        text = drawn(rng, rng.randint(0, 4))
        try:
            value = eval(text, dict(NAMES))
        except Exception:
            value = None
            rows.append([text, None, ""])
            continue
        if isinstance(value, complex) or (isinstance(value, (int, float)) and abs(value) > 1e15):
            continue
        rows.append([text, type(value).__name__, str(value)])
    with open(os.path.join(FOLDER, "expressions.json"), "w") as out:
        out.write("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")


expansions()
expressions()
