"""Proof that axes of the flange stay within their allowed angles (KEEP ... UPRIGHT).

The planner uses `yarclang.collision.zones.tilts` instead; this proof shares no code with it, and uses the
judge's own kinematics.

The flange's axis is a unit vector u that turns about the axes of the revolute joints. Its derivatives with
respect to the joints are nested cross products with the unit vectors of these axes, so |u'| is at most W, and
|u''| at most W^2 + A. W and A are the sums of the joints' largest velocities and accelerations on a segment.
Two bounds follow for a piece of duration d. The angle to a fixed direction is at most half of the sum of W d
and the angles at both ends. The cosine of the angle is never more than (W^2 + A) d^2 / 8 below the smaller
one of the cosines at both ends. Pieces are halved until one of the bounds settles them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import Tilt
from yarclang.certify.bodies.fastest import Motions
from yarclang.certify.kinematics.arm import axes_of
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array

SLACK = 1e-5
"""Angle by which an axis may exceed its limit and still count as within it [rad]."""
KNOWN = 0.1
"""If an angle is proved to be below this fraction of its limit, its bound is not made any sharper."""
SHARP = 0.02
"""Fraction by which the bound of an angle may exceed the largest sampled angle."""
MOST = 1_000_000
"""The largest number of pieces. If more are needed, the limit counts as exceeded."""


@frozen(eq=False)
class Tilted:
    """The angle of an axis from its prescribed direction, during each of G motions.

    Attributes:
        most: (G,) upper bounds [rad]; infinite for a motion that exceeds the limit.
        seen: (G,) the largest sampled angle [rad].
        when: (G,) the time of that sample after the start of the first segment [s].
        exceeds: (G,) True for motions that exceed the limit, or aren't proved to keep it.
    """

    most: Array
    seen: Array
    when: Array
    exceeds: NDArray[np.bool_]


def tilted(motions: Motions, tilt: Tilt) -> Tilted:
    """Bound the angle of an axis from its prescribed direction, during each motion.

    Args:
        motions: the segments, and the range of each motion; none is empty.
        tilt: the axis, the direction and the largest angle.
    """
    chain, cubics, spans = motions.chain, motions.cubics, motions.spans
    count = len(spans)
    motion = np.repeat(np.arange(count), np.diff(spans, axis=1)[:, 0])
    # The motions' segments are consecutive.
    first = int(spans[0, 0])
    turns = axes_of(chain).turn
    speed = np.abs(cubics.velocity_peaks()) @ turns
    strength = np.maximum(np.abs(cubics.a), np.abs(cubics.a + cubics.h[:, None] * cubics.j)) @ turns
    # Sum the largest |velocity| (W) and |acceleration| (A) of the revolute joints on each segment.
    bend = strength + speed**2
    axis, up = chain.base_from_flange[:3, :3] @ np.array(tilt.own), np.array(tilt.up)

    def angles(turn: Array) -> Array:
        """Return the angles (P,) of the axis from its direction, for rotations (3, 3, P) of the flange."""
        now = np.tensordot(turn, axis, axes=(1, 0))
        # atan2 of cross and dot product is accurate near 0 and pi, where arccos of the dot product is not.
        cross = (
            now[1] * up[2] - now[2] * up[1],
            now[2] * up[0] - now[0] * up[2],
            now[0] * up[1] - now[1] * up[0],
        )
        dot = now[0] * up[0] + now[1] * up[1] + now[2] * up[2]
        found: Array = np.arctan2(np.sqrt(cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2), dot)
        return found

    segment = np.arange(first, first + len(motion))
    begin, end = np.zeros(len(segment)), cubics.h[segment]
    before, after = (angles(one.turn)[segment] for one in motions.ends(chain.size))
    most, seen = np.zeros(count), np.zeros(count)
    when, exceeds = np.zeros(count), np.zeros(count, np.bool_)

    def learn(rows: NDArray[np.int64], angle: Array, time: Array) -> None:
        """Store the largest sampled angle of each motion, and the time of this sample."""
        # Written in ascending order, so that the largest angle of a motion is written last.
        order = np.argsort(angle, kind="stable")
        owner = motion[rows[order] - first]
        larger = angle[order] > seen[owner]
        seen[owner[larger]] = angle[order][larger]
        when[owner[larger]] = (motions.starts[rows[order]] + time[order])[larger]

    learn(segment, before, begin)
    learn(segment, after, end)
    done = 0
    while len(segment):
        go_on()
        owner, long = motion[segment - first], end - begin
        worst = np.maximum(before, after)
        # Between the ends, the cosine of the angle may be lower than at both ends, but by no more than d^2 /
        # 8 of its second derivative, where d is the duration of the piece.
        chord = np.cos(worst) - bend[segment] * long**2 / 8.0
        bound = np.minimum(
            (before + after + speed[segment] * long) / 2.0, np.arccos(np.clip(chord, -1.0, 1.0))
        )
        exceeds |= ~(seen <= tilt.limit + SLACK / 2.0)
        # A bound is good enough if it is within the limit and also either hardly larger than the largest
        # sample or far below the limit.
        enough = np.minimum(
            tilt.limit + SLACK, np.maximum(seen[owner] * (1.0 + SHARP) + SLACK, tilt.limit * KNOWN)
        )
        # A comparison with NaN is False, so a piece with NaN is never settled.
        settled = (bound <= enough) | exceeds[owner]
        np.maximum.at(most, owner[settled], bound[settled])
        rows = np.flatnonzero(~settled)
        done += len(rows)
        if done > MOST:
            exceeds[owner[rows]] = True
            break
        segment, begin, end = segment[rows], begin[rows], end[rows]
        before, after = before[rows], after[rows]
        # Halve the pieces that aren't settled. The middle is the end of one half and the start of the other.
        half = (begin + end) / 2.0
        middle = angles(motions.at(chain.size, segment, half).turn) if len(rows) else half
        learn(segment, middle, half)
        segment = np.concatenate([segment, segment])
        begin, end = np.concatenate([begin, half]), np.concatenate([half, end])
        before, after = np.concatenate([before, middle]), np.concatenate([middle, after])
    return Tilted(np.where(exceeds, np.inf, most), seen, when, exceeds)
