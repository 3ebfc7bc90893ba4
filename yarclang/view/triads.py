"""Choose the frames that are drawn: one set of axes for all frames with equal poses, and each name once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.labels import spots
from yarclang.view.stage import Axes

_SAME = 1e-6
"""Difference up to which poses count as equal [m, and entries of rotation matrices]."""


@dataclass(frozen=True, slots=True, eq=False)
class Triad:
    """The three axes that are drawn for all frames with one pose.

    Attributes:
        joint: number of joints that move the axes, counted from the base.
        base_from_frame: (4, 4) pose with all joints at zero.
        matters: True if one of these frames is important (`Axes.matters`).
    """

    joint: int
    base_from_frame: Array
    matters: bool


@dataclass(frozen=True, slots=True, eq=False)
class Name:
    """The names of frames at one point of the scene.

    Attributes:
        joint: number of joints that move the point.
        place: (3,) position of the point with all joints at zero [m].
        matters: True if one of the frames there is important (`Axes.matters`).
        text: the names.
    """

    joint: int
    place: Array
    matters: bool
    text: str


def triads_of(axes: Sequence[Axes]) -> list[Triad]:
    """Return one set of axes for all frames with equal poses. Important frames come first, so that no other
    frame hides them.
    """
    found: list[Triad] = []
    for one in sorted(axes, key=lambda one: not one.matters):
        if not any(_coincide(triad, one) for triad in found):
            found.append(Triad(one.joint, one.base_from_frame, one.matters))
    return found


def _coincide(triad: Triad, one: Axes) -> bool:
    return triad.joint == one.joint and bool(
        np.abs(triad.base_from_frame - one.base_from_frame).max() < _SAME
    )


def names_of(axes: Sequence[Axes], apart: float) -> list[Name]:
    """Return the names of frames with their positions. Each name is written once, at the frame's first pose.
    Names that are nearer to each other than `apart` [m] are joined.

    If a frame has several poses, its name includes their number, such as "{CELL} 1 of 24".
    """
    counts = Counter(one.name for one in axes)
    firsts: dict[str, Axes] = {}
    for one in sorted(axes, key=lambda one: not one.matters):
        firsts.setdefault(one.name, one)
    found: list[Name] = []
    chosen = [one for one in axes if firsts[one.name] is one]
    for kind in dict.fromkeys((one.joint, one.matters) for one in chosen):
        alike = [one for one in chosen if (one.joint, one.matters) == kind]
        places = np.array([one.base_from_frame[:3, 3] for one in alike])
        for spot in spots(places, apart):
            texts = [_text(alike[one].name, counts[alike[one].name]) for one in spot]
            found.append(Name(kind[0], places[spot[0]], kind[1], " ".join(texts)))
    return found


def _text(name: str, count: int) -> str:
    return f"{{{name}}}" if count == 1 else f"{{{name}}} 1 of {count}"
