"""Define the path of a timetable. Between two rows of the table, each joint position is a polynomial in
time.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array, Timetable
from yarclang.motion.curve import solve_tridiagonal
from yarclang.transforms import constant

_LOOKED_AT = 8
"""Number of times in each piece at which positions and slopes are sampled."""


@frozen(eq=False)
class TimedPath:
    """The joint positions over time that a timetable prescribes, as polynomials between its rows.

    Attributes:
        times: (m + 1,) the times at which the m polynomials begin, and the end of the last one [s]; the
            first is 0.
        pieces: (m, d, n) the coefficients of each polynomial in powers of the time since its beginning,
            the constant first [rad or m, per s, ...].
        end: (n,) the last position [rad or m].
    """

    times: Array
    pieces: Array
    end: Array

    @property
    def start(self) -> Array:
        """The first position (n,)."""
        start: Array = self.pieces[0, 0]
        return start

    @property
    def duration(self) -> float:
        """The time of the last row [s]."""
        return float(self.times[-1])

    @property
    def is_straight_in_joints(self) -> bool:
        """Always False: a timetable is never assumed to be straight."""
        return False

    @property
    def slope(self) -> Array:
        """The largest absolute derivative of each joint with respect to s, approximately (n,) [rad or m]."""
        slope: Array = np.abs(self.at(self.looked_at, 1)).max(axis=0) * self.duration
        return slope

    @property
    def places(self) -> Array:
        """The times of the rows as shares of the duration, (m + 1,)."""
        places: Array = self.times / self.duration
        return places

    @property
    def looked_at(self) -> Array:
        """Times (N,) [s] at which positions and slopes are sampled, several in each piece."""
        width = np.diff(self.times)[:, None]
        inner = (self.times[:-1, None] + width * np.arange(_LOOKED_AT) / _LOOKED_AT).ravel()
        return np.append(inner, self.times[-1])

    def joints(self, s: Array) -> Array:
        """Return joint positions (N, n) at shares `s` (N,) of the duration."""
        return self.at(s * self.duration)

    def at(self, times: Array, order: int = 0) -> Array:
        """Return joint positions (N, n) at `times` (N,) [s], or their derivatives of the given order.

        After the end the joints are at rest.
        """
        piece = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.pieces) - 1)
        since = (np.clip(times, 0.0, self.duration) - self.times[piece])[:, None]
        coefficients = self.pieces
        for _ in range(order):
            # Differentiate the polynomials: k c_k becomes the coefficient of power k - 1.
            coefficients = coefficients[:, 1:] * np.arange(1, coefficients.shape[1])[:, None]
        # Horner's scheme.
        value: Array = coefficients[piece, -1]
        for power in range(coefficients.shape[1] - 2, -1, -1):
            value = value * since + coefficients[piece, power]
        return value

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Return the largest deviation of the joints from their positions on the path at equal times.

        It is returned twice, as a length [m] and as an angle [rad], since the types of the joints aren't
        known here.
        """
        off = float(np.abs(q - self.joints(s)).max(initial=0.0))
        return off, off

    def extremes(self) -> tuple[Array, Array, Array, Array]:
        """Return the approximate extremes of each joint over time, (n,) each: the least value, its s, the
        largest value, its s.
        """
        times = self.looked_at
        q = self.at(times)
        low, high = np.argmin(q, axis=0), np.argmax(q, axis=0)
        return q.min(axis=0), times[low] / self.duration, q.max(axis=0), times[high] / self.duration


def along(table: Timetable, stands: Array) -> TimedPath:
    """Return the path of a timetable that begins at rest at the robot's position.

    Args:
        table: the rows of the timetable; if it has a row at time 0, only the acceleration of this row is
            used.
        stands: (n,) the robot's position [rad or m].
    """
    begins = int(table.begins)
    times = np.concatenate(([0.0], table.times[begins:]))
    q = np.concatenate((stands[None], table.positions[begins:]))
    rest = np.zeros((1, q.shape[1]))
    if table.velocities is None:
        velocities = _clamped(times, q)
    else:
        velocities = np.concatenate((rest, table.velocities[begins:]))
    accelerations = None
    if table.accelerations is not None:
        first = table.accelerations[:1] if begins else rest
        accelerations = np.concatenate((first, table.accelerations[begins:]))
    pieces = _hermite(np.diff(times)[:, None], q, velocities, accelerations)
    return TimedPath(constant(times), constant(pieces), constant(q[-1]))


def _clamped(times: Array, q: Array) -> Array:
    """Compute the cubic spline through positions `q` (k, n) at `times` (k,) that begins and ends at rest.
    Return its velocities (k, n) at these times.

    The acceleration of this spline is continuous.
    """
    velocities = np.zeros_like(q)
    if len(q) > 2:
        # The acceleration is continuous if v / w + 2 (1 / w + 1 / w') v' + v'' / w' = 3 (rise / w^2 + rise' /
        # w'^2). The unknowns are the velocities v.
        inverse = 1.0 / np.diff(times)
        pull = 3.0 * np.diff(q, axis=0) * inverse[:, None] ** 2
        velocities[1:-1] = solve_tridiagonal(
            2.0 * (inverse[:-1] + inverse[1:]), inverse[1:-1], pull[:-1] + pull[1:]
        )
    return velocities


def _hermite(width: Array, q: Array, v: Array, a: Array | None) -> Array:
    """Return the coefficients (m, d, n) of the polynomials between the rows (m + 1, n) of a timetable, which
    are `width` (m, 1) [s] apart.
    """
    rise = (q[1:] - q[:-1]) / width
    if a is None:
        # Cubic Hermite interpolation in powers of the time.
        bend = (3.0 * rise - 2.0 * v[:-1] - v[1:]) / width
        twist = (v[:-1] + v[1:] - 2.0 * rise) / width**2
        return np.stack((q[:-1], v[:-1], bend, twist), axis=1)
    # Position, velocity and acceleration of the first row determine the powers 0 to 2. Solve for the powers 3
    # to 5, such that they make up the differences `off`, `slower` and `bends` at the second row.
    off = (rise - v[:-1] - a[:-1] * width / 2.0) / width**2
    slower = (v[1:] - v[:-1] - a[:-1] * width) / width**2
    bends = (a[1:] - a[:-1]) / width
    third = 10.0 * off - 4.0 * slower + bends / 2.0
    fourth = (-15.0 * off + 7.0 * slower - bends) / width
    fifth = (6.0 * off - 3.0 * slower + bends / 2.0) / width**2
    return np.stack((q[:-1], v[:-1], a[:-1] / 2.0, third, fourth, fifth), axis=1)
