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
    reach: Array = np.einsum("ri,ri->r", np.abs(direction), scene.core[body])
    reach = reach + scene.radius[body] + scene.disc[body] * np.hypot(direction[:, 0], direction[:, 1])
    for one in scene.cornered:
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
    first, second = scene.first[pair], scene.second[pair]
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
