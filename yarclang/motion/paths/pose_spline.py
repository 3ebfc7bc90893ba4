"""Define a smooth curve of the moving frame through waypoints, in position and orientation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import TURN_CHORD, Array
from yarclang.motion.natural import NaturalSpline
from yarclang.motion.rotation import HALF_TURN
from yarclang.progress import go_on

SAME_PLACE = 1e-6
"""Chord up to which two poses count as equal [m]. A robot that has moved to the first waypoint stands there
only up to rounding.
"""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_GAUSS_NODES, _GAUSS_WEIGHTS = (_NODES + 1.0) / 2.0, _WEIGHTS / 2.0
_FEWEST, _PIECES = 8, 1024
"""Smallest and largest number of pieces into which a leg is divided to measure its length."""

_EACH_BEND = 64.0
"""Factor in the number of pieces of a leg: the number is `_EACH_BEND` times the change of velocity on the
leg, divided by the least speed on it.

The place s as a function of the length is then exact to 1e-8 of the leg.
"""

_IN_ALL, _MOST_IN_ALL = 16_384, 4_194_304
"""Approximate smallest and largest number of pieces of a whole curve.

A curve with few legs may have fewer pieces, since each leg has at most `_PIECES`. The largest number holds
however sharp the bends are.
"""

_AT_ONCE = 16_384
"""Number of places whose speeds are computed between two checks for cancellation. Computing them takes about
5 ms, and their arrays fit in the processor's cache.
"""


@dataclass(frozen=True)
class PoseSpline:
    """A smooth curve of the moving frame: natural cubic splines of position and of orientation. Their
    parameter is proportional to the chord length, from 0 to 1.

    `positions` (d = 3) are in m, `turns` (d = 4) are quaternions (x y z w). Quaternions between waypoints
    aren't normalised yet.
    """

    positions: NaturalSpline
    turns: NaturalSpline

    @cached_property
    def length(self) -> float:
        """The distance that the frame's origin travels [m]."""
        return float(self._lengths[-1])

    @cached_property
    def angle(self) -> float:
        """The angle by which the frame turns along the whole curve [rad]."""
        u = self._fine
        middles = (u[1:] + u[:-1]) / 2.0
        rates = np.empty(len(middles))
        for part in _parts(len(middles), _AT_ONCE):
            rates[part] = np.linalg.norm(self.tangents(middles[part])[:, 3:], axis=1)
        return float(rates @ np.diff(u))

    @property
    def legs(self) -> int:
        """The number of legs between waypoints."""
        return len(self.positions.knots) - 1

    def poses(self, s: Array) -> Array:
        """Return base_from_moving (N, 4, 4) at `s` (N,)."""
        quaternions = self.turns.at(s)
        poses = np.zeros((len(s), 4, 4))
        poses[:, :3, :3] = rotations(quaternions / np.linalg.norm(quaternions, axis=1)[:, None])
        poses[:, :3, 3] = self.positions.at(s)
        poses[:, 3, 3] = 1.0
        return poses

    def tangents(self, s: Array) -> Array:
        """Return the derivatives of the frame's pose with respect to s (N, 6); see `FramePath.tangents`."""
        q, rate = self.turns.at(s), self.turns.slope_at(s)
        vector, real = q[:, :3], q[:, 3:]
        # omega = 2 q' conj(q) / |q|². Its real part is the change of the norm, which causes no rotation.
        spin = rate[:, :3] * real - rate[:, 3:] * vector - np.cross(rate[:, :3], vector)
        omega = 2.0 * spin / np.einsum("ni,ni->n", q, q)[:, None]
        return np.concatenate((self.positions.slope_at(s), omega), axis=1)

    def at_length(self, share: Array) -> Array:
        """Return the places s (N,) at which the frame's origin has covered the given shares (N,) of the
        path's length.
        """
        u, lengths = self._fine, self._lengths
        wanted = np.clip(share, 0.0, 1.0) * lengths[-1]
        piece = np.clip(np.searchsorted(lengths, wanted, side="right") - 1, 0, len(u) - 2)
        width = lengths[piece + 1] - lengths[piece]
        r = (wanted - lengths[piece]) / width
        # Interpolate s as a function of the length by cubic Hermite polynomials. The pieces are so short that
        # this is practically exact.
        first, last = 1.0 / self._edge_speeds[piece], 1.0 / self._edge_speeds[piece + 1]
        s = (
            u[piece] * (1.0 + 2.0 * r) * (1.0 - r) ** 2
            + u[piece + 1] * r**2 * (3.0 - 2.0 * r)
            + width * r * (1.0 - r) * (first * (1.0 - r) - last * r)
        )
        places: Array = np.clip(s, 0.0, 1.0)
        return places

    @cached_property
    def slowest(self) -> float:
        """The least derivative of the frame's position with respect to s [m], at the places `_fine`."""
        return float(self._edge_speeds.min())

    @cached_property
    def _pieces(self) -> NDArray[np.int64]:
        """The number of pieces into which each leg is divided to measure its length, (w - 1,); a power of
        two.

        A leg on which the velocity changes more has more pieces.
        """
        spline = self.positions
        width, ends = np.diff(spline.knots), np.linalg.norm(spline.bends, axis=1)
        least = np.full(len(width), np.inf)
        for share in np.linspace(0.0, 1.0, 9):
            s = spline.knots[:-1] + width * share
            least = np.minimum(
                least, np.linalg.norm(spline.slope_on(np.arange(len(s)), s[:, None])[:, 0], axis=1)
            )
        # y'' is linear on a leg, so the velocity changes by at most the width times the larger |y''| of both
        # ends.
        change = width * np.maximum(ends[1:], ends[:-1])
        need = np.divide(_EACH_BEND * change, least, out=np.full(len(width), np.inf), where=least > 0.0)
        need = np.clip(need, max(_FEWEST, _IN_ALL // len(width)), max(_FEWEST, _MOST_IN_ALL // len(width)))
        pieces: NDArray[np.int64] = 2 ** np.ceil(np.log2(np.minimum(need, _PIECES))).astype(np.int64)
        return pieces

    @cached_property
    def _legs(self) -> NDArray[np.intp]:
        """The index of the leg to which each piece belongs, (P,)."""
        return np.repeat(np.arange(self.legs), self._pieces)

    @cached_property
    def _fine(self) -> Array:
        """The places s (P + 1,) at the ends of the pieces."""
        knots, pieces, leg = self.positions.knots, self._pieces, self._legs
        # Number of each piece within its leg.
        number = np.arange(len(leg)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        return np.append(knots[:-1][leg] + np.diff(knots)[leg] * (number / pieces[leg]), 1.0)

    @cached_property
    def _edge_speeds(self) -> Array:
        """The derivative of the frame's position with respect to s at the places `_fine`, as a length (P +
        1,) [m].
        """
        leg = np.append(self._legs, self.legs - 1)
        speeds = np.empty(len(leg))
        for part in _parts(len(leg), _AT_ONCE):
            speeds[part] = self._speeds(leg[part], self._fine[part, None])[:, 0]
        return speeds

    @cached_property
    def _lengths(self) -> Array:
        """The distance that the frame's origin has covered at the places `_fine`, (P + 1,) [m]. It is
        integrated by Gauss-Legendre quadrature.
        """
        u, leg = self._fine, self._legs
        pieces = np.empty(len(leg))
        for part in _parts(len(leg), _AT_ONCE // len(_GAUSS_NODES)):
            begin = u[:-1][part]
            width = u[1:][part] - begin
            pieces[part] = width * (
                self._speeds(leg[part], begin[:, None] + width[:, None] * _GAUSS_NODES) @ _GAUSS_WEIGHTS
            )
        return np.concatenate(([0.0], np.cumsum(pieces)))

    def _speeds(self, leg: NDArray[np.intp], s: Array) -> Array:
        """Return the derivative of the frame's position with respect to s, as a length [m], at places `s` (N,
        k) on legs `leg` (N,).
        """
        speeds: Array = np.linalg.norm(self.positions.slope_on(leg, s), axis=2)
        return speeds


def _parts(count: int, size: int) -> Iterator[slice]:
    """Yield slices that cover `count` rows, `size` at a time."""
    for begin in range(0, count, size):
        go_on()
        yield slice(begin, begin + size)


@frozen(eq=False)
class AtConstantSpeed:
    """A spline of poses whose parameter is the completed share of its length: the frame's origin has constant
    speed.
    """

    spline: PoseSpline

    @property
    def length(self) -> float:
        """The distance that the frame's origin travels [m]."""
        return self.spline.length

    @property
    def angle(self) -> float:
        """The angle by which the frame turns [rad]."""
        return self.spline.angle

    @property
    def legs(self) -> int:
        """The number of legs between waypoints."""
        return self.spline.legs

    def poses(self, s: Array) -> Array:
        """Return the poses base_from_moving (N, 4, 4) at the shares `s` (N,) of the spline's length."""
        return self.spline.poses(self.spline.at_length(s))

    def tangents(self, s: Array) -> Array:
        """Return the derivatives of the frame's pose with respect to the share of the spline's length (N,
        6).
        """
        slopes = self.spline.tangents(self.spline.at_length(s))
        # Chain rule: ds / dshare = length / |p'(s)|.
        along: Array = slopes * (self.length / np.linalg.norm(slopes[:, :3], axis=1))[:, None]
        return along


def through_poses(poses: Array) -> PoseSpline | int | None:
    """Return the smooth curve through `poses` (w, 4, 4); None if all are equal.

    Equal neighbours count as one pose. If two neighbours differ by 180 deg, the direction of rotation is
    ambiguous, and the index of the later one is returned.
    """
    quaternions = unit_quaternions(poses[:, :3, :3])
    # q and -q are the same rotation: take the sign that is nearer to the quaternion before.
    signs = np.where(np.einsum("ni,ni->n", quaternions[1:], quaternions[:-1]) < 0.0, -1.0, 1.0)
    quaternions[1:] *= np.cumprod(signs)[:, None]
    keep = np.arange(len(poses))
    angles, chords = _chords(poses[:, :3, 3], quaternions)
    while (chords <= SAME_PLACE).any():
        keep = keep[np.append(True, chords > SAME_PLACE)]
        angles, chords = _chords(poses[keep, :3, 3], quaternions[keep])
    if (angles > HALF_TURN).any():
        return int(keep[np.argmax(angles > HALF_TURN) + 1])
    if len(keep) == 1:
        return None
    knots = np.concatenate(([0.0], np.cumsum(chords)))
    knots /= knots[-1]
    knots[-1] = 1.0
    return PoseSpline(
        NaturalSpline.through(knots, poses[keep, :3, 3]), NaturalSpline.through(knots, quaternions[keep])
    )


def _chords(positions: Array, quaternions: Array) -> tuple[Array, Array]:
    """Return the angles [rad] between neighbouring poses, and the chords [m] between them, (N - 1,) each.

    Args:
        positions: (N, 3) positions [m].
        quaternions: (N, 4) unit quaternions.
    """
    apart = np.linalg.norm(np.diff(quaternions, axis=0), axis=1)
    # The distance of two unit quaternions is 2 sin(angle / 4).
    angles: Array = 4.0 * np.arcsin(np.minimum(apart / 2.0, 1.0))
    # A rotation counts as the length `TURN_CHORD` per radian, so that the chord of a pure rotation isn't
    # zero.
    chords: Array = np.hypot(np.linalg.norm(np.diff(positions, axis=0), axis=1), TURN_CHORD * angles)
    return angles, chords


def unit_quaternions(rotations: Array) -> Array:
    """Return rotations (N, 3, 3) as unit quaternions x y z w (N, 4); their signs are arbitrary."""
    r = rotations
    trace = np.trace(r, axis1=1, axis2=2)
    # Each row has the products of one component with all components, times four. Normalise the row of the
    # largest component, which is the most accurate one.
    table = np.empty((len(r), 4, 4))
    for i in range(3):
        table[:, i, i] = 1.0 + 2.0 * r[:, i, i] - trace
    table[:, 3, 3] = 1.0 + trace
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        table[:, i, j] = table[:, j, i] = r[:, i, j] + r[:, j, i]
        table[:, k, 3] = table[:, 3, k] = r[:, j, i] - r[:, i, j]
    largest = np.argmax(np.einsum("nii->ni", table), axis=1)
    rows = table[np.arange(len(r)), largest]
    unit: Array = rows / np.linalg.norm(rows, axis=1)[:, None]
    return unit


def rotations(quaternions: Array) -> Array:
    """Return rotation matrices (N, 3, 3) for unit quaternions x y z w (N, 4)."""
    x, y, z, w = quaternions.T
    # The rotation matrix of a unit quaternion: I + 2 w [v]x + 2 [v]x^2.
    matrix = np.empty((len(quaternions), 3, 3))
    matrix[:, 0] = np.stack((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)), axis=1)
    matrix[:, 1] = np.stack((2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)), axis=1)
    matrix[:, 2] = np.stack((2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)), axis=1)
    return matrix
