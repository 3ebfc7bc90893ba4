"""Draw the tool straight out of a tight place, along the axes of the moved frame and of the flange, without
rotating it.

A random search seldom finds the way out of a box that is a few millimetres wider than the tool. A straight
line along one of the tool's axes gets out of nearly all places into which people move tools. A second line
may start at the end of the first one or at its middle, to get past the rails of a slot or around a corner.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.room import Room
from yarclang.progress import go_on
from yarclang.robot.kinematics import flange_poses
from yarclang.robot.kinematics.inverse import reached_within
from yarclang.robot.kinematics.numeric import fit
from yarclang.robot.kinematics.within import EDGE, beyond

STEP = 0.005
"""Distance that the tool moves from one checked joint position to the next [m]."""

FARTHEST = 0.4
"""Greatest length of a straight line [m]."""

_LEAST = 4
"""Least number of steps of a line. Shorter lines are dropped, since the tool hardly moves along them."""

_EVERY = 5
"""Every `_EVERY`-th step of a line becomes a waypoint. A search may begin at every `_ROOTS`-th step."""

_ROOTS = 20

_JUMP = 0.15
"""Largest motion of a joint in one step [rad or m]. A larger one means that a singularity is near: the line
ends there.
"""


@frozen(eq=False)
class Retreat:
    """A joint-space path along which the tool leaves a tight place in straight lines.

    `corners` (k, n) are the joint positions along the path [rad or m]; the first is the tight place itself.
    """

    corners: Array


def retreats(room: Room, q: Array, free: Callable[[Array], bool], *, turns: bool) -> list[Retreat]:
    """Return straight-line paths out of a tight place; the path whose end has the most clearance comes first.

    Args:
        room: the surroundings of the arm.
        q: (n,) joint position at the tight place [rad or m]; it is free of collisions.
        free: function that returns True if a joint position is free of collisions.
        turns: True to also try a second line, in another direction, from the middle and from the end of each
            first line.
    """
    own = Retreat(q[None])
    lines = _lines(room, [own], free)
    found = [own, *(one for line in lines for one in _roots(line))]
    if turns:
        begun = [Retreat(line[: at + 1]) for line in lines for at in sorted({len(line) // 2, len(line) - 1})]
        for line in _lines(room, begun, free):
            found += _roots(line)
    return [Retreat(_thinned(one.corners)) for one in _widest(room, found)]


def _widest(room: Room, found: list[Retreat]) -> list[Retreat]:
    """Return the few retreats whose ends have the most clearance. Of two with equal clearance, the shorter
    one is preferred.

    Searches begin only at these ends: from a tight place, nearly all samples would lead into obstacles.
    """
    spare = np.round(room.spare(np.array([one.corners[-1] for one in found]), _OPEN), 3).tolist()
    order = sorted(range(len(found)), key=lambda at: (-spare[at], len(found[at].corners)))
    return [found[at] for at in order[:_MOST]]


_OPEN = 0.1
"""Clearance above which the ends of retreats count as equally free [m]."""

_MOST = 3
"""The largest number of retreats from whose ends a search begins."""


def _roots(line: Array) -> list[Retreat]:
    """Return the initial parts of a line as retreats: one ends at every `_ROOTS`-th step, and the last one is
    the whole line.
    """
    ends = {*range(_ROOTS, len(line) - 1, _ROOTS), len(line) - 1}
    return [Retreat(line[: end + 1]) for end in sorted(ends)]


def _thinned(corners: Array) -> Array:
    kept = {*range(0, len(corners), _EVERY), len(corners) - 1}
    if len(corners) - 2 in kept and len(corners) > _EVERY:  # keep only one of the last two corners
        kept.discard(len(corners) - 2)
    return corners[sorted(kept)]


def _lines(room: Room, begun: list[Retreat], free: Callable[[Array], bool]) -> list[Array]:
    """Extend given retreats by straight lines of the tool in all directions. Return the extended joint-space
    paths (k, n).

    Each line ends where the arm can't reach farther, comes close to a singularity, or meets an obstacle.
    """
    if not begun:
        return []
    chain, limits = room.robot.chain, room.robot.limits
    ends = np.array([one.corners[-1] for one in begun])
    directions = _directions(room)
    poses = np.repeat(flange_poses(chain, ends), len(directions), axis=0)
    # The directions, given in the flange's frame, are converted to {B}.
    way = np.einsum("pij,pj->pi", poses[:, :3, :3], np.tile(directions, (len(ends), 1)))
    here = np.repeat(ends, len(directions), axis=0)
    ways: list[list[Array]] = [[] for _ in way]
    going = np.arange(len(way))
    before = np.zeros_like(here)
    for _ in range(round(FARTHEST / STEP)):
        go_on()
        poses[going, :3, 3] += STEP * way[going]
        # As the first guess, assume that the joints repeat their last step.
        guess = np.clip(here[going] + before[going], limits.lower, limits.upper)
        moved = fit(chain, poses[going], guess, lower=limits.lower, upper=limits.upper, rounds=8)
        good = moved.total < reached_within(chain)
        good &= np.abs(moved.q - here[going]).max(axis=1) < _JUMP
        good &= np.abs(beyond(limits, moved.q)).max(axis=1) <= EDGE
        good[good] = [free(q) for q in moved.q[good]]
        going, q = going[good], moved.q[good]
        before[going] = q - here[going]
        here[going] = q
        for at, one in zip(going.tolist(), q, strict=True):
            ways[at].append(one)
        if not len(going):
            break
    return [
        np.concatenate((begun[at // len(directions)].corners, np.array(line)))
        for at, line in enumerate(ways)
        if len(line) >= _LEAST
    ]


def _directions(room: Room) -> Array:
    """Return the axes of the moved frame and of the flange as unit vectors in the flange's frame, (d, 3).

    Each axis gives two vectors, one in each direction. An axis that is parallel to another is left out.
    """
    axes = [*room.flange_from_moving[:3, :3].T]
    axes += [one for one in np.eye(3) if all(abs(float(one @ other)) < _ALONG for other in axes)]
    return np.array([*axes, *(-one for one in axes)])


_ALONG = 0.999
"""Cosine of the angle between two axes above which they count as parallel."""
