"""The style of all pictures, which doesn't depend on the user's matplotlibrc."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_STYLE: Any = {
    "svg.hashsalt": "yarclang",  # equal pictures have equal bytes
    "text.parse_math": False,  # a name with dollars is no formula
    "font.size": 9.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "0.35",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "grid.color": "0.85",
    "grid.linewidth": 0.6,
}


@contextmanager
def picture_style() -> Iterator[None]:
    """Use the style for everything that is drawn in the context."""
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


def printable(text: str) -> str:
    """Return the text with a dot for each character that can't be drawn."""
    return "".join(character if character.isprintable() else "·" for character in text)


LONGEST_NAME = 20
"""Largest number of characters of a name among other names in a picture."""


def short_name(name: str) -> str:
    """Return a name in a form that can be drawn, with at most `LONGEST_NAME` characters. If it is longer, its
    middle is left out.
    """
    name = printable(name)
    kept = (LONGEST_NAME - 1) // 2
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1 - kept]}…{name[-kept:]}"
