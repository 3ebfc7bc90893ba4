"""The curve of a frame through poses: natural splines of its origin and of a quaternion, which is normalised.

The rotation is R = M / n, with M and n of degree 2 in the quaternion Q: n = |Q|^2, and the Frobenius norm of
M is sqrt 3 n. Bounds of Q and its derivatives give bounds N_k of the derivatives of n, and sqrt 3 N_k of
those of M. By Leibniz' rule for R n = M, the k-th derivative of R is at most G_k = (sqrt 3 N_k + the sum over
j < k of comb(k, j) G_j N_(k-j)) / n.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import chain, pairwise
from math import comb
from typing import Any

from yarclang.verify.arm import Step, Vector, placed
from yarclang.verify.exact import BITS, ONE, PI, SLACK, above, fixed, length, need, sine_and_cosine, times
from yarclang.verify.joints import smooth
from yarclang.verify.paths import OPPOSITE, STILL, State

_SAME = ONE >> 30
"""Largest allowed error of a quaternion's rotation and length, and of the chord of a stated angle: 1e-9."""
_ROOT_OF_3 = above(Fraction(17321, 10000))
_CHORD = 10
"""Weight of rotations in the spline's parameter: a radian counts as 1 / `_CHORD` m."""


class PoseSpline:
    """The curve of a frame from a start through poses, over a parameter from 0 to 1."""

    def __init__(self, start: Step, told: dict[str, Any], proof: dict[str, Any]) -> None:
        poses = [start, *map(placed, told["poses"]), placed(told["pose"])]
        self.goal = poses[-1]
        quaternions = [[fixed(one) for one in q] for q in proof["quaternions"]]
        for (axes, _), q in zip(poses, quaternions, strict=True):
            pairs = zip(_matrix(q, q), chain(*axes), strict=True)
            off = max(length(*(a - b for a, b in pairs)), abs(length(*q) - ONE))
            need(len(q) == 4 and off < _SAME, "a quaternion that isn't a pose's")
        places = [origin for _, origin in poses]
        apart = [length(*(b - a for a, b in zip(one, places[0], strict=True))) for one in places]
        self.group = int(max(apart) < STILL)
        steps = []
        each = zip(pairwise(poses), pairwise(quaternions), proof["turns"], strict=True)
        for ((_, here), (_, then)), (a, b), told_turn in each:
            # A rotation has twice the angle between its quaternions, whose chord is 2 sin(turn / 4).
            turn, chord = fixed(told_turn), length(*(y - x for x, y in zip(a, b, strict=True)))
            need(0 <= turn < PI - OPPOSITE, "a spline of poses with half a turn between neighbours")
            need(abs(chord - 2 * sine_and_cosine(turn // 4)[0]) < _SAME, "another turn between two poses")
            steps.append(length(*(y - x for x, y in zip(here, then, strict=True)), turn // _CHORD))
        self._spline = smooth([[*p, *q] for (_, p), q in zip(poses, quaternions, strict=True)], steps)

    def at(self, s: int) -> State:
        """Return origin and rotation at s, and their derivatives over s."""
        found = self._spline.at(s)
        place, way = ([one[k][0] for one in found] for k in (0, 1))
        q, rate = place[3:], way[3:]
        n = sum(a * a for a in q) >> BITS
        n_rate = 2 * sum(a * b for a, b in zip(q, rate, strict=True)) >> BITS
        columns = [(one << BITS) // n for one in _matrix(q, q)]
        slopes = [
            ((2 * one - (column * n_rate >> BITS)) << BITS) // n
            for one, column in zip(_matrix(q, rate), columns, strict=True)
        ]
        return [(place[:3], way[:3]), (columns, slopes)]

    def bends(self, share: tuple[int, int]) -> Sequence[Sequence[int]]:
        """Return bounds of the derivatives over s of order 2 to 4, and of the third derivative's jumps."""
        orders, jump = list(zip(*self._spline.bends(share), strict=True)), 3
        (second, third, fourth), steep = self._rotation(share)
        return [
            [length(*bound[:3]) for bound in orders],
            [second, third, fourth, times(steep, length(*orders[jump][3:]))],
        ]

    def _rotation(self, share: tuple[int, int]) -> tuple[list[int], int]:
        """Return bounds of the rotation's derivatives 2 to 4 over s, and of its derivative over Q."""
        low, high = share
        found, bends = self._spline.at(low)[3:], self._spline.bends(share)[3:]
        second, third = (length(*(bend[k] for bend in bends)) for k in (0, 1))
        first = length(*(slope for _, (slope,) in found)) + times(second, high - low)
        far = times(first, high - low)
        size = length(*(place for (place,), _ in found))
        large, small = size + far + SLACK, size - far - SLACK
        need(small > ONE >> 2, "a quaternion near 0, or pieces of a spline of poses that are too long")
        q, n = [large, first, second, third, 0], [0] * 5
        for k in range(5):
            n[k] = sum(comb(k, j) * times(q[j], q[k - j]) for j in range(k + 1))
        least, g = times(small, small) - 1, [_ROOT_OF_3]
        for k in range(1, 5):
            most = times(_ROOT_OF_3, n[k]) + sum(comb(k, j) * times(g[j], n[k - j]) for j in range(k))
            g.append((most << BITS) // least + 1)
        return g[2:], 4 * (times(_ROOT_OF_3, large) << BITS) // least + 1


def _matrix(a: Vector, b: Vector) -> Vector:
    """Return the columns of the symmetric bilinear form M with M(q, q) = |q|^2 times the rotation of q."""

    def both(i: int, j: int) -> int:
        return (a[i] * b[j] + a[j] * b[i]) >> BITS

    x, y, z, w = (both(k, k) // 2 for k in range(4))
    xy, xz, yz, xw, yw, zw = (both(i, j) for i, j in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)))
    return [w + x - y - z, xy + zw, xz - yw, xy - zw, w - x + y - z, yz + xw, xz + yw, yz - xw, w - x - y + z]
