"""Place the labels of the picture such that none covers another.

Labels of places that are close together are joined. Findings have labels only if they belong to the current
command or its neighbours. A label that would cover another one in the first view is raised.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.stage import Mark

_MOST = 24
"""Largest number of findings with labels at a time."""
SHARE = 0.1
"""Places nearer than this share of half the picture's size share a label. At first, this is the height of
three labels.
"""

_FOCUS = 400.0 / np.tan(np.deg2rad(37.5))
"""Number of pixels of a metre at a distance of a metre: half of a usual window's height, divided by the
tangent of half the camera's first angle.
"""
_WIDE, _HIGH = 9.0, 20.0
"""Width of a character and height of a line, including the space around them [pixels], at scale 1."""
_MOST_LINES = 40
"""Largest height by which a label is raised, in lines."""

Anchor = Literal["bottom-center", "bottom-left", "top-left"]


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """A text at a fixed point of the scene.

    Attributes:
        text: the text.
        place: (3,) the point [m].
        scale: size relative to the usual one.
        anchor: which corner or side of the label lies at the point.
    """

    text: str
    place: Array
    scale: float
    anchor: Anchor


def raised(labels: Sequence[Label], eye: Array, middle: Array) -> list[float]:
    """Return the heights [m] by which labels must be raised, so that each is clear of the labels before it.

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
        if depth > 0.0:  # otherwise it is behind the eye
            for lines in range(_MOST_LINES):
                y = _FOCUS * above / depth + lines * _HIGH * label.scale
                # Raising a label also changes its distance from the eye.
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

    A point belongs to the first group whose first point is nearer than `apart` [m]. If there is none, it
    begins a new group.
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

    These are the findings of the command and of its two neighbours (for command -1, of all commands), and the
    findings that belong to no command.
    """
    near = [
        number
        for number, one in enumerate(marks)
        if piece < 0 or one.piece < 0 or abs(one.piece - piece) <= 1
    ]
    # Findings of the current command come first.
    near.sort(key=lambda number: abs(marks[number].piece - piece))
    return frozenset(near[:_MOST])
