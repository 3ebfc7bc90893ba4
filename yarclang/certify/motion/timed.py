"""Deviation of all joints from a timetable, compared at equal times.

The timetable defines a polynomial in time between two rows, and each segment of the controller text is a
polynomial too. On an interval without a row or a knot inside, their difference is therefore a polynomial, and
its Bezier points bound it; nothing is sampled. If the bound exceeds the allowed deviation, the interval is
halved, which makes the bound sharper. It is not halved if the difference itself exceeds the allowed deviation
at an end of the interval.
"""

from __future__ import annotations

import numpy as np

from yarclang import hir
from yarclang.certify.certificate import Deviation
from yarclang.certify.judged import Judged
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.joint import by_kind
from yarclang.certify.read.layout import Layout, Place
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Robot, Tolerance

LATE = 1e-3
"""Largest difference between the durations of the controller text's motion and of the timetable [s].

The judge scales all times of the timetable to the duration in the text.
"""

HALVINGS = 8
"""Largest number of times that an interval is halved."""

_SAME = 1e-9
"""Excess over the allowed deviation that counts as rounding [rad or m]."""


@frozen(eq=False)
class Way:
    """The motion that a timetable defines.

    Attributes:
        times: (m + 1,) times of the rows, from 0 [s].
        bezier: (m, d + 1, n) Bezier points of the polynomial from each row to the next [rad or m].
    """

    times: Array
    bezier: Array


def programmed(table: hir.Timetable, stands: Array) -> Way:
    """Return the motion of a timetable for a robot that is at the joint positions `stands` (n,) [rad or m] at
    first.
    """
    rows = slice(int(table.begins), None)
    times = np.concatenate(([0.0], table.times[rows]))
    q = np.vstack((stands, table.positions[rows]))
    h = np.diff(times)[:, None]
    rest = np.zeros((1, q.shape[1]))
    if table.velocities is None:
        v = _velocities_of_clamped(h[:, 0], q)
    else:
        v = np.vstack((rest, table.velocities[rows]))
    if table.accelerations is None:
        # The two inner Bezier points of a cubic are on the tangents at its ends, a third of the interval
        # away.
        of_cubic = (q[:-1], q[:-1] + v[:-1] * h / 3.0, q[1:] - v[1:] * h / 3.0, q[1:])
        return Way(times, np.stack(of_cubic, axis=1))
    first = table.accelerations[:1] if table.begins else rest
    a = np.vstack((first, table.accelerations[rows]))
    left, right = v[:-1] * h / 5.0, v[1:] * h / 5.0
    # A quintic's first three Bezier points follow from position, velocity and acceleration at the start,
    # where the k-th derivative is 5! / (5 - k)! / h^k times their k-th difference. Likewise at the end.
    of_quintic = (
        q[:-1],
        q[:-1] + left,
        q[:-1] + 2.0 * left + a[:-1] * h**2 / 20.0,
        q[1:] - 2.0 * right + a[1:] * h**2 / 20.0,
        q[1:] - right,
        q[1:],
    )
    return Way(times, np.stack(of_quintic, axis=1))


def _velocities_of_clamped(h: Array, q: Array) -> Array:
    """Return the velocities (m + 1, n) of the C2 cubic spline through `q` that is at rest at both ends.

    The tridiagonal system has the second derivatives as unknowns (the clamped spline); the velocities follow
    from them.
    """
    from scipy.linalg import solve_banded

    # Let h and h' be the durations of neighbouring intervals, and M, M', M'' the second derivatives at their
    # three ends. Then h M + 2 (h + h') M' + h' M'' = 6 (slope' - slope). At both ends of the table, the row
    # contains only one interval, and the outer slope is the given velocity, zero.
    slope = np.diff(q, axis=0) / h[:, None]
    right = 6.0 * np.diff(np.vstack((np.zeros((1, q.shape[1])), slope, np.zeros((1, q.shape[1])))), axis=0)
    band = np.zeros((3, len(q)))
    band[0, 1:], band[2, :-1] = h, h
    band[1, :-1] += 2.0 * h
    band[1, 1:] += 2.0 * h
    bend = solve_banded((1, 1), band, right, check_finite=False)
    v = np.zeros_like(q)
    # At the end of an interval with the mean slope s, and the second derivatives M and M' at its ends, the
    # velocity is s + h (M + 2 M') / 6.
    v[1:] = slope + h[:, None] * (bend[:-1] + 2.0 * bend[1:]) / 6.0
    v[-1] = 0.0
    return v


def largest_difference(cubics: Cubics, way: Way, allowed: Array) -> tuple[Array, Array]:
    """Bound the deviation of the joints from a timetable, compared at equal times.

    Args:
        cubics: the segments of one command.
        way: the motion that the timetable defines; its times are scaled to the duration of the segments.
        allowed: (n,) allowed deviation [rad or m]. Smaller bounds need not be sharp.

    Returns:
        The proved largest deviation of each joint (n,) [rad or m], and the time at which it may occur (n,)
        [s].
    """
    knots = np.concatenate(([0.0], np.cumsum(cubics.h)))
    # Scale the table's times so that its last row falls on the last knot.
    rows = way.times * (knots[-1] / way.times[-1])
    rows[-1] = knots[-1]
    # Form intervals without a knot or a row inside: on each, both motions are single polynomials.
    times = np.unique(np.concatenate((knots, rows)))
    begin, end = times[:-1], times[1:]
    middle = (begin + end) / 2.0
    segment = np.clip(np.searchsorted(knots, middle, side="right") - 1, 0, len(cubics.h) - 1)
    piece = np.clip(np.searchsorted(rows, middle, side="right") - 1, 0, len(way.bezier) - 1)
    # Compute the Bezier points of both motions on each interval.
    executed = _part(_bezier_of(cubics)[segment], *_shares(knots, segment, begin, end))
    asked = _part(way.bezier[piece], *_shares(rows, piece, begin, end))
    go_on()
    # Raise the executed cubics to the degree of the timetable, so that their Bezier points can be subtracted.
    while executed.shape[1] < asked.shape[1]:
        executed = _elevated(executed)
    off = executed - asked
    most, when = np.zeros(off.shape[2]), np.zeros(off.shape[2])
    for _ in range(HALVINGS + 1):
        # A polynomial stays in the convex hull of its Bezier points.
        hull = np.abs(off).max(axis=1)
        # If the curve is too far off at an end of the interval, a sharper bound changes nothing.
        is_beyond = (np.abs(off[:, [0, -1]]) > allowed).any(axis=(1, 2))
        unsettled = (hull > allowed).any(axis=1) & ~is_beyond
        is_last = _ == HALVINGS
        near = hull if is_last else hull[~unsettled]
        if len(near):
            at = np.argmax(near, axis=0)
            bound = near[at, np.arange(near.shape[1])]
            starts = begin if is_last else begin[~unsettled]
            when = np.where(bound > most, starts[at], when)
            most = np.maximum(most, bound)
        if is_last or not unsettled.any():
            break
        left, right = _halves(off[unsettled])
        half = (begin[unsettled] + end[unsettled]) / 2.0
        off = np.concatenate((left, right))
        begin, end = np.concatenate((begin[unsettled], half)), np.concatenate((half, end[unsettled]))
    return most, when


def _shares(borders: Array, number: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    """Return the starts and the ends (N,) of intervals as fractions of the pieces that contain them.

    Args:
        borders: (k + 1,) borders of the pieces [s].
        number: (N,) piece that contains each interval.
        begin: (N,) start of each interval [s].
        end: (N,) end of each interval [s].
    """
    start = borders[number]
    width = borders[number + 1] - start
    return np.clip((begin - start) / width, 0.0, 1.0), np.clip((end - start) / width, 0.0, 1.0)


def _bezier_of(cubics: Cubics) -> Array:
    """Return the Bezier points (N, 4, n) of segments."""
    h = cubics.h[:, None]
    first = cubics.x + cubics.v * h / 3.0
    second = first + cubics.v * h / 3.0 + cubics.a * h**2 / 6.0
    last = cubics.x + h * (cubics.v + h * (cubics.a / 2.0 + h * cubics.j / 6.0))
    return np.stack((cubics.x, first, second, last), axis=1)


def _part(bezier: Array, begin: Array, end: Array) -> Array:
    """Return the Bezier points (N, d + 1, n) of a part of each polynomial, from `begin` to `end` (N,), which
    are fractions of the polynomial's interval.

    The method is de Casteljau's.
    """
    left = bezier.copy()
    u = end[:, None, None]
    for level in range(1, bezier.shape[1]):  # keep the part before `end`
        left[:, level:] = left[:, level - 1 : -1] * (1.0 - u) + left[:, level:] * u
    with np.errstate(invalid="ignore", divide="ignore"):
        u = np.where(end > 0.0, begin / end, 0.0)[:, None, None]
    for level in range(1, bezier.shape[1]):  # then keep the section of this part after `begin`
        left[:, : bezier.shape[1] - level] = (
            left[:, : bezier.shape[1] - level] * (1.0 - u) + left[:, 1 : bezier.shape[1] - level + 1] * u
        )
    return left


def _elevated(bezier: Array) -> Array:
    """Return the Bezier points (N, d + 2, n) of the same polynomials, with the degree raised by one."""
    degree = bezier.shape[1]
    # Degree elevation: the new inner points are convex combinations of neighbours.
    share = (np.arange(1, degree) / degree)[:, None]
    inner = bezier[:, :-1] * share + bezier[:, 1:] * (1.0 - share)
    return np.concatenate((bezier[:, :1], inner, bezier[:, -1:]), axis=1)


def _halves(bezier: Array) -> tuple[Array, Array]:
    """Return the Bezier points of the first and the second half of each polynomial."""
    half, one = np.full(len(bezier), 0.5), np.ones(len(bezier))
    return _part(bezier, np.zeros(len(bezier)), half), _part(bezier, half, one)


def timed_tolerance(motion: hir.TimedMove, robot: Robot) -> Tolerance:
    """Return the tolerance of a timed motion. Its position is the largest allowed deviation (`within`) of the
    prismatic joints [m], its angle that of the revolute joints [rad].
    """
    position, angle = by_kind(motion.within, robot)
    default = robot.tolerance
    return Tolerance(position or default.position, angle or default.angle)


def timed_move(judged: Judged, layout: Layout, row: int, place: Place, start: Array) -> Deviation:
    """Bound the deviation of a motion from its timetable, and report a deviation beyond its tolerance.

    Args:
        judged: the context of the judgement.
        layout: the commands of the text.
        row: row of the motion in the layout.
        place: the motion.
        start: (n,) joint positions at which the timetable begins [rad or m].
    """
    motion, robot = place.motion, judged.robot
    assert isinstance(motion, hir.TimedMove)
    table, within = motion.asked, motion.within
    if table.begins:
        off = np.abs(table.positions[0] - start)
        if (off > within + _SAME).any():
            _report(
                judged,
                place,
                "Y1159",
                "the table begins with {} {:.6g} {} away from the robot's position",
                off,
            )
    way = programmed(table, start)
    end = layout.ends[row]
    off_at_end = np.abs(end - table.positions[-1])
    if place.size:
        off, when = largest_difference(layout.cubics(place.first, place.last), way, within)
    else:
        off, when = np.abs(way.bezier - end).max(axis=(0, 1)), np.zeros(len(start))
    if (off_at_end > within + _SAME).any():
        _report(
            judged,
            place,
            "Y1160",
            "the motion ends with {} {:.6g} {} away from the last row of its table",
            off_at_end,
        )
    elif not (off <= within + _SAME).all():
        joint = int(np.argmax(off / within))
        about = f", about {when[joint]:.6g} s after its start"
        _report(judged, place, "Y1159", "{} is proved only within {:.6g} {} of its timetable" + about, off)
    position, angle = by_kind(off, robot)
    return Deviation(position, angle, *by_kind(off_at_end, robot))


def _report(judged: Judged, place: Place, code: str, form: str, off: Array) -> None:
    """Report the joint that exceeds its allowed deviation most."""
    motion, robot = place.motion, judged.robot
    assert isinstance(motion, hir.TimedMove)
    joint = int(np.argmax(off / motion.within))
    unit, factor = robot.axis_unit_names[joint], robot.axis_units[joint]
    said = form.format(robot.joint_names[joint], off[joint] / factor, unit)
    allowed = f"allowed are {motion.within[joint] / factor:.6g} {unit}"
    judged.find(code, f"{said}; {allowed} (TOL)", place.step)
