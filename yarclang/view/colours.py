"""Colours for values and for the contents of a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.model import Array
from yarclang.view.stage import Colour

LINK: Colour = (222, 226, 232)
JOINT_BODY: Colour = (245, 158, 66)
TOOL: Colour = (92, 110, 140)
PART: Colour = (176, 128, 82)
OBSTACLE: Colour = (150, 160, 150)
STALE: Colour = (196, 198, 202)
TOUCHING: Colour = (226, 32, 32)
GHOST: Colour = (60, 130, 230)
PLANNED_WAY: Colour = (60, 130, 230)
ZONES: dict[str, Colour] = {
    "allowed": (46, 160, 90),
    "forbidden": (214, 60, 50),
    "slow": (232, 178, 30),
    "posture": (130, 90, 200),
}
SEVERITIES: dict[str, Colour] = {"error": (214, 40, 40), "warning": (236, 146, 16), "note": (30, 120, 220)}

# Anchor colours of two ramps: viridis, and one from red through yellow to blue. The lightness of the second
# ramp varies, so that people with any kind of colour vision can read it.
_SPEED = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))
_CLEARANCE = ((165, 0, 38), (244, 109, 67), (254, 224, 144), (116, 173, 209), (49, 54, 149))
RAMPS: dict[str, tuple[Colour, ...]] = {
    "speed": _SPEED,
    "clearance": _CLEARANCE,
    "deviation": _CLEARANCE[::-1],
}


def coloured(values: Array, most: float, ramp: str) -> NDArray[np.uint8]:
    """Return the colour (N, 3) of each value on a colour scale.

    Args:
        values: (N,) from 0 to `most`; larger values get the last colour.
        most: value at the end of the colour scale.
        ramp: name of the colour ramp.
    """
    anchors = np.array(RAMPS[ramp], dtype=np.float64)
    share = np.clip(values / most if most > 0.0 else np.zeros_like(values), 0.0, 1.0) * (len(anchors) - 1)
    places = np.arange(len(anchors))
    return np.column_stack([np.interp(share, places, anchors[:, part]) for part in range(3)]).astype(np.uint8)


def linear(shades: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Convert sRGB colours to linear light intensities by IEC 61966-2-1.

    viser expects linear intensities for the colours of single points, but sRGB for the colour of a whole
    node.
    """
    share = shades / 255.0
    light = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    result: NDArray[np.uint8] = np.round(255.0 * light).astype(np.uint8)
    return result


def round_up(value: float) -> float:
    """Return the next round number: 1, 2 or 5 times a power of ten."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= value * (1 - 1e-9)))
