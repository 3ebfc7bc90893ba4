"""Check limits of joints and motors at every instant, exactly: on a segment all quantities are polynomials.

Let c0 to c3 be the control points of a segment of T seconds, and D1, D2, D3 their differences. The jerk is
(D3 - 2 D2 + D1) / T^3. The acceleration is linear from (D2 - D1) / T^2 to (D3 - D2) / T^2. The velocity is
the parabola with the Bezier points (D1 + D2) / 2T, D2 / T, (D2 + D3) / 2T. The position is the cubic with the
Bezier points (c0 + 4 c1 + c2) / 6, (2 c1 + c2) / 3, (c1 + 2 c2) / 3, (c1 + 4 c2 + c3) / 6. Each polynomial
lies within the hull of its Bezier points.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from yarclang.verify.course import Moved
from yarclang.verify.exact import need
from yarclang.verify.reader import PRINTED

_ROUNDED = 1 + Fraction(1, 10**9)
"""Allowed excess of a limit, since numbers of a text are rounded. For ranges it is 1e-9 deg or mm instead."""
_HALVINGS = 12

Shares = dict[str, Fraction]


def check_limits(rows: Sequence[Moved], robot: dict[str, Any], notes: list[str]) -> Shares:
    """Check all segments against the limits of joints and motors; return the largest used share of each
    limit, and add to `notes` the blends in which motions with a jerk limit have none.

    Segments of motions without a jerk limit, and of their blends, are not checked against the jerk limit.
    """
    shares: Shares = dict.fromkeys(("velocity", "acceleration", "jerk", "motor speed"), Fraction(0))
    for number, row in enumerate(rows):
        if row.last == row.first:
            continue
        free_before = row.before is not None and _beside(rows, number, -1)
        free_behind = row.entry.blend is not None and _beside(rows, number, 1)
        if not row.entry.any_jerk:
            for free, blend, side in (
                (free_before, row.before, "first"),
                (free_behind, row.entry.blend, "last"),
            ):
                if free and blend:
                    seconds = float(blend // 2 * row.seconds)
                    notes.append(f"{row.entry.title}: the jerk in its {side} {seconds:.3f} s, in a blend")
        begin = row.first + (free_before and (row.before or 0) // 2)
        stop = row.last - (free_behind and (row.entry.blend or 0) // 2)
        judged = range(0) if row.entry.any_jerk else range(begin, stop)
        _check_row(row, judged, robot, shares)
    return shares


def _beside(rows: Sequence[Moved], number: int, way: int) -> bool:
    """Return True if the next command with moves, in direction `way` (1 or -1), has no jerk limit."""
    number += way
    while not rows[number].control:
        number += way
    return rows[number].entry.any_jerk


def _check_row(row: Moved, judged: range, robot: dict[str, Any], shares: Shares) -> None:
    control, time = row.control[row.first : row.last + 3], row.seconds
    for joint, name in enumerate(robot["joints"]):
        c = [point[joint] for point in control]
        _check_travel(c, robot["lower"][joint], robot["upper"][joint], f"{row.entry.title}: {name}")
        # Compute D1 to D3 of every segment, their differences, and the differences of these.
        steps = [b - a for a, b in pairwise(c)]
        bends = [b - a for a, b in pairwise(steps)]
        jerks = [bends[k - row.first + 1] - bends[k - row.first] for k in judged]
        most = {
            "velocity": Fraction(_fastest(steps), PRINTED) / time,
            "acceleration": Fraction(max(map(abs, bends)), PRINTED) / time**2,
            "jerk": Fraction(max(map(abs, jerks), default=0), PRINTED) / time**3,
        }
        for what, peak in most.items():
            _hold(what, peak / robot[what][joint], f"{row.entry.title}: {name}", shares)
    for motor, counts in zip(robot["motors"], robot["counts"], strict=True):
        # Motor positions are linear in the joints, so they are B-splines with transformed control points.
        turned = [sum(a * b for a, b in zip(counts, point, strict=True)) for point in control]
        fastest = _fastest([b - a for a, b in pairwise(turned)]) / time / PRINTED
        limit = robot["motor_velocity"][robot["motors"].index(motor)]
        _hold("motor speed", fastest / limit, f"{row.entry.title}: motor {motor}", shares)


def _hold(what: str, share: Fraction, who: str, shares: Shares) -> None:
    shares[what] = max(shares[what], share)
    need(share <= _ROUNDED, f"{who}: {what} of {float(share):.6%} of its limit")


def _fastest(steps: Sequence[Any]) -> Fraction:
    """Return the largest |velocity| times T of the segments whose control points have these differences."""
    most = Fraction(0)
    for one, middle, other in zip(steps, steps[1:], steps[2:], strict=False):
        begin, end = Fraction(one + middle) / 2, Fraction(middle + other) / 2
        peak = max(abs(begin), abs(end))
        if (
            abs(middle) > peak
        ):  # then the parabola has an extreme between its ends: (b0 b2 - b1^2) / (b0 - 2 b1 + b2)
            peak = max(peak, abs((begin * end - middle * middle) / (begin - 2 * middle + end)))
        most = max(most, peak)
    return most


def _check_travel(c: Sequence[int], lower: Fraction | None, upper: Fraction | None, who: str) -> None:
    """Check the range of a joint: by control points, then by Bezier points of halved segments."""
    low = None if lower is None else lower * PRINTED - PRINTED // 10**9
    high = None if upper is None else upper * PRINTED + PRINTED // 10**9

    def inside(points: Sequence[Any]) -> bool:
        return (low is None or min(points) >= low) and (high is None or max(points) <= high)

    if inside(c):
        return
    for a, b, e, f in zip(c, c[1:], c[2:], c[3:], strict=False):
        # These are the Bezier points of the segment's cubic.
        pieces: list[tuple[Fraction, ...]] = [
            (
                Fraction(a + 4 * b + e, 6),
                Fraction(2 * b + e, 3),
                Fraction(b + 2 * e, 3),
                Fraction(b + 4 * e + f, 6),
            )
        ]
        for _ in range(_HALVINGS):
            pieces = [half for piece in pieces if not inside(piece) for half in _halves(piece)]
        need(not pieces, f"{who} goes beyond its range, or isn't shown to stay in it")


def _halves(p: tuple[Fraction, ...]) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
    """Cut a cubic in the middle (de Casteljau)."""
    a, b, c = (p[0] + p[1]) / 2, (p[1] + p[2]) / 2, (p[2] + p[3]) / 2
    d, e = (a + b) / 2, (b + c) / 2
    return (p[0], a, d, (d + e) / 2), ((d + e) / 2, e, c, p[3])
