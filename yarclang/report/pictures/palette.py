"""Colours that people with any kind of colour vision can distinguish, and their assignment to a program's
commands.
"""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen
from yarclang.hir import Motion
from yarclang.motion.plan import MotionPlan

Colour = tuple[float, float, float]

# Okabe and Ito, "Color Universal Design" (2008), without its yellow, which is faint on white
_JOINTS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#000000")

_STYLES: tuple[Literal["-", "--", ":"], ...] = ("-", "--", ":")
"""Line styles of joints. From the eighth joint on, the colours are used again with the next style."""

CORNER_COLOUR = "#E66100"
"""Colour of corners that are passed without a stop."""

MOST_BARS = 256
"""Largest number of bars and colours in a picture. If there are more motions, consecutive motions share a
bar, because smaller bars couldn't be distinguished.
"""


Sort = Literal["process", "led", "joints"]
"""Kinds of motions that are drawn differently: motions of the tool at a programmed speed, other motions of
the tool along a path, and joint motions.
"""


@frozen
class Bar:
    """Consecutive motions that are drawn as one bar in one colour.

    Attributes:
        first: number of the first motion.
        behind: number after the last motion.
        start: time of the beginning [s].
        end: time of the end [s].
        index: index of the first motion's command.
        name: name of the first motion's command.
        colour: colour of the bar.
        text_colour: colour of text that is legible on `colour`.
        sort: kind of the first motion.
    """

    first: int
    behind: int
    start: float
    end: float
    index: str
    name: str
    colour: Colour
    text_colour: str
    sort: Sort = "led"


def joint_style(joint: int) -> tuple[str, Literal["-", "--", ":"]]:
    """Return the colour and the line style of a joint, counted from 0."""
    return _JOINTS[joint % len(_JOINTS)], _STYLES[joint // len(_JOINTS) % len(_STYLES)]


def bars_of(plan: MotionPlan) -> tuple[Bar, ...]:
    """Group the motions of a plan into at most `MOST_BARS` bars with colours.

    The lines of the program get the colours of viridis in their order. All motions of one line, as in the
    passes of a loop or the calls of a SUB, have the same colour.
    """
    from matplotlib import colormaps

    count = len(plan.motions)
    number = min(count, MOST_BARS)
    bounds = [bar * count // number for bar in range(number + 1)] if number else [0]
    firsts = bounds[:-1]
    origins = [plan.origin_of(first) for first in firsts]
    lines = [(origin.source.name, origin.span.line) for origin in origins]
    rank = {line: place for place, line in enumerate(dict.fromkeys(lines))}
    bars = []
    for first, end, origin, line in zip(firsts, bounds[1:], origins, lines, strict=True):
        # use only the middle of viridis: its brightest colours can't be seen on white
        red, green, blue, _ = colormaps["viridis"](0.10 + 0.72 * (rank[line] / max(len(rank) - 1, 1)))
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
                sort=sort_of(plan, first),
            )
        )
    return tuple(bars)


def sort_of(plan: MotionPlan, number: int) -> Sort:
    """Return the kind of a motion, which is given by its number from 0."""
    step = plan.program.steps[plan.motions[number].step]
    assert isinstance(step, Motion)
    if not step.leads_frame:
        return "joints"
    speed = step.timing.speed
    return "process" if speed is not None and speed.length is not None else "led"
