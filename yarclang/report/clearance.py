"""Compute distances between bodies at given joint positions, for display. These are samples; only the
certificate proves distances.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Rows
from yarclang.collision.placing import box_gaps, distances, place, relative
from yarclang.collision.scene import Scene
from yarclang.frozen import frozen
from yarclang.robot.model import Array

SEEN = 0.2
"""Largest distance that is computed exactly [m]. Larger distances are given as this value."""
_BLOCK = 256


@frozen(eq=False)
class Near:
    """Smallest distances between bodies at P joint positions.

    Attributes:
        apart: (P,) smallest distance of two bodies, at most `SEEN` [m].
        pair: (P,) number of the pair of bodies with this distance; -1 if the distance isn't below `SEEN`.
        closest: (P,) smallest difference of a pair's distance and its margin, at most `SEEN` [m].
        worst: (P,) number of the pair with this difference; -1 if the difference isn't below `SEEN`.
    """

    apart: Array
    pair: Rows
    closest: Array
    worst: Rows


def near(scene: Scene, q: Array) -> Near:
    """Return the smallest distances between bodies at joint positions `q` (P, n)."""
    blocks = [_near(scene, q[at : at + _BLOCK]) for at in range(0, len(q), _BLOCK)]
    return Near(
        *(
            np.concatenate([getattr(one, name) for one in blocks])
            for name in ("apart", "pair", "closest", "worst")
        )
    )


def _near(scene: Scene, q: Array) -> Near:
    size, count = len(scene.pairs.first), len(q)
    gap = np.full((count, size), np.inf)
    placed = place(scene, q)
    at, pair = np.repeat(np.arange(count), size), np.tile(np.arange(size), count)
    relative_poses = relative(placed, at, pair)
    bound = box_gaps(scene, pair, relative_poses).reshape(count, size)
    if size:
        # First compute the most promising pair of each position: its distance rules out most other pairs.
        first = np.arange(count) * size + bound.argmin(axis=1)
        rows = first[bound.ravel()[first] < SEEN]
        gap.ravel()[rows] = distances(scene, pair[rows], relative_poses.take(rows))
        least = np.minimum(gap.min(axis=1), SEEN)
        wanted = bound < np.maximum(least[:, None], scene.pairs.margin[None, :])
        rows = np.flatnonzero((wanted & ~np.isfinite(gap)).ravel())
        gap.ravel()[rows] = distances(scene, pair[rows], relative_poses.take(rows))
    return Near(*_least(gap, np.zeros(size)), *_least(gap, scene.pairs.margin))


def _least(gap: Array, margin: Array) -> tuple[Array, Rows]:
    if not gap.shape[1]:
        return np.full(len(gap), SEEN), np.full(len(gap), -1)
    above = gap - margin
    pair = above.argmin(axis=1)
    least = above[np.arange(len(gap)), pair]
    return np.minimum(least, SEEN), np.where(least < SEEN, pair, -1)


def touching(scene: Scene, q: Array) -> frozenset[str]:
    """Return the names of the bodies that are nearer than the margin to another body at joint position `q`
    (n,).
    """
    size = len(scene.pairs.first)
    if not size:
        return frozenset()
    placed, pair = place(scene, q[None]), np.arange(size)
    seen = relative(placed, np.zeros(size, dtype=np.int64), pair)
    rows = np.flatnonzero(box_gaps(scene, pair, seen) <= scene.pairs.margin + 1e-5)
    apart = distances(scene, pair[rows], seen.take(rows))
    close = rows[apart <= scene.pairs.margin[rows] + 1e-5]
    return frozenset(name for one in close.tolist() for name in scene.names(one))
