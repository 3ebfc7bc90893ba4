"""Colours for any colour vision, and their assignment to commands."""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen
from yarclang.motion.plan import MotionPlan

Colour = tuple[float, float, float]

# Okabe and Ito, "Color Universal Design" (2008), without its yellow, which is faint on white
_JOINTS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#000000")

_STYLES: tuple[Literal["-", "--", ":"], ...] = ("-", "--", ":")
"""Line styles. Joints beyond the seventh repeat the colours with another style."""

CORNER_COLOUR = "#E66100"
"""Colour of corners that are passed in motion."""

MOST_BARS = 256
"""Most bars and colours. Further commands share them with their neighbours, because they couldn't be
distinguished.
"""


@frozen
class Bar:
    """Consecutive motions in one colour.

    Attributes:
        first: number of the first motion.
        behind: number after the last motion.
        start: time of the beginning [s].
        end: time of the end [s].
        index: of the first motion's command.
        name: of the first motion's command.
        colour: of the bar.
        text_colour: legible on `colour`.
    """

    first: int
    behind: int
    start: float
    end: float
    index: str
    name: str
    colour: Colour
    text_colour: str


def joint_style(joint: int) -> tuple[str, Literal["-", "--", ":"]]:
    """Return the colour and the line style of a joint, counted from 0."""
    return _JOINTS[joint % len(_JOINTS)], _STYLES[joint // len(_JOINTS) % len(_STYLES)]


def bars_of(plan: MotionPlan) -> tuple[Bar, ...]:
    """Return the motions of a plan in at most `MOST_BARS` bars, coloured in the order of viridis."""
    from matplotlib import colormaps

    count = len(plan.motions)
    number = min(count, MOST_BARS)
    bars = []
    for bar in range(number):
        first, end = bar * count // number, (bar + 1) * count // number
        origin = plan.origin_of(first)
        # from the dark end to a colour that is visible on white
        red, green, blue, _ = colormaps["viridis"](0.10 + 0.72 * (bar / max(number - 1, 1)))
        is_light = 0.299 * red + 0.587 * green + 0.114 * blue > 0.5
        bars.append(
            Bar(
                first=first,
                behind=end,
                start=float(plan.begins[first]),
                end=float(plan.ends[end - 1]),
                index=origin.index,
                name=origin.name,
                colour=(red, green, blue),
                text_colour="0.1" if is_light else "white",
            )
        )
    return tuple(bars)
