"""Which labels are written, so that none lies on another: what is near together has one, and of findings those of the command at hand and its neighbours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.stage import Mark

_MOST = 24
"""So many findings have labels at once."""
SHARE = 0.1
"""What is nearer together than this share of half the picture's size is at one spot: about the height of three labels in the first view."""


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
