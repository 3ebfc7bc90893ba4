"""The arms of kinematics.py: URDFs of the package example-robot-data, and the paper's robot as if it were
calibrated.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio

from yarclang.robot.library import stdlib_folder

DATA = Path(pinocchio.__file__).parents[4] / "share" / "example-robot-data" / "robots"
SHAPES = re.compile(r"<(visual|collision)\b.*?</\1>", re.DOTALL)
"""Shapes, which are removed: nothing here collides, and other libraries may fail to load meshes."""
MIMICS = re.compile(r"<mimic[^>]*/>")

FILES = {
    "UR5": "ur_description/urdf/ur5_robot.urdf",
    "Panda": "panda_description/urdf/panda.urdf",
    "Kinova": "kinova_description/robots/kinova.urdf",
}


def urdf(name: str) -> str:
    """Return the text of an arm's URDF, without shapes."""
    if name == "industrial6":
        return SHAPES.sub(
            "", (stdlib_folder() / "robots/industrial6/industrial6.urdf").read_text(encoding="utf-8")
        )
    if name == "calibrated":
        return calibrated(urdf("industrial6"))
    return MIMICS.sub("", SHAPES.sub("", (DATA / FILES[name]).read_text(encoding="utf-8-sig")))


def calibrated(text: str, seed: int = 1) -> str:
    """Return the URDF with each joint's frame displaced by about 0.1 mm and 0.01 deg in every direction, so
    that no axes intersect.
    """
    random = np.random.default_rng(seed)

    def off(origin: re.Match[str]) -> str:
        parts = []
        for key, size in (("xyz", 1e-4), ("rpy", np.radians(0.01))):
            said = re.search(rf'{key}="([^"]*)"', origin[0])
            values = [float(value) for value in said[1].split()] if said else [0.0, 0.0, 0.0]
            parts.append(f'{key}="{" ".join(f"{value + size * random.normal():.12g}" for value in values)}"')
        return f"<origin {' '.join(parts)}/>"

    return re.sub(
        r"<joint\b.*?</joint>",
        lambda joint: re.sub(r"<origin\b[^>]*/>", off, joint[0]),
        text,
        flags=re.DOTALL,
    )
