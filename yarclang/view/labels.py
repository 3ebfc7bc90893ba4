"""Which labels are written and where, so that none lies on another: what is near together has one, of findings those of the command at hand and its
neighbours have one, and labels that would lie on others in the first view are raised.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.stage import Mark

_MOST = 24
"""So many findings have labels at once."""
SHARE = 0.1
"""What is nearer together than this share of half the picture's size is at one spot: about the height of three labels in the first view."""

_FOCUS = 400.0 / np.tan(np.deg2rad(37.5))
"""Pixels of a metre a metre away: half of a usual window's height, and of the angle that a camera sees at first."""
_WIDE, _HIGH = 9.0, 20.0
"""How wide a character is, and how high a line [pixels], at scale 1, with what is round them."""
_MOST_LINES = 40
"""Labels aren't raised by more lines."""

Anchor = Literal["bottom-center", "bottom-left", "top-left"]


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """What is written at a place (3,) that doesn't move; the anchor is which of its corners, or the middle of which side, is there."""

    text: str
    place: Array
    scale: float
    anchor: Anchor


def raised(labels: Sequence[Label], eye: Array, middle: Array) -> list[float]:
    """By how much [m] each label is to be raised so that, seen from an eye that looks at the middle (3,), it lies on none of those before it."""
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
        if depth > 0.0:  # else it is behind the eye
            for lines in range(_MOST_LINES):
                y = _FOCUS * above / depth + lines * _HIGH * label.scale
                # what is raised comes nearer, or goes away
                height = (y * depth / _FOCUS - above) / float(up[2] - y * ahead[2] / _FOCUS)
                box = _box(label, _FOCUS * aside / (depth + height * float(ahead[2])), y)
                if not _meets(box, taken):
                    break
            taken = np.vstack([taken, box])
        heights.append(max(height, 0.0))
    return heights


def _box(label: Label, x: float, y: float) -> Array:
    """What a label covers on the screen: its least and its largest coordinates (4,) [pixels]."""
    wide, high = _WIDE * label.scale * (len(label.text) + 1), _HIGH * label.scale
    left = x - wide / 2.0 if label.anchor == "bottom-center" else x
    low = y - high if label.anchor == "top-left" else y
    return np.array([left, low, left + wide, low + high])


def _meets(box: Array, taken: Array) -> bool:
    apart = (box[:2] >= taken[:, 2:]) | (taken[:, :2] >= box[2:])
    return bool((~apart.any(axis=1)).any())


def spots(places: Array, apart: float) -> list[list[int]]:
    """Places (N, 3) in groups: each belongs to the first one whose first place is nearer than `apart` [m], else it begins one."""
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
    """The findings that have a label while a command is carried out: those of it and of the two beside it; with -1, of all commands. Those
    that are about no command always have one.
    """
    near = [
        number
        for number, one in enumerate(marks)
        if piece < 0 or one.piece < 0 or abs(one.piece - piece) <= 1
    ]
    # the command at hand comes first
    near.sort(key=lambda number: abs(marks[number].piece - piece))
    return frozenset(near[:_MOST])
