"""How near two bodies come on a piece of a motion, by a plane between them: sharper than distances where they pass along each other.

A plane that stands still against the first body, with the normal n, has the bodies apart by h(t) = min n.b(t) - max n.a over their points. Each n.b(t)
has a second derivative of at most K, so between two times it isn't below the straight line between its values by more than K d^2 / 8, and
neither is the least of them. What a motion does along the plane costs nothing, so that grazing bodies need few pieces: their number grows
with the root of how near they come, not with its inverse. Any normal gives a bound; a good one a good bound.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.placing import Placed, Relative, relative
from yarclang.shapes import Array


def support(scene: Scene, body: Rows, direction: Array) -> Array:
    """How far bodies (R,) reach from the middles of their boxes in unit directions (R, 3), in the bodies' own axes [m]."""
    reach: Array = np.einsum("ri,ri->r", np.abs(direction), scene.boxes.core[body])
    reach = (
        reach + scene.boxes.radius[body] + scene.boxes.disc[body] * np.hypot(direction[:, 0], direction[:, 1])
    )
    for one in scene.boxes.cornered:
        (rows,) = np.nonzero(body == one)
        corners = scene.bodies[one].geometry.corners
        assert corners is not None  # as it is among the cornered
        if len(rows):
            reach[rows] = (corners @ direction[rows].T).max(axis=0)
    return reach


def plane_gap(scene: Scene, pair: Rows, seen: Relative, normal: Array) -> Array:
    """How far planes with unit normals (R, 3), seen from the first bodies, hold the pairs apart [m]; below zero where they cut."""
    along = np.einsum("ri,ri->r", seen.middle, normal)
    turned = -(normal[:, None, :] @ seen.turn)[:, 0]
    first, second = scene.pairs.first[pair], scene.pairs.second[pair]
    gap: Array = along - support(scene, first, normal) - support(scene, second, turned)
    return gap


def least_gap(
    scene: Scene, arms: tuple[Placed, Placed, Placed], at: Rows, pair: Rows, normal: Array, slack: Array
) -> Array:
    """A lower bound (R,) of the distances of pairs on pieces [m].

    Args:
        scene: bodies and pairs.
        arms: at the begins, in the middles and at the ends of P pieces.
        at: (R,) the piece of each pair.
        pair: (R,) which pair.
        normal: (R, 3) of its plane, seen from the first body.
        slack: (R,) what the gap is below the straight lines between these times at most.
    """
    gaps = [plane_gap(scene, pair, relative(placed, at, pair), normal) for placed in arms]
    least: Array = np.minimum.reduce(gaps) - slack
    return least


ROUNDING = 1e-12
"""More than rounding can make a plane's gap too large [m]: some thirty operations on lengths of up to 10 m."""
POOR = 1e-6
"""A plane that shows less than a proposed distance by more than this [m] is turned."""
_TURNS = 60


def proved_gaps(scene: Scene, pair: Rows, seen: Relative, normal: Array, gap: Array) -> Array:
    """Return distances (R,) that planes prove [m], where they were only proposed.

    A plane with any normal has each of both bodies on one side, by the bodies' supports: their distance isn't less than its gap. So neither an error of who proposes a distance nor one of who
    proposes a normal makes the result too large. Planes that show too little are turned towards the nearest points of both bodies. Bodies that overlap, and meshes that aren't their hulls, keep the
    proposed distance.

    Args:
        scene: bodies and pairs.
        pair: (R,).
        seen: how the bodies of each stand to each other.
        normal: (R, 3) proposed, seen from the first body; it is replaced by the normals of the planes.
        gap: (R,) proposed.
    """
    proved = gap.copy()
    hollow = scene.boxes.hollow[scene.pairs.first[pair]] | scene.boxes.hollow[scene.pairs.second[pair]]
    (rows,) = np.nonzero((gap > 0.0) & ~hollow)
    if not len(rows):
        return proved
    pair, seen, wanted = pair[rows], seen.take(rows), gap[rows]
    along = _directions(normal[rows], seen.middle)
    found = plane_gap(scene, pair, seen, along)
    (poor,) = np.nonzero(found < wanted - POOR)
    if len(poor):
        turned, better = _turned(scene, pair[poor], seen.take(poor), along[poor])
        more = better > found[poor]
        found[poor[more]], along[poor[more]] = better[more], turned[more]
    proved[rows], normal[rows] = np.minimum(wanted, found) - ROUNDING, along
    return proved


def _directions(normal: Array, middle: Array) -> Array:
    """Return unit vectors (R, 3) of proposed normals, or, where these have no direction, from one body's middle to the other's."""
    length = np.sqrt(np.einsum("ri,ri->r", normal, normal))
    is_good = np.isfinite(length) & (np.abs(length - 1.0) < 0.5)
    other = np.where(np.abs(middle).max(axis=1, keepdims=True) > 0.0, middle, np.array([1.0, 0.0, 0.0]))
    chosen = np.where(is_good[:, None], normal, other)
    unit: Array = chosen / np.sqrt(np.einsum("ri,ri->r", chosen, chosen))[:, None]
    return unit


def _turned(scene: Scene, pair: Rows, seen: Relative, normal: Array) -> tuple[Array, Array]:
    """Turn planes so that they hold pairs apart by more: the normals (R, 3) and gaps (R,) of the best ones.

    Gilbert's algorithm: the difference of both bodies is convex; from a point of it towards the one that is nearest to the origin against that direction, as far as it helps.
    """
    best, gap = normal.copy(), plane_gap(scene, pair, seen, normal)
    at = _difference(scene, pair, seen, normal)
    for _ in range(_TURNS):
        length = np.sqrt(np.einsum("ri,ri->r", at, at))
        if not (length > 0.0).all():
            break
        along = at / length[:, None]
        now = plane_gap(scene, pair, seen, along)
        more = now > gap
        best[more], gap[more] = along[more], now[more]
        step = _difference(scene, pair, seen, along) - at
        square = np.einsum("ri,ri->r", step, step)
        share = np.clip(-np.einsum("ri,ri->r", at, step) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
        at = at + share[:, None] * step
    return best, gap


def _difference(scene: Scene, pair: Rows, seen: Relative, direction: Array) -> Array:
    """Return the point (R, 3) of the second body minus one of the first, seen from the first, that lies least far in a direction."""
    first, second = scene.pairs.first[pair], scene.pairs.second[pair]
    own = (direction[:, None, :] @ seen.turn)[:, 0]
    there = (seen.turn @ _farthest(scene, second, -own)[:, :, None])[:, :, 0] + seen.middle
    difference: Array = there - _farthest(scene, first, direction)
    return difference


def _farthest(scene: Scene, body: Rows, direction: Array) -> Array:
    """Return a point (R, 3) of each body, seen from the middle of its box, that lies farthest in a unit direction (R, 3) in the body's own axes."""
    points: Array = (
        np.copysign(scene.boxes.core[body], direction) + scene.boxes.radius[body][:, None] * direction
    )
    flat = np.hypot(direction[:, 0], direction[:, 1])
    aside = direction[:, :2] / np.where(flat > 0.0, flat, 1.0)[:, None]
    points[:, :2] += scene.boxes.disc[body][:, None] * aside
    for one in scene.boxes.cornered:
        (rows,) = np.nonzero(body == one)
        corners = scene.bodies[one].geometry.corners
        assert corners is not None  # as it is among the cornered
        if len(rows):
            points[rows] = corners[np.argmax(corners @ direction[rows].T, axis=0)]
    return points
