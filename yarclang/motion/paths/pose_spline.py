"""One smooth curve of the moving frame through poses, orientation too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import TURN_CHORD, Array
from yarclang.motion.natural import NaturalSpline
from yarclang.motion.rotation import HALF_TURN
from yarclang.progress import go_on

SAME_PLACE = 1e-12
"""Poses nearer to each other [m and rad together] count once."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_GAUSS_NODES, _GAUSS_WEIGHTS = (_NODES + 1.0) / 2.0, _WEIGHTS / 2.0
_PIECES = 1024
"""Into how many pieces each leg is cut where lengths are measured."""

_AT_ONCE = 16_384
"""Places at which speeds are computed between two looks at whether to go on: some 5 ms, and they stay in the processor's cache."""


@dataclass(frozen=True)
class PoseSpline:
    """Positions [m] and quaternions (x y z w) as natural cubic splines `positions` (d = 3) and `turns` (d = 4) over the
    chord parameter, from 0 to 1. The quaternions have to be normalised.
    """

    positions: NaturalSpline
    turns: NaturalSpline

    @cached_property
    def length(self) -> float:
        """The length of the way of the frame's origin [m]."""
        return float(self._lengths[-1])

    @cached_property
    def angle(self) -> float:
        """The angle that the frame turns by on the way [rad]."""
        u = self._fine
        rates = _in_parts(lambda s: np.linalg.norm(self.tangents(s)[:, 3:], axis=1), (u[1:] + u[:-1]) / 2.0)
        return float(rates @ np.diff(u))

    def poses(self, s: Array) -> Array:
        """base_from_moving (N, 4, 4) at `s` (N,)."""
        quaternions = self.turns.at(s)
        poses = np.zeros((len(s), 4, 4))
        poses[:, :3, :3] = rotations(quaternions / np.linalg.norm(quaternions, axis=1)[:, None])
        poses[:, :3, 3] = self.positions.at(s)
        poses[:, 3, 3] = 1.0
        return poses

    def tangents(self, s: Array) -> Array:
        """Velocities over s (N, 6)."""
        q, rate = self.turns.at(s), self.turns.slope_at(s)
        vector, real = q[:, :3], q[:, 3:]
        # omega = 2 rate conj(q) / |q|^2, whose real part is the norm's change and doesn't turn
        spin = rate[:, :3] * real - rate[:, 3:] * vector - np.cross(rate[:, :3], vector)
        omega = 2.0 * spin / np.einsum("ni,ni->n", q, q)[:, None]
        return np.concatenate((self.positions.slope_at(s), omega), axis=1)

    def at_length(self, share: Array) -> Array:
        """The s (N,) at which so large a share (N,) of the way of the frame's origin lies behind it."""
        u, lengths = self._fine, self._lengths
        wanted = np.clip(share, 0.0, 1.0) * lengths[-1]
        piece = np.clip(np.searchsorted(lengths, wanted, side="right") - 1, 0, len(u) - 2)
        width = lengths[piece + 1] - lengths[piece]
        r = (wanted - lengths[piece]) / width
        # s over the length, with its slopes at both ends of a piece: the pieces are short, and the cubics as good as exact
        slopes = self._slopes
        s = (
            u[piece] * (1.0 + 2.0 * r) * (1.0 - r) ** 2
            + u[piece + 1] * r**2 * (3.0 - 2.0 * r)
            + width * r * (1.0 - r) * (slopes[piece] * (1.0 - r) - slopes[piece + 1] * r)
        )
        places: Array = np.clip(s, 0.0, 1.0)
        return places

    @cached_property
    def slowest(self) -> float:
        """The least speed of the frame's origin over s [m], at the places where lengths are measured."""
        return float(self._speeds(self._fine[:, None]).min())

    @cached_property
    def _fine(self) -> Array:
        knots = self.positions.knots
        shares = np.arange(_PIECES) / _PIECES
        inner = knots[:-1, None] + np.diff(knots)[:, None] * shares
        return np.append(inner.ravel(), 1.0)

    @cached_property
    def _slopes(self) -> Array:
        """How fast s grows over the length, at the places where lengths are measured [1/m]."""
        slopes: Array = 1.0 / self._speeds(self._fine[:, None])[:, 0]
        return slopes

    @cached_property
    def _lengths(self) -> Array:
        u = self._fine
        width = np.diff(u)
        speeds = np.empty((len(width), len(_GAUSS_NODES)))
        for begin in range(0, len(width), _AT_ONCE):
            part = slice(begin, begin + _AT_ONCE)
            speeds[part] = self._speeds(u[:-1][part, None] + width[part, None] * _GAUSS_NODES)
        go_on()
        pieces = width * (speeds @ _GAUSS_WEIGHTS)
        return np.concatenate(([0.0], np.cumsum(pieces)))

    def _speeds(self, s: Array) -> Array:
        """The speed of the frame's origin over s, at `s` (N, k) [m]."""
        speeds = _in_parts(lambda part: np.linalg.norm(self.positions.slope_at(part), axis=1), s.ravel())
        return speeds.reshape(s.shape)


def _in_parts(rates: Callable[[Array], Array], s: Array) -> Array:
    """Return `rates` (N,) at `s` (N,), computed for _AT_ONCE places at a time."""
    found = np.empty(len(s))
    for begin in range(0, len(s), _AT_ONCE):
        go_on()
        found[begin : begin + _AT_ONCE] = rates(s[begin : begin + _AT_ONCE])
    return found


@frozen(eq=False)
class AtConstantSpeed:
    """A spline of poses over the share of its way: the frame's origin goes equally fast everywhere."""

    spline: PoseSpline

    @property
    def length(self) -> float:
        """How far the frame's origin goes [m]."""
        return self.spline.length

    @property
    def angle(self) -> float:
        """How far the frame turns [rad]."""
        return self.spline.angle

    def poses(self, s: Array) -> Array:
        """base_from_moving (N, 4, 4) at the shares `s` (N,) of the way."""
        return self.spline.poses(self.spline.at_length(s))

    def tangents(self, s: Array) -> Array:
        """Velocities over the share of the way (N, 6)."""
        slopes = self.spline.tangents(self.spline.at_length(s))
        along: Array = slopes * (self.length / np.linalg.norm(slopes[:, :3], axis=1))[:, None]
        return along


def through_poses(poses: Array) -> PoseSpline | int | None:
    """The curve through `poses` (w, 4, 4); None where all are equal.

    Equal neighbours count once. Where the turn between two neighbours is half a revolution there is no short way: then the
    number of the later one is returned.
    """
    quaternions = unit_quaternions(poses[:, :3, :3])
    keep = [0]
    chords: list[float] = []
    for number in range(1, len(poses)):
        before = keep[-1]
        cosine = float(quaternions[before] @ quaternions[number])
        if cosine < 0.0:
            quaternions[number] *= -1.0
        apart = float(np.linalg.norm(quaternions[number] - quaternions[before]))
        angle = 4.0 * float(np.arcsin(min(apart / 2.0, 1.0)))
        if angle > HALF_TURN:
            return number
        chord = float(
            np.hypot(np.linalg.norm(poses[number, :3, 3] - poses[before, :3, 3]), TURN_CHORD * angle)
        )
        if chord > SAME_PLACE:
            keep.append(number)
            chords.append(chord)
    if not chords:
        return None
    knots = np.concatenate(([0.0], np.cumsum(chords)))
    knots /= knots[-1]
    knots[-1] = 1.0
    return PoseSpline(
        NaturalSpline.through(knots, poses[keep, :3, 3]), NaturalSpline.through(knots, quaternions[keep])
    )


def unit_quaternions(rotations: Array) -> Array:
    """Unit quaternions x y z w (N, 4) of `rotations` (N, 3, 3); of two signs, one."""
    r = rotations
    trace = np.trace(r, axis1=1, axis2=2)
    # four times the products of each part with all parts: the largest part divides
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
    """Rotations (N, 3, 3) of unit quaternions x y z w (N, 4)."""
    x, y, z, w = quaternions.T
    matrix = np.empty((len(quaternions), 3, 3))
    matrix[:, 0] = np.stack((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)), axis=1)
    matrix[:, 1] = np.stack((2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)), axis=1)
    matrix[:, 2] = np.stack((2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)), axis=1)
    return matrix
