"""Random MJCF files that use what describes an arm: classes, frames, geoms, orientations, compiler settings, includes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

GEOMS = ("sphere", "capsule", "cylinder", "ellipsoid", "box")
SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}


def words(values: Any) -> str:
    return " ".join(repr(float(x)) for x in np.atleast_1d(values))


class Draft:
    """One file, or two of which one includes the other."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.degree = self.chance(0.6)
        self.bodies = 0
        self.joints: list[str] = []
        self.classes: list[str] = []

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def pick(self, *options: str) -> str:
        return str(self.rng.choice(np.array(options, dtype=object)))

    def angle(self, rad: Any) -> Any:
        return np.rad2deg(rad) if self.degree else np.asarray(rad)

    def vector(self, size: float) -> Any:
        return size * self.rng.normal(size=3)

    def orientation(self) -> str:
        """One of the five ways, or none."""
        match self.pick("none", "quat", "axisangle", "euler", "zaxis", "xyaxes"):
            case "quat":
                return f' quat="{words(self.rng.normal(size=4))}"'
            case "axisangle":
                angle = self.angle(self.rng.uniform(-3, 3))
                return f' axisangle="{words(self.vector(1))} {words(angle)}"'
            case "euler":
                return f' euler="{words(self.angle(self.rng.uniform(-3, 3, size=3)))}"'
            case "zaxis":
                axis = [0.0, 0.0, -1.0] if self.chance(0.2) else self.vector(1)
                return f' zaxis="{words(axis)}"'
            case "xyaxes":
                return f' xyaxes="{words(self.vector(1))} {words(self.vector(1))}"'
            case _:
                return ""

    def pose(self, size: float = 0.2) -> str:
        at = f' pos="{words(self.vector(size))}"' if self.chance(0.8) else ""
        return at + self.orientation()

    def own_class(self, share: float = 0.4) -> str:
        return f' class="{self.pick(*self.classes)}"' if self.chance(share) else ""

    def geom(self) -> str:
        kind = self.pick(*GEOMS)
        size = self.rng.uniform(0.02, 0.2, size=3)
        text = f'<geom type="{kind}"{self.own_class(0.2)}'
        if kind != "sphere" and self.chance(0.4):
            text += f' fromto="{words(self.vector(0.2))} {words(self.vector(0.2))}" size="{words(size[0])}"'
        else:
            text += f' size="{words(size[: SIZES[kind]])}"{self.pose()}'
        match self.pick("none", "mass", "density", "nothing"):
            case "mass":
                text += f' mass="{words(self.rng.uniform(0.1, 3))}"'
            case "density":
                text += f' density="{words(self.rng.uniform(100, 3000))}"'
            case "nothing":
                text += ' mass="0"'
            case _:
                pass
        if self.chance(0.2):
            text += f' group="{self.rng.integers(0, 6)}"'
        return text + "/>"

    def inertial(self) -> str:
        mass = self.rng.uniform(0.2, 5)
        # Moments of a body: sums of two of three second moments.
        a, b, c = 0.01 * self.rng.uniform(0.1, 1, size=3)
        moments = np.array([b + c, a + c, a + b])
        head = f'<inertial pos="{words(self.vector(0.1))}" mass="{words(mass)}"'
        if self.chance(0.4):
            axes, _ = np.linalg.qr(self.rng.normal(size=(3, 3)))
            full = axes @ np.diag(moments) @ axes.T
            six = [full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2]]
            return f'{head} fullinertia="{words(six)}"/>'
        return f'{head} diaginertia="{words(moments)}"{self.orientation()}/>'

    def joint(self, slides: bool, alone: bool) -> str:
        name = f"j{len(self.joints)}"
        self.joints.append(name)
        text = f'<joint name="{name}"{self.own_class(0.3)}' if self.chance(0.95) else f'<joint name="{name}"'
        text += f' type="{"slide" if slides else "hinge"}"'
        if slides:
            text += f' limited="true" range="{words(sorted(self.rng.uniform(-1, 1, size=2)))}"'
        elif self.chance(0.7):
            text += f' limited="true" range="{words(self.angle(sorted(self.rng.uniform(-3, 3, size=2))))}"'
        if self.chance(0.9) or not alone:
            text += f' axis="{words(self.vector(1))}"'
        if self.chance(0.4):
            text += f' pos="{words(self.vector(0.1))}"'
        if self.chance(0.4):
            text += f' ref="{words(0.3 * self.rng.normal() if slides else self.angle(self.rng.normal()))}"'
        for key in ("armature", "damping", "frictionloss"):
            if self.chance(0.4):
                text += f' {key}="{words(self.rng.uniform(0, 0.5))}"'
        return text + "/>"

    def inside(self, depth: int, moving: bool) -> list[str]:
        """What is in a body, some of it in frames."""
        lines: list[str] = []
        if moving:
            count = 1 + int(self.chance(0.2)) + int(self.chance(0.1))
            for _ in range(count):
                lines.append(self.framed(self.joint(self.chance(0.2), count == 1), 0.15))
        if self.chance(0.5):
            lines.append(self.inertial())
        lines += [self.framed(self.geom(), 0.3) for _ in range(self.rng.integers(1, 4))]
        # A moving body of its own has mass, whatever its geoms are.
        lines.append('<geom type="sphere" size="0.05" mass="0.7" group="1"/>')
        if self.chance(0.5):
            lines.append(self.framed(f'<site name="s{self.bodies}_{len(lines)}"{self.pose()}/>', 0.3))
        children = 1 + int(self.chance(0.1)) if depth > 0 else 0
        for _ in range(children):
            lines.append(self.framed("\n".join(self.body(depth - 1)), 0.2))
        return lines

    def framed(self, text: str, share: float) -> str:
        while self.chance(share):
            inherits = f' childclass="{self.pick(*self.classes)}"' if self.chance(0.3) else ""
            text = f"<frame{self.pose()}{inherits}>{text}</frame>"
        return text

    def body(self, depth: int) -> list[str]:
        self.bodies += 1
        name = f' name="b{self.bodies}"' if self.chance(0.8) else ""
        inherits = f' childclass="{self.pick(*self.classes)}"' if self.chance(0.3) else ""
        head = f"<body{name}{inherits}{self.pose(0.3)}>"
        return [head, *self.inside(depth, self.chance(0.85) or depth == 0), "</body>"]

    def defaults(self) -> list[str]:
        def level(name: str, depth: int) -> list[str]:
            self.classes.append(name)
            lines = [f'<default class="{name}">']
            if self.chance(0.6):
                group = f' group="{self.rng.integers(0, 4)}"' if self.chance(0.5) else ""
                turned = self.orientation() if self.chance(0.3) else ""
                lines.append(f'<geom density="{words(self.rng.uniform(300, 2000))}"{group}{turned}/>')
            if self.chance(0.6):
                lines.append(
                    f'<joint axis="{words(self.vector(1))}" armature="{words(self.rng.uniform(0, 0.2))}"'
                    f' damping="{words(self.rng.uniform(0, 2))}"/>'
                )
            if self.chance(0.4):
                lines.append(f'<motor gear="{words(self.rng.uniform(1, 20))}" ctrlrange="-3 4"/>')
            if depth > 0:
                lines += level(f"{name}_a", depth - 1)
                if self.chance(0.5):
                    lines += level(f"{name}_b", depth - 1)
            return [*lines, "</default>"]

        return level("main", int(self.rng.integers(0, 4)))

    def compiler(self) -> str:
        text = '<compiler inertiafromgeom="' + self.pick("auto", "auto", "true") + '"'
        if not self.degree or self.chance(0.5):
            text += f' angle="{"degree" if self.degree else "radian"}"'
        if self.chance(0.5):
            text += f' eulerseq="{"".join(self.pick(*"xyzXYZ") for _ in range(3))}"'
        if self.chance(0.3):
            text += ' inertiagrouprange="0 3"'
        if self.chance(0.2):
            text += f' boundmass="{words(self.rng.uniform(0.1, 1))}" boundinertia="{words(self.rng.uniform(1e-4, 1e-2))}"'
        if self.chance(0.2):
            text += ' balanceinertia="true"'
        if self.chance(0.2):
            text += f' settotalmass="{words(self.rng.uniform(5, 50))}"'
        return text + "/>"

    def write(self, folder: Path) -> Path:
        """The file that is to be read."""
        defaults = self.defaults()
        bodies = self.body(int(self.rng.integers(1, 5)))
        actuators = [
            f'<motor joint="{name}"{self.own_class()} armature="{words(self.rng.uniform(0, 0.01))}"/>'
            for name in self.joints
        ]
        gravity = f'<option gravity="{words(self.vector(5))}"/>' if self.chance(0.5) else ""
        apart = folder / "part.xml"
        world = "\n".join(["<worldbody>", '<geom type="plane" size="1 1 1"/>', *bodies, "</worldbody>"])
        if self.chance(0.3):
            apart.write_text("<mujoco>\n" + "\n".join(bodies) + "\n</mujoco>\n")
            world = '<worldbody><include file="part.xml"/></worldbody>'
        lines = ['<mujoco model="drawn">', self.compiler(), gravity, *defaults, world]
        path = folder / "drawn.xml"
        path.write_text("\n".join([*lines, "<actuator>", *actuators, "</actuator>", "</mujoco>"]) + "\n")
        return path
