"""Compute where bodies are at given joint positions, and the distances of pairs of bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.geometry import encloses
from yarclang.collision.tiles import TiledMesh
from yarclang.frozen import frozen
from yarclang.robot.placements import placements
from yarclang.shapes import Array


@frozen(eq=False)
class Placed:
    """The arm at P joint positions.

    Attributes:
        scene: the bodies.
        turn: (n + 1, P, 3, 3) row k has the rotation of a body that the first k joints move, from its pose
            with all joints at zero.
        shift: (n + 1, P, 3) row k has the translation of this body from its pose with all joints at zero [m].
        middle: (M, P, 3) centers of the bodies' boxes in {B} [m].
    """

    scene: Scene
    turn: Array
    shift: Array
    middle: Array

    def take(self, rows: Rows) -> Placed:
        """Return the arm at some of these joint positions."""
        return Placed(self.scene, self.turn[:, rows], self.shift[:, rows], self.middle[:, rows])


def place(scene: Scene, q: Array) -> Placed:
    """Place the arm at joint positions `q` (P, n) [rad or m]."""
    chain, count = scene.chain, len(q)
    own = chain.kinematics
    pose = placements(chain.screws, q) if own is None else own.placements(chain, q)
    middle = np.empty((len(scene.bodies), 3, count))
    for body, joint in enumerate(scene.boxes.joint):
        if joint == 0:
            middle[body] = scene.boxes.middle[body][:, None]
            continue
        # Compute the rotated center R p for all P positions at once: p times the rows of R, since the
        # position is the last dimension of `pose`.
        np.matmul(scene.boxes.middle[body], pose[joint, :, :3], out=middle[body])
        middle[body] += pose[joint, :, 3]
    return Placed(
        scene,
        pose[:, :, :3].transpose(0, 3, 1, 2),
        pose[:, :, 3].transpose(0, 2, 1),
        middle.transpose(0, 2, 1),
    )


def sphere_gaps(placed: Placed, at: Rows, pair: Rows) -> Array:
    """Return lower bounds (R,) of the distances of pairs [m]: the distances of the spheres around the two
    bodies.

    Args:
        placed: the arm at several joint positions.
        at: (R,) the joint position of each row, as an index.
        pair: (R,) the pair of each row, as an index.
    """
    scene = placed.scene
    one, other = scene.pairs.first[pair], scene.pairs.second[pair]
    apart = placed.middle[one, at] - placed.middle[other, at]
    gaps: Array = (
        np.sqrt(np.einsum("ri,ri->r", apart, apart)) - scene.boxes.bound[one] - scene.boxes.bound[other]
    )
    return gaps


@frozen(eq=False)
class Relative:
    """The pose of the second body of each of R pairs relative to the first, in the axes of the first one's
    box.

    Attributes:
        turn: (R, 3, 3) rotation of the second body's box.
        middle: (R, 3) vector from the center of the first box to that of the second [m].
    """

    turn: Array
    middle: Array

    def take(self, rows: Rows) -> Relative:
        """Return some of the rows, each for one pair of bodies."""
        return Relative(self.turn[rows], self.middle[rows])


def relative(placed: Placed, at: Rows, pair: Rows) -> Relative:
    """Compute the pose of the second body of each pair relative to the first.

    Args:
        placed: the arm at several joint positions.
        at: (R,) the joint position of each row, as an index.
        pair: (R,) the pair of each row, as an index.
    """
    scene = placed.scene
    one, other = scene.pairs.first[pair], scene.pairs.second[pair]
    # With the rotations A of the first box and B of the second in {B}, the second box has the rotation A' B
    # relative to the first. `first` is A'.
    first = (placed.turn[scene.boxes.joint[one], at] @ scene.boxes.rotation[one]).transpose(0, 2, 1)
    second = placed.turn[scene.boxes.joint[other], at] @ scene.boxes.rotation[other]
    apart = placed.middle[other, at] - placed.middle[one, at]
    return Relative(first @ second, (first @ apart[:, :, None])[:, :, 0])


def box_gaps(scene: Scene, pair: Rows, seen: Relative) -> Array:
    """Return lower bounds (R,) of the distances of pairs [m], sharper than those of `sphere_gaps`.

    The distance is measured between the rounded box of one body and an axis-parallel box around the other
    one, in the axes of either body.

    Args:
        scene: the bodies and pairs.
        pair: (R,) the pairs.
        seen: the second body of each pair relative to the first.
    """
    one, other = scene.pairs.first[pair], scene.pairs.second[pair]
    reach = np.abs(seen.turn)
    first, second = scene.boxes.half[one], scene.boxes.half[other]
    # |R| h is half the extent of a turned box along the other box's axes. Beyond both half extents there is a
    # gap on that axis, and the gaps of three axes are components of a lower bound of the distance. Do the
    # same with both boxes exchanged.
    gap = np.abs(seen.middle) - first - (reach @ second[:, :, None])[:, :, 0]
    back = np.abs((seen.middle[:, None, :] @ seen.turn)[:, 0]) - second - (first[:, None, :] @ reach)[:, 0]
    gaps: Array = (
        np.maximum(_outside(gap), _outside(back)) - scene.boxes.radius[one] - scene.boxes.radius[other]
    )
    return gaps


def _outside(gap: Array) -> Array:
    """Return the norms (R,) of the positive parts of vectors (R, 3)."""
    positive = np.maximum(gap, 0.0)
    length: Array = np.sqrt(np.einsum("ri,ri->r", positive, positive))
    return length


_TOUCHING = 1e-6
"""Distance [m] up to which bodies count as overlapping if no penetration depths are computed: coal's result
for an overlap is then not always exactly zero.
"""


def distances(
    scene: Scene, pair: Rows, seen: Relative, *, deep: bool = True, normal: Array | None = None
) -> Array:
    """Compute the distances of pairs of bodies (R,) [m]; zero or less for bodies that overlap.

    Args:
        scene: the bodies and pairs.
        pair: (R,) the pairs.
        seen: the second body of each pair relative to the first.
        deep: True to return minus the depth of penetration for bodies that overlap; for meshes this depth is
            approximate. With False, the computation takes half the time.
        normal: (R, 3) array that receives unit directions from the first to the second body, in the first
            body's axes; or None.
    """
    import coal

    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = deep
    here, there = coal.Transform3s(), coal.Transform3s()
    shapes, own = scene.boxes.solids, scene.boxes.own_middle
    # Origin of the second shape in the frame of the first one; `seen.middle` is between the centers of the
    # boxes, which are at `own` in the shapes' frames.
    origin = (
        seen.middle
        + own[scene.pairs.first[pair]]
        - (seen.turn @ own[scene.pairs.second[pair]][:, :, None])[:, :, 0]
    )
    found = np.empty(len(pair))
    # coal has no batches: call it for each pair and position.
    pairs = zip(scene.pairs.first[pair].tolist(), scene.pairs.second[pair].tolist(), strict=True)
    for row, ((one, other), turn, shift) in enumerate(zip(pairs, seen.turn, origin, strict=True)):
        if isinstance(shapes[one], TiledMesh) or isinstance(shapes[other], TiledMesh):
            found[row], toward = _of_tiles(scene, (one, other), (turn, shift), request)
            if normal is not None:
                normal[row] = toward
            continue
        answer.clear()
        there.setTransform(turn, shift)
        found[row] = coal.distance(shapes[one], here, shapes[other], there, request, answer)
        if normal is not None:
            normal[row] = answer.normal
    if not deep:
        found[np.abs(found) < _TOUCHING] = 0.0
    # coal sees only the surface of a mesh: check if the other body is inside a closed one.
    for one, other, inside in (
        (scene.pairs.first, scene.pairs.second, True),
        (scene.pairs.second, scene.pairs.first, False),
    ):
        if not scene.boxes.closed.any():
            break
        for row in np.flatnonzero(scene.boxes.closed[one[pair]] & (found > 0.0)).tolist():
            turn, shift = seen.turn[row], origin[row]
            skin, point = (scene.bodies[which[pair[row]]].geometry for which in (one, other))
            # The bodies don't touch, so one point decides if the whole body is inside of the closed mesh.
            inner = turn @ point.point + shift if inside else turn.T @ (point.point - shift)
            assert skin.skin is not None  # every closed mesh has a skin
            if (np.abs(inner - skin.middle) <= skin.half).all() and encloses(skin.skin, inner):
                found[row] = -found[row]
    return found


def _of_tiles(
    scene: Scene, bodies: tuple[int, int], seen: tuple[Array, Array], request: Any
) -> tuple[float, Array]:
    """Compute the distance of two bodies [m], one of which is a large mesh in tiles.

    Also return the unit direction (3,) from the first to the second body, in the first body's axes.

    Args:
        scene: the bodies and pairs.
        bodies: the indices of both bodies.
        seen: rotation (3, 3) and origin (3,) [m] of the second body's shape in the first one's frame.
        request: the distance request for the library coal.
    """
    import coal

    turn, shift = seen
    one, other = (scene.bodies[body].geometry for body in bodies)
    if isinstance(one.solid, TiledMesh):
        around = turn @ other.middle + shift, other.bound
        return one.solid.distance(other.of_coal, coal.Transform3s(turn, shift), around, request)
    # The inverse of the pose (R, p) is (R', -R' p).
    back = coal.Transform3s(turn.T.copy(), -turn.T @ shift)
    around = turn.T @ (one.middle - shift), one.bound
    found, toward = other.solid.distance(one.of_coal, back, around, request)
    return found, -(turn @ toward)
