"""Arms of robosuite as MuJoCo models, without their geometry."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from fetch_arms import ARMS, fetch

FOLDER = Path(os.environ.get("PHIHAT_ARMS", Path(__file__).parents[3] / "target" / "python" / "arms"))

ARMATURE = 0.1
"""Rotor inertia [kg m^2] of every joint: these descriptions have none, and MuJoCo Menagerie's arms have this."""


def written(arm: str, payload_kg: float = 0.0) -> str:
    """The text of an arm's MJCF, with rotors; the payload is a small ball welded to its hand."""
    if not all((FOLDER / f"{name}.xml").exists() for name in ARMS):
        fetch(FOLDER)
    root = ElementTree.parse(FOLDER / f"{arm}.xml").getroot()
    for asset in root.findall("asset"):
        root.remove(asset)
    for parent in list(root.iter()):
        for child in [c for c in parent if c.tag in ("geom", "site", "camera")]:
            parent.remove(child)
        for joint in [c for c in parent if c.tag == "joint"]:
            joint.set("armature", repr(ARMATURE))
    if payload_kg > 0.0:
        (hand,) = (body for body in root.iter("body") if body.get("name") == "right_hand")
        ball = ElementTree.SubElement(hand, "body", name="payload")
        ElementTree.SubElement(ball, "inertial", mass=repr(payload_kg), pos="0 0 0", diaginertia="1e-6 1e-6 1e-6")
    return ElementTree.tostring(root, encoding="unicode")


def load(arm: str, payload_kg: float = 0.0, timestep: float = 1e-3) -> Any:
    """A model of an arm; the payload is a small ball welded to its hand."""
    model = mujoco.MjModel.from_xml_string(written(arm, payload_kg))
    model.opt.timestep = timestep
    return model


def middle(model: Any) -> Any:
    """The middle of each joint's range; 0 where it turns more than once."""
    low, high = model.jnt_range[:, 0], model.jnt_range[:, 1]
    return np.where(high - low < 4.0 * np.pi - 0.1, 0.5 * (low + high), 0.0)
