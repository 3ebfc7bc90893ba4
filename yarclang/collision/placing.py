"""Where bodies are at joint positions, and how far pairs of them are apart there."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.geometry import encloses
from yarclang.collision.scene import Rows, Scene
from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import skew
from yarclang.shapes import Array


@frozen(eq=False)
class Placed:
    """The arm at P joint positions: `turn` (n + 1, P, 3, 3) and `shift` (n + 1, P, 3) bring what the first joints move from where it
    is with all joints at zero to where it is; `middle` (M, P, 3) are the middles of the bodies' boxes in {B}.
    """

    scene: Scene
    turn: Array
    shift: Array
    middle: Array

    def take(self, rows: Rows) -> Placed:
        """Some of the joint positions."""
        return Placed(self.scene, self.turn[:, rows], self.shift[:, rows], self.middle[:, rows])


def place(scene: Scene, q: Array) -> Placed:
    """The arm at joint positions `q` (P, n) [rad or m]."""
    count, size = q.shape
    # the positions come last while it is calculated: all steps go along whole rows
    pose = np.zeros((size + 1, 3, 4, count))
    pose[0, [0, 1, 2], [0, 1, 2]] = 1.0
    way = np.ascontiguousarray(q.T)
    sin, versine = np.sin(way), 1.0 - np.cos(way)
    for joint in range(size):
        linear, angular = scene.chain.screws[joint, :3], scene.chain.screws[joint, 3:]
        # exp(screw q) as in `joint_transform`, behind what the joints before do
        w = skew(angular)
        turn, shift = pose[joint, :, :3], pose[joint, :, 3]
        local = np.matmul(np.stack([linear, w @ linear, w @ w @ linear]), turn)
        np.multiply(local[:, 0], way[joint], out=pose[joint + 1, :, 3])
        pose[joint + 1, :, 3] += local[:, 1] * versine[joint]
        pose[joint + 1, :, 3] += local[:, 2] * (way[joint] - sin[joint])
        pose[joint + 1, :, 3] += shift
        turned = np.matmul(np.hstack([w, w @ w]).T, turn)
        np.multiply(turned[:, :3], sin[joint], out=pose[joint + 1, :, :3])
        turned[:, 3:] *= versine[joint]
        pose[joint + 1, :, :3] += turned[:, 3:]
        pose[joint + 1, :, :3] += turn
    middle = np.empty((len(scene.bodies), 3, count))
    for body, joint in enumerate(scene.joint):
        if joint == 0:
            middle[body] = scene.middle[body][:, None]
            continue
        np.matmul(scene.middle[body], pose[joint, :, :3], out=middle[body])
        middle[body] += pose[joint, :, 3]
    return Placed(
        scene,
        pose[:, :, :3].transpose(0, 3, 1, 2),
        pose[:, :, 3].transpose(0, 2, 1),
        middle.transpose(0, 2, 1),
    )


def sphere_gaps(placed: Placed, at: Rows, pair: Rows) -> Array:
    """A lower bound (R,) of the distance of each pair at the joint position `at` (R,): of spheres around both [m]."""
    scene = placed.scene
    one, other = scene.first[pair], scene.second[pair]
    apart = placed.middle[one, at] - placed.middle[other, at]
    gaps: Array = np.sqrt(np.einsum("ri,ri->r", apart, apart)) - scene.bound[one] - scene.bound[other]
    return gaps


@frozen(eq=False)
class Relative:
    """The second body of a pair seen from the first: `turn` (R, 3, 3), and its box's `middle` seen from the first's (R, 3) [m]."""

    turn: Array
    middle: Array

    def take(self, rows: Rows) -> Relative:
        """Some of the rows."""
        return Relative(self.turn[rows], self.middle[rows])


def relative(placed: Placed, at: Rows, pair: Rows) -> Relative:
    """How the bodies of pairs stand to each other at joint positions, (R,) each."""
    scene = placed.scene
    one, other = scene.first[pair], scene.second[pair]
    first = (placed.turn[scene.joint[one], at] @ scene.rotation[one]).transpose(0, 2, 1)
    second = placed.turn[scene.joint[other], at] @ scene.rotation[other]
    apart = placed.middle[other, at] - placed.middle[one, at]
    return Relative(first @ second, (first @ apart[:, :, None])[:, :, 0])


def box_gaps(scene: Scene, pair: Rows, seen: Relative) -> Array:
    """A sharper lower bound (R,): of the rounded boxes, each against the upright box around the other [m]."""
    one, other = scene.first[pair], scene.second[pair]
    reach = np.abs(seen.turn)
    first, second = scene.half[one], scene.half[other]
    gap = np.abs(seen.middle) - first - (reach @ second[:, :, None])[:, :, 0]
    back = np.abs((seen.middle[:, None, :] @ seen.turn)[:, 0]) - second - (first[:, None, :] @ reach)[:, 0]
    gaps: Array = np.maximum(_outside(gap), _outside(back)) - scene.radius[one] - scene.radius[other]
    return gaps


def _outside(gap: Array) -> Array:
    """The length of the parts above zero."""
    positive = np.maximum(gap, 0.0)
    length: Array = np.sqrt(np.einsum("ri,ri->r", positive, positive))
    return length


_TOUCHING = 1e-6
"""Where it isn't asked how deep, coal gives bodies that overlap a distance of up to this [m], and not always zero."""


def distances(
    scene: Scene, pair: Rows, seen: Relative, *, deep: bool = True, normal: Array | None = None
) -> Array:
    """The distances (R,) of pairs [m]; not above zero where the bodies overlap: by how deep, but for meshes only roughly.

    Without `deep` it isn't said how deep, and takes half the time. `normal` (R, 3) is filled with the directions, seen from the first body,
    in which the second one is apart.
    """
    import coal

    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = deep
    here, there = coal.Transform3s(), coal.Transform3s()
    shapes, own = scene.of_coal, scene.own_middle
    origin = seen.middle + own[scene.first[pair]] - (seen.turn @ own[scene.second[pair]][:, :, None])[:, :, 0]
    found = np.empty(len(pair))
    # one call a pair and position: coal has none for many
    pairs = zip(scene.first[pair].tolist(), scene.second[pair].tolist(), strict=True)
    for row, ((one, other), turn, shift) in enumerate(zip(pairs, seen.turn, origin, strict=True)):
        answer.clear()
        there.setTransform(turn, shift)
        found[row] = coal.distance(shapes[one], here, shapes[other], there, request, answer)
        if normal is not None:
            normal[row] = answer.normal
    if not deep:
        found[np.abs(found) < _TOUCHING] = 0.0
    for one, other, inside in ((scene.first, scene.second, True), (scene.second, scene.first, False)):
        if not scene.closed.any():
            break
        for row in np.flatnonzero(scene.closed[one[pair]] & (found > 0.0)).tolist():
            turn, shift = seen.turn[row], origin[row]
            skin, point = (scene.bodies[which[pair[row]]].geometry for which in (one, other))
            inner = turn @ point.point + shift if inside else turn.T @ (point.point - shift)
            assert skin.skin is not None  # as it is closed
            if (np.abs(inner - skin.middle) <= skin.half).all() and encloses(skin.skin, inner):
                found[row] = -found[row]
    return found


BLOCK = 1024
"""Joint positions that are placed together: their arrays stay in the processor's cache."""
TOGETHER = 8
"""So many blocks go to coal together."""


def too_near(scene: Scene, q: Array) -> NDArray[np.bool_]:
    """Whether some pair of bodies is nearer than its margin, or touches, (P,) at joint positions `q` (P, n) [rad or m]."""
    found = np.zeros(len(q), dtype=np.bool_)
    for start in range(0, len(q), TOGETHER * BLOCK):
        found[start : start + TOGETHER * BLOCK] = _too_near(scene, q[start : start + TOGETHER * BLOCK])
    return found


def _too_near(scene: Scene, q: Array) -> NDArray[np.bool_]:
    parts = []
    room = np.empty((2, len(scene.first), 3, 0))
    for start in range(0, len(q), BLOCK):
        placed = place(scene, q[start : start + BLOCK])
        if room.shape[-1] != placed.middle.shape[1]:
            room = np.empty((*room.shape[:-1], placed.middle.shape[1]))
        at, pair = _near_spheres(placed, room)
        seen = relative(placed, at, pair)
        (left,) = np.nonzero(box_gaps(scene, pair, seen) <= scene.margin[pair])
        parts.append((at[left] + start, pair[left], seen.turn[left], seen.middle[left]))
    at, pair, turn, middle = (
        (np.concatenate(part) for part in zip(*parts, strict=True)) if len(parts) > 1 else parts[0]
    )
    near = np.zeros(len(q), dtype=np.bool_)
    # the pairs that meet most often first: a position that is known isn't looked at again
    often = np.bincount(pair, minlength=len(scene.first))
    for one in np.argsort(-often, kind="stable")[: np.count_nonzero(often)].tolist():
        (rows,) = np.nonzero(pair == one)
        rows = rows[~near[at[rows]]]
        gap = distances(scene, pair[rows], Relative(turn[rows], middle[rows]), deep=False)
        near[at[rows[gap <= scene.margin[one]]]] = True
    return near


@frozen(eq=False)
class _Spheres:
    """What tells most pairs apart: of the pairs `still` (S,), whose first body stands still, the `turn` (S, 3, 3) into its box's axes, its
    middle `at` (S, 3, 1) and `half` (S, 3, 1) there, and the squares of how near they count as near, `reach` (S, 1); of the others, `moving` (M,), `wide` (M, 1).
    """

    still: Rows
    moving: Rows
    turn: Array
    at: Array
    half: Array
    reach: Array
    wide: Array


@lru_cache(maxsize=32)
def _spheres(scene: Scene) -> _Spheres:
    """Remembered, as a way round asks again and again for a few positions."""
    still, moving = (np.flatnonzero((scene.joint[scene.first] == 0) == kind) for kind in (True, False))
    reach = scene.bound[scene.second] + scene.margin
    first = scene.first[still]
    turn = np.ascontiguousarray(scene.rotation[first].transpose(0, 2, 1))
    return _Spheres(
        still,
        moving,
        turn,
        turn @ scene.middle[first][:, :, None],
        scene.half[first][:, :, None],
        ((reach[still] + scene.radius[first]) ** 2)[:, None],
        ((reach[moving] + scene.bound[scene.first[moving]]) ** 2)[:, None],
    )


def _near_spheres(placed: Placed, room: Array) -> tuple[Rows, Rows]:
    """The positions and pairs (R,) that spheres don't tell apart: of a sphere and the box of a body that stands still, of two spheres else.

    `room` (2, pairs, 3, P) is overwritten: fresh memory for each block takes longer than the work in it.
    """
    scene, spheres = placed.scene, _spheres(placed.scene)
    middle = placed.middle.transpose(0, 2, 1)  # as it lies in memory
    near = []
    for rows, reach in ((spheres.still, spheres.reach), (spheres.moving, spheres.wide)):
        there, here = room[:, : len(rows)]
        np.take(middle, scene.second[rows], axis=0, out=there, mode="clip")
        if rows is spheres.still:
            np.matmul(spheres.turn, there, out=here)
            here -= spheres.at
            np.abs(here, out=here)
            here -= spheres.half
            np.maximum(here, 0.0, out=here)
        else:
            np.take(middle, scene.first[rows], axis=0, out=here, mode="clip")
            here -= there
        np.square(here, out=here)
        which, where = np.nonzero(np.add.reduce(here, axis=1, out=there[:, 0]) <= reach)
        near.append((where, rows[which]))
    return np.concatenate([part[0] for part in near]), np.concatenate([part[1] for part in near])
