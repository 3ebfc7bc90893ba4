"""Format parts of a program's text: numbers in columns, indices, times, comments."""

from __future__ import annotations

import numpy as np

from yarclang.convert.course import Course
from yarclang.hir import Array

_DECIMALS = {"JOINTS": (6,), "RPY": (6,), "QUAT": (6, 6, 6, 9, 9, 9, 9)}
"""Largest number of decimals of each value of a target. The last entry of a list also applies to all further
values.
"""

STEP = 10
"""Difference between the numbers of successive indices: P0010, P0020."""

SAME_PLACE = 1e-6
"""Largest difference of the coordinates of targets that count as equal [deg, mm]."""

DEFAULT_TIME = "50%"
"""Time in [ ] for motions without a time in the file."""


def rows_of(values: Array, target: str) -> list[str]:
    """Return rows of target values (w, k) as text in columns, with as many decimals as the numbers need.

    Args:
        values: (w, k) [deg, mm].
        target: kind of the targets: JOINTS, RPY or QUAT.
    """
    columns: list[list[str]] = []
    most = _DECIMALS[target]
    for number, column in enumerate(values.T):
        last = most[min(number, len(most) - 1)]
        rounded = np.round(column, last) + 0.0  # adding 0.0 turns -0.0 into 0.0
        decimals = next(
            (fewer for fewer in range(last) if np.abs(np.round(rounded, fewer) - rounded).max() < 1e-11), last
        )
        texts = [f"{value:.{decimals}f}" for value in (np.round(rounded, decimals) + 0.0).tolist()]
        widest = max(map(len, texts))
        columns.append([text.rjust(widest) for text in texts])
    return [" ".join(row) for row in zip(*columns, strict=True)]


def index_text(number: int) -> str:
    """Return the index of a command as text, such as P0010."""
    return f"P{number:04}"


def comment_of(course: Course, number: int, with_name: bool = False) -> str:
    """Return the comment that follows a target in its line, with the target's name if wanted; empty if the
    target has no comment.
    """
    texts = [course.names[number]] if course.names and with_name else []
    text = plain(" ".join([*texts, *([course.comments[number]] if course.comments else [])]))
    return f"  ! {text}" if text else ""


def plain(text: str) -> str:
    """Return a text without line breaks and unprintable characters."""
    return " ".join("".join(one if one.isprintable() else " " for one in text).split())


def seconds(time: float) -> str:
    """Return a time [s] as text, to the microsecond."""
    return f"{time:.6f}".rstrip("0").rstrip(".")
