"""The judge's reader of single move lines, which live motions use."""

from __future__ import annotations

import re

import numpy as np

from yarclang.robot.model import Array, Robot

_WORD = re.compile(r"([A-Z])(-?\d+(?:\.\d*)?)")


def read_moves(robot: Robot, lines: tuple[str, ...]) -> Array | str:
    """Return the points of move lines (k, n) [rad or m], or the fault of the first wrong line."""
    axes = robot.controller.axes
    rows = []
    for line in lines:
        words = _WORD.findall(line)
        if tuple(axis for axis, _ in words) != axes or "".join(map("".join, words)) != line:
            return f"{line!r} isn't a move of all axes"
        rows.append([float(value) for _, value in words])
    return np.array(rows).reshape(-1, len(axes)) * robot.axis_units
