"""Bound the distance of two bodies during a short time of a motion by a plane between them.

This is sharper than a bound from distances if the bodies pass along each other.

A plane that is fixed in the first body, with normal n, separates the bodies a and b by h(t) = min n·b(t) -
max n·a over their points. Each n·b(t) has a second derivative of at most K. Between two times that are d
seconds apart, n·b(t) is therefore at most K d² / 8 below the chord of its values, and so is its minimum over
the points. Motion along the plane doesn't weaken this bound. Grazing bodies therefore need few pieces of the
motion's time: their number grows with the inverse square root of the distance, not with its inverse. Any
normal gives a valid bound; a good one gives a sharp bound.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.placing import Placed, Relative, relative
from yarclang.shapes import Array


def support(scene: Scene, body: Rows, direction: Array) -> Array:
    """Return the support functions of bodies in given directions: the largest d · p (R,) [m] over their
    points p, relative to the centers of their boxes.

    Args:
        scene: the bodies.
        body: (R,) the bodies, as indices.
        direction: (R, 3) unit directions d in the bodies' own axes.
    """
    # The support function of a Minkowski sum is the sum of the support functions of box, ball and disc.
    reach: Array = np.einsum("ri,ri->r", np.abs(direction), scene.boxes.core[body])
    reach = (
        reach + scene.boxes.radius[body] + scene.boxes.disc[body] * np.hypot(direction[:, 0], direction[:, 1])
    )
    for one in scene.boxes.cornered:
        (rows,) = np.nonzero(body == one)
        corners = scene.bodies[one].geometry.corners
        assert corners is not None  # each body in `cornered` has corners
        if len(rows):
            reach[rows] = (corners @ direction[rows].T).max(axis=0)
    return reach


def plane_gap(scene: Scene, pair: Rows, seen: Relative, normal: Array) -> Array:
    """Return the gap between the two bodies of each pair along a plane's normal (R,) [m].

    A gap is negative if no plane with this normal separates the bodies.

    Args:
        scene: the bodies and pairs.
        pair: (R,) the pairs.
        seen: the second body of each pair relative to the first.
        normal: (R, 3) unit normals in the first body's axes.
    """
    # The gap is the distance of the middles along the normal, less what both bodies reach towards each other.
    along = np.einsum("ri,ri->r", seen.middle, normal)
    # The second body reaches towards the first, against the normal: in its own axes this direction is -R' n.
    turned = -(normal[:, None, :] @ seen.turn)[:, 0]
    first, second = scene.pairs.first[pair], scene.pairs.second[pair]
    gap: Array = along - support(scene, first, normal) - support(scene, second, turned)
    return gap


def least_gap(
    scene: Scene, arms: tuple[Placed, Placed, Placed], at: Rows, pair: Rows, normal: Array, slack: Array
) -> Array:
    """Return lower bounds (R,) of the distances of pairs during pieces of a motion's time [m], from
    separating planes.

    Args:
        scene: the bodies and pairs.
        arms: the arm at the beginnings, in the middles and at the ends of P pieces.
        at: (R,) the piece of each row, as an index.
        pair: (R,) the pair of each row, as an index.
        normal: (R, 3) normals of the planes, in the first body's axes.
        slack: (R,) the largest distance by which the gap may be below its chords between these times [m].
    """
    gaps = [plane_gap(scene, pair, relative(placed, at, pair), normal) for placed in arms]
    least: Array = np.minimum.reduce(gaps) - slack
    return least


ROUNDING = 1e-12
"""Upper bound of the rounding in a plane's gap [m]: some thirty operations on lengths of up to 10 m."""
POOR = 1e-6
"""If the gap along a plane's normal is smaller than the computed distance by more than this length [m], the
plane is turned to enlarge the gap.
"""
_TURNS = 60


def proved_gaps(scene: Scene, pair: Rows, seen: Relative, normal: Array, gap: Array) -> Array:
    """Replace computed distances of pairs, which may be inexact, by distances (R,) [m] that planes prove.

    For any normal, the support functions of both bodies give a gap between two parallel planes that separate
    the bodies. The distance of the bodies is no less than this gap. Therefore an error in a given distance or
    normal never makes the result too large. Planes with too small a gap are turned towards the nearest points
    of both bodies. Bodies that overlap, and meshes that aren't their own convex hulls, keep the given
    distance.

    Args:
        scene: the bodies and pairs.
        pair: (R,) the pairs.
        seen: the second body of each pair relative to the first.
        normal: (R, 3) normals to begin with, in the first body's axes; replaced by the normals of the planes.
        gap: (R,) the computed distances [m].
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
    """Return unit vectors (R, 3) along given normals.

    For a normal that isn't a unit vector, the vector leads from the center of the first body to that of the
    second.
    """
    length = np.sqrt(np.einsum("ri,ri->r", normal, normal))
    is_good = np.isfinite(length) & (np.abs(length - 1.0) < 0.5)
    other = np.where(np.abs(middle).max(axis=1, keepdims=True) > 0.0, middle, np.array([1.0, 0.0, 0.0]))
    chosen = np.where(is_good[:, None], normal, other)
    unit: Array = chosen / np.sqrt(np.einsum("ri,ri->r", chosen, chosen))[:, None]
    return unit


def _turned(scene: Scene, pair: Rows, seen: Relative, normal: Array) -> tuple[Array, Array]:
    """Turn planes so that they separate pairs of bodies by more, and return the best normals (R, 3) and gaps
    (R,) [m].

    Gilbert's algorithm (E. G. Gilbert, SIAM Journal on Control 4(1), 1966) works on the Minkowski difference
    of both bodies, which is convex. Each step goes from the current point of the difference towards its
    support point against the current direction, and takes the point of that segment nearest to the origin.

    Args:
        scene: the bodies and pairs.
        pair: (R,) the pairs.
        seen: the second body of each pair relative to the first.
        normal: (R, 3) normals to begin with, in the first body's axes.
    """
    best, gap = normal.copy(), plane_gap(scene, pair, seen, normal)
    at = _difference(scene, pair, seen, normal)
    for _ in range(_TURNS):
        length = np.sqrt(np.einsum("ri,ri->r", at, at))
        if not (length > 0.0).all():
            break
        along = at / length[:, None]
        # The current point is a normal to try: the gap along it is a lower bound of the distance.
        now = plane_gap(scene, pair, seen, along)
        more = now > gap
        best[more], gap[more] = along[more], now[more]
        # Go on to the point nearest to the origin on the segment from `at` to the new support point.
        step = _difference(scene, pair, seen, along) - at
        square = np.einsum("ri,ri->r", step, step)
        share = np.clip(-np.einsum("ri,ri->r", at, step) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
        at = at + share[:, None] * step
    return best, gap


def _difference(scene: Scene, pair: Rows, seen: Relative, direction: Array) -> Array:
    """Return the points (R, 3) of the Minkowski difference, second body minus first, that are farthest
    against given directions.

    The directions (R, 3) and the points are in the first body's axes.
    """
    first, second = scene.pairs.first[pair], scene.pairs.second[pair]
    # Turn the direction into the second body's axes.
    own = (direction[:, None, :] @ seen.turn)[:, 0]
    there = (seen.turn @ _farthest(scene, second, -own)[:, :, None])[:, :, 0] + seen.middle
    difference: Array = there - _farthest(scene, first, direction)
    return difference


def _farthest(scene: Scene, body: Rows, direction: Array) -> Array:
    """Return the point of each body that is farthest in a unit direction, (R, 3) each.

    Points are relative to the center of the body's box, in the body's own axes.
    """
    points: Array = (
        # The farthest point of a Minkowski sum is the sum of the farthest points of box, ball and disc.
        np.copysign(scene.boxes.core[body], direction) + scene.boxes.radius[body][:, None] * direction
    )
    flat = np.hypot(direction[:, 0], direction[:, 1])
    aside = direction[:, :2] / np.where(flat > 0.0, flat, 1.0)[:, None]
    points[:, :2] += scene.boxes.disc[body][:, None] * aside
    for one in scene.boxes.cornered:
        (rows,) = np.nonzero(body == one)
        corners = scene.bodies[one].geometry.corners
        assert corners is not None  # each body in `cornered` has corners
        if len(rows):
            points[rows] = corners[np.argmax(corners @ direction[rows].T, axis=0)]
    return points
