"""Colours that people with any colour vision tell apart, and which command has which."""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen
from yarclang.motion.plan import MotionPlan

Colour = tuple[float, float, float]

# Okabe and Ito, "Color Universal Design" (2008), without its yellow, which is faint on white
_JOINTS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#000000")

_STYLES: tuple[Literal["-", "--", ":"], ...] = ("-", "--", ":")
"""Joints beyond the seventh repeat the colours with another dash."""

CORNER_COLOUR = "#E66100"
"""Of corners that are passed in motion."""

MOST_BARS = 256
"""More commands than this share bars and colours with their neighbours: neither could be seen apart."""


@frozen
class Bar:
    """Consecutive motions in one colour: `first` up to but without `behind`, from `start` to `end` [s].

    `index` and `name` are those of the first motion's command, `text_colour` is legible on `colour`.
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
    """The colour and the line style of a joint, counted from 0."""
    return _JOINTS[joint % len(_JOINTS)], _STYLES[joint // len(_JOINTS) % len(_STYLES)]


def bars_of(plan: MotionPlan) -> tuple[Bar, ...]:
    """The motions of a plan in at most `MOST_BARS` bars, coloured from first to last in the order of viridis."""
    from matplotlib import colormaps

    count = len(plan.motions)
    number = min(count, MOST_BARS)
    bars = []
    for bar in range(number):
        first, behind = bar * count // number, (bar + 1) * count // number
        origin = plan.origin_of(first)
        # from the dark end to one that is still seen on white
        red, green, blue, _ = colormaps["viridis"](0.10 + 0.72 * (bar / max(number - 1, 1)))
        is_light = 0.299 * red + 0.587 * green + 0.114 * blue > 0.5
        bars.append(
            Bar(
                first=first,
                behind=behind,
                start=float(plan.begins[first]),
                end=float(plan.ends[behind - 1]),
                index=origin.index,
                name=origin.name,
                colour=(red, green, blue),
                text_colour="0.1" if is_light else "white",
            )
        )
    return tuple(bars)
