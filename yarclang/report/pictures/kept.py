"""Sample the angles and distances that KEEP rules limit over the time of a plan, and draw a row of a picture
for each. This proves nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.report.kept import HeldRule, Quantity, held_rules, measured
from yarclang.report.pictures.style import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEIGHT = 0.6
"""Height of each row, relative to the row of a joint quantity."""
MOST_ROWS = 4
"""Largest number of rows of KEEP rules that are drawn."""

_CURVE_COLOUR = "#3B3B6D"
_LIMIT_COLOUR = "#B2182B"
_SAMPLES = 2000
"""Number of samples of a rule, distributed over the intervals in which it is in force."""
_FEWEST = 12
"""Smallest number of samples of each interval of time in which a rule is in force."""
_LONGEST_TITLE = 70
_LEAST_RANGE = 1.0
"""Smallest upper end of a scale [deg or mm]. With a smaller scale, rounding errors would look like motion."""


@frozen(eq=False)
class KeptRow:
    """An angle or a distance that a KEEP rule limits, over time.

    Attributes:
        title: the rule, and the quantity with its unit.
        times: (N,) never decreasing [s].
        quantity: values of the angle or distance at these times, and its limits.
        begins: (k,) times at which the rule comes into force [s].
        ends: (k,) times at which it ceases to be in force [s].
        breaks: (k,) number of the first sample in each of these intervals.
    """

    title: str
    times: Array
    quantity: Quantity
    begins: Array
    ends: Array
    breaks: NDArray[np.int64]


def kept_rows_of(plan: MotionPlan) -> tuple[KeptRow, ...]:
    """Sample the angles and distances that a plan's KEEP rules limit, while the rules are in force. Return
    one or two rows for each rule.
    """
    return tuple(row for held in held_rules(plan) for row in _rows(plan, held))


def _rows(plan: MotionPlan, held: HeldRule) -> tuple[KeptRow, ...]:
    long = held.ends - held.begins
    share = long / max(float(long.sum()), 1e-9)
    counts = np.maximum((share * _SAMPLES).astype(np.int64), _FEWEST)
    breaks = np.concatenate(([0], np.cumsum(counts + 1)))
    owner = np.repeat(np.arange(len(counts)), counts + 1)
    along = (np.arange(breaks[-1]) - breaks[owner]) / counts[owner]
    times = held.begins[owner] + along * long[owner]
    found = measured(held.keep, plan.robot.chain, plan.sample(times)[0])
    return tuple(KeptRow(_title(held, one), times, one, held.begins, held.ends, breaks[:-1]) for one in found)


def _title(held: HeldRule, quantity: Quantity) -> str:
    rule = printable(held.keep.words)
    if len(rule) > _LONGEST_TITLE:
        rule = rule[: _LONGEST_TITLE - 1] + "…"
    return f"KEEP {rule}: {quantity.name} [{quantity.unit}]"


def draw_kept(axes: Axes, row: KeptRow, factor: float, unit: str, width: float) -> str:
    """Draw an angle or a distance that a rule limits, and its limits; times in units of `factor` [s].

    Returns:
        The values nearest to the limits, in words.
    """
    values, times = row.quantity.values, row.times / factor
    # insert NaN between the intervals in which the rule is in force, to interrupt the curve
    axes.plot(
        np.insert(times, row.breaks[1:], times[row.breaks[1:]]),
        np.insert(values, row.breaks[1:], np.nan),
        color=_CURVE_COLOUR,
        linewidth=width,
        zorder=3,
    )
    limits = [one for one in (row.quantity.least, row.quantity.most) if one is not None]
    for limit in limits:
        axes.hlines(
            np.full(len(row.begins), limit),
            row.begins / factor,
            row.ends / factor,
            colors=_LIMIT_COLOUR,
            linewidths=1.2,
            linestyles=(0, (6, 2)),
            zorder=2,
        )
    low, high = min(0.0, float(values.min()), *limits), max(_LEAST_RANGE, float(values.max()), *limits)
    room = 0.12 * (high - low)
    axes.set_ylim(low - (room if low < 0.0 else 0.0), high + room)
    axes.locator_params(axis="y", nbins=4)
    axes.grid(axis="y", color="0.88", linewidth=0.6)
    axes.margins(x=0)
    found = []
    for name, bound, at in (
        ("least", row.quantity.least, int(np.argmin(values))),
        ("most", row.quantity.most, int(np.argmax(values))),
    ):
        if bound is not None:
            found.append(f"{name}: {values[at]:.4g} {row.quantity.unit}, at {times[at]:.4g} {unit}")
    return " · ".join(found)
