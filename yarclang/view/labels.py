"""Place the labels of the picture such that no label covers another.

Labels of points that are close to each other are joined. Findings have labels only if they belong to the
current command or its neighbours. A label that would cover another one in the first view is raised.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.stage import Mark

_MOST = 24
"""Largest number of findings that have labels at the same time."""
SHARE = 0.1
"""Largest distance of two points whose texts are joined to one label, as a share of half the scene's
diagonal. In the first view, this is about the height of three labels.
"""

_FOCUS = 400.0 / np.tan(np.deg2rad(37.5))
"""Length on the screen of one metre that is one metre away from the camera [pixels]: half of a usual window's
height, divided by the tangent of half the camera's angle of view.
"""
_WIDE, _HIGH = 9.0, 20.0
"""Width of a character and height of a line, including the space around them [pixels], at scale 1."""
_MOST_LINES = 40
"""Largest number of text lines by which a label is raised."""

Anchor = Literal["bottom-center", "bottom-left", "top-left"]


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """A text at a fixed point of the scene.

    Attributes:
        text: the text.
        place: (3,) the point [m].
        scale: size relative to the usual size.
        anchor: the corner or side of the label that lies at the point.
    """

    text: str
    place: Array
    scale: float
    anchor: Anchor


def raised(labels: Sequence[Label], eye: Array, middle: Array) -> list[float]:
    """Return the height [m] by which each label must be raised so that it covers none of the labels before
    it.

    Args:
        labels: the labels.
        eye: (3,) position of the camera [m].
        middle: (3,) the point at which the camera looks [m].
    """
    ahead = (middle - eye) / np.linalg.norm(middle - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    heights: list[float] = []
    taken = np.zeros((0, 4))
    for label in labels:
        ray = label.place - eye
        aside, above, depth = (float(ray @ axis) for axis in (right, up, ahead))
        height = 0.0
        if depth > 0.0:  # labels behind the camera aren't raised
            for lines in range(_MOST_LINES):
                y = _FOCUS * above / depth + lines * _HIGH * label.scale
                # A raised label is also nearer to the camera or farther away.
                height = (y * depth / _FOCUS - above) / float(up[2] - y * ahead[2] / _FOCUS)
                box = _box(label, _FOCUS * aside / (depth + height * float(ahead[2])), y)
                if not _meets(box, taken):
                    break
            taken = np.vstack([taken, box])
        heights.append(max(height, 0.0))
    return heights


def _box(label: Label, x: float, y: float) -> Array:
    """Return the box of a label on the screen: smallest and largest coordinates (4,) [pixels]."""
    wide, high = _WIDE * label.scale * (len(label.text) + 1), _HIGH * label.scale
    left = x - wide / 2.0 if label.anchor == "bottom-center" else x
    low = y - high if label.anchor == "top-left" else y
    return np.array([left, low, left + wide, low + high])


def _meets(box: Array, taken: Array) -> bool:
    apart = (box[:2] >= taken[:, 2:]) | (taken[:, :2] >= box[2:])
    return bool((~apart.any(axis=1)).any())


def spots(places: Array, apart: float) -> list[list[int]]:
    """Group points (N, 3) that are close to each other.

    A point belongs to the first group whose first point is nearer than `apart` [m]. If there is no such
    group, the point begins a new one.
    """
    found: list[list[int]] = []
    for number, place in enumerate(places):
        firsts = np.array([places[one[0]] for one in found]).reshape(-1, 3)
        (near,) = np.nonzero(np.linalg.norm(firsts - place, axis=1) < apart)
        if len(near):
            found[int(near[0])].append(number)
        else:
            found.append([number])
    return found


def labelled(marks: Sequence[Mark], piece: int) -> frozenset[int]:
    """Return the findings that have labels in the picture while a command is shown.

    These are the findings of the command and of its two neighbours, and findings that belong to no command.
    For command -1, they are the findings of all commands.
    """
    near = [
        number
        for number, one in enumerate(marks)
        if piece < 0 or one.piece < 0 or abs(one.piece - piece) <= 1
    ]
    # Findings of the current command come first, since there may be too many.
    near.sort(key=lambda number: abs(marks[number].piece - piece))
    return frozenset(near[:_MOST])
