"""Warnings about programmed speeds that are not reached.

There is one warning for each run of consecutive motions in a chain that don't reach their speed. It names the
slowest of these motions, and the limit that this motion uses up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

from yarclang.certify.certificate import Loads, Quantity, ToolSpeed
from yarclang.certify.read.layout import Layout, Place
from yarclang.diagnostics import Diagnostic, grouped
from yarclang.hir import Origin
from yarclang.written import slower

TOLD = 0.99
"""If a motion reaches more than this fraction of its programmed speed, there is no warning: rounded corners
cost a little speed.
"""

_USED_UP = 0.85
"""A limit counts as the reason if the slowest motion uses at least this fraction of it."""

_KINDS: dict[Quantity, str] = {
    "velocity": "velocity",
    "acceleration": "acceleration",
    "jerk": "jerk",
    "motor_velocity": "motor speed",
}


def slowed(
    layout: Layout,
    speeds: Mapping[int, ToolSpeed | None],
    shares: Callable[[int], float],
    loads: Mapping[int, Loads],
) -> tuple[Diagnostic, ...]:
    """Return a warning for each run of consecutive motions in which a programmed speed is not reached.

    Args:
        layout: the commands of the controller text.
        speeds: proved speeds by step.
        shares: function that returns, for a step, the fraction of its programmed speed that it must reach.
        loads: loads by step: the fractions of the limits that are used.
    """

    def share_of(place: Place) -> float:
        speed = speeds.get(place.step)
        if speed is None or math.isnan(speed.programmed):
            return 1.0
        claimed = shares(place.step)
        # The proved fraction may be larger than the claimed one.
        proved = claimed * speed.least / speed.programmed
        return min(proved, 1.0) if proved > claimed else claimed

    warnings = []
    for stretch in _stretches(layout):
        reached = [share_of(place) for place in stretch]
        first, last = _between_ramps(stretch, reached)
        for begin, end in _regions(reached, first, last):
            at = min(range(begin, end), key=reached.__getitem__)
            place, others = stretch[at], None
            if end - begin > 1:
                others = stretch[begin].motion.origin, stretch[end - 1].motion.origin
            warnings.append(_warning(place.motion.origin, reached[at], others, loads.get(place.step)))
    return grouped(warnings)


def _stretches(layout: Layout) -> Iterator[list[Place]]:
    """Yield the motions of each stretch from rest to rest."""
    stretch: list[Place] = []
    for place in layout.places:
        if not place.size:
            continue
        if stretch and place.before is None:
            yield stretch
            stretch = []
        stretch.append(place)
    if stretch:
        yield stretch


def _between_ramps(stretch: list[Place], shares: list[float]) -> tuple[int, int]:
    """Return the range of motions between the ramps (speeding up, slowing down) of a stretch.

    A ramp counts only if it extends over several motions.
    """
    first, last = 0, len(stretch)
    if max(shares) <= TOLD:
        return first, last
    # A ramp consists of motions without blends whose speeds grow towards the cruise speed.
    while shares[first] <= TOLD and stretch[first].behind == 0 and shares[first + 1] >= shares[first]:
        first += 1
    while shares[last - 1] <= TOLD and stretch[last - 1].before == 0 and shares[last - 2] >= shares[last - 1]:
        last -= 1
    # Slow motions that are not followed (or preceded) by motions at full speed are not a ramp.
    return (first if shares[first] > TOLD else 0), (last if shares[last - 1] > TOLD else len(stretch))


def _regions(shares: list[float], first: int, last: int) -> Iterator[tuple[int, int]]:
    """Yield the ranges of consecutive motions that do not reach their speed."""
    begin = None
    for at in range(first, last):
        if shares[at] <= TOLD:
            begin = at if begin is None else begin
        elif begin is not None:
            yield begin, at
            begin = None
    if begin is not None:
        yield begin, last


def _warning(
    origin: Origin, share: float, others: tuple[Origin, Origin] | None, loads: Loads | None
) -> Diagnostic:
    text, fix = slower(share, origin)
    of_kinds = {} if loads is None else {kind: loads.of(kind) for kind in _KINDS}
    used = {kind: load for kind, load in of_kinds.items() if load.share >= _USED_UP}
    why = ""
    if used:
        kind = max(used, key=lambda one: used[one].share)
        why = f", where {used[kind].name} uses {used[kind].share:.0%} of its limit of {_KINDS[kind]}"
    if others is None:
        message = (
            f"the limits don't allow this speed on this path: the moving frame reaches {share * 100:.3g} % "
            f"of it{why}"
        )
        help_ = f"write {text}, which is reached, or use a longer path, gentler corners or larger blends"
    else:
        first, last = (one.label or one.name for one in others)
        message = (
            f"the limits don't allow this speed from {first} to {last}: the moving frame slows down to "
            f"{share * 100:.3g} % of it here{why}"
        )
        # At another speed the corners are rounded in another way, so this speed isn't certain to be held.
        help_ = f"use gentler corners, larger blends or a larger TOL, or write {text} and check again"
        fix = None
    span = origin.time_span or origin.span
    return Diagnostic("Y0610", message, origin.source, span, help_, fix, origin.place)
