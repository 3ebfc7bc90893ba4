"""Where bodies are at joint positions, how far pairs of them are apart there, and how far a change of the joints can move them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.geometry import encloses
from yarclang.collision.scene import Rows, Scene
from yarclang.robot.kinematics.fk import skew
from yarclang.shapes import Array


@dataclass(frozen=True, slots=True, eq=False)
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
    turn, shift = np.empty((size + 1, count, 3, 3)), np.empty((size + 1, count, 3))
    turn[0], shift[0] = np.eye(3), 0.0
    sin, versine = np.sin(q), 1.0 - np.cos(q)
    for joint in range(size):
        linear, angular = scene.chain.screws[joint, :3], scene.chain.screws[joint, 3:]
        # exp(screw q) as in `joint_transform`, behind what the joints before do
        w = skew(angular)
        s, c = sin[:, joint, None], versine[:, joint, None]
        local = q[:, joint, None] * linear + c * (w @ linear) + (q[:, joint, None] - s) * (w @ w @ linear)
        turned = turn[joint].reshape(-1, 3) @ np.hstack([w, w @ w])
        turned = turned.reshape(count, 3, 6)
        turn[joint + 1] = turn[joint] + s[:, :, None] * turned[:, :, :3] + c[:, :, None] * turned[:, :, 3:]
        shift[joint + 1] = np.einsum("pij,pj->pi", turn[joint], local) + shift[joint]
    middle = np.empty((len(scene.bodies), count, 3))
    for body, joint in enumerate(scene.joint):
        if joint == 0:
            middle[body] = scene.middle[body]
            continue
        middle[body] = (turn[joint].reshape(-1, 3) @ scene.middle[body]).reshape(count, 3) + shift[joint]
    return Placed(scene, turn, shift, middle)


def travel(placed: Placed, change: Array) -> Array:
    """How far a point of a body moves at most when joints change.

    Moving the joints one after the other, that of the base first, each turns the body by a circle around its axis whose radius is
    what it is now: the joints before it have moved axis and body together. So no posture between counts.

    Args:
        placed: the arm at P joint positions.
        change: (P, n) how far each joint moves from there at most [rad or m].

    Returns:
        (n + 1, M, P) [m]: against what only the first joints move.
    """
    arms = arm_lengths(placed)
    steps = np.zeros((len(arms) + 1, *arms.shape[1:]))
    np.multiply(arms, change.T[:, None, :], out=steps[:-1])
    against: Array = np.cumsum(steps[::-1], axis=0)[::-1]
    return against


def arm_lengths(placed: Placed) -> Array:
    """How far a point of a body is from the axis of a joint at most, (n, M, P) [m]; 1 of a joint that slides, 0 of one that doesn't move the body."""
    scene, chain = placed.scene, placed.scene.chain
    bodies, count = placed.middle.shape[:2]
    arms = np.zeros((chain.size, bodies, count))
    for joint in range(chain.size):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        (moved,) = np.nonzero(scene.joint > joint)
        if not angular.any():
            arms[joint, moved] = np.linalg.norm(linear)
            continue
        turn, shift = placed.turn[joint], placed.shift[joint]
        rate = float(np.linalg.norm(angular))
        axis = turn @ (angular / rate)
        point = turn @ (np.cross(angular, linear) / rate**2) + shift
        arm = placed.middle[moved] - point
        away = np.cross(arm, axis)
        radius = np.sqrt(np.einsum("bpi,bpi->bp", away, away)) + scene.bound[moved, None]
        # a screw of some pitch slides as well
        slide = abs(float(angular @ linear)) / rate
        arms[joint, moved] = np.hypot(radius * rate, slide)
    return arms


def sphere_gaps(placed: Placed, at: Rows, pair: Rows) -> Array:
    """A lower bound (R,) of the distance of each pair at the joint position `at` (R,): of spheres around both [m]."""
    scene = placed.scene
    one, other = scene.first[pair], scene.second[pair]
    apart = placed.middle[one, at] - placed.middle[other, at]
    gaps: Array = np.sqrt(np.einsum("ri,ri->r", apart, apart)) - scene.bound[one] - scene.bound[other]
    return gaps


@dataclass(frozen=True, slots=True, eq=False)
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
    shapes = [body.geometry.of_coal for body in scene.bodies]
    own = np.array([body.geometry.middle for body in scene.bodies])
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
    for one, other, inside in ((scene.first, scene.second, True), (scene.second, scene.first, False)):
        closed = np.array([body.geometry.skin is not None for body in scene.bodies], dtype=np.bool_)
        for row in np.flatnonzero(closed[one[pair]] & (found > 0.0)).tolist():
            turn, shift = seen.turn[row], origin[row]
            skin, point = (scene.bodies[which[pair[row]]].geometry for which in (one, other))
            inner = turn @ point.point + shift if inside else turn.T @ (point.point - shift)
            assert skin.skin is not None  # as it is closed
            if (np.abs(inner - skin.middle) <= skin.half).all() and encloses(skin.skin, inner):
                found[row] = -found[row]
    return found


BLOCK = 1024
"""Joint positions that are looked at together: their arrays stay in the processor's cache."""


def too_near(scene: Scene, q: Array) -> NDArray[np.bool_]:
    """Whether some pair of bodies is nearer than its margin, or touches, (P,) at joint positions `q` (P, n) [rad or m]."""
    found = np.zeros(len(q), dtype=np.bool_)
    for start in range(0, len(q), BLOCK):
        placed = place(scene, q[start : start + BLOCK])
        found[start : start + BLOCK] = _too_near(scene, placed)
    return found


def _too_near(scene: Scene, placed: Placed) -> NDArray[np.bool_]:
    near = np.zeros(placed.middle.shape[1], dtype=np.bool_)
    at, pair = _near_spheres(placed)
    seen = relative(placed, at, pair)
    (left,) = np.nonzero(box_gaps(scene, pair, seen) <= scene.margin[pair])
    # the pairs that meet most often first: a position that is known isn't looked at again
    often = np.bincount(pair[left], minlength=len(scene.first))
    for one in np.argsort(-often, kind="stable")[: np.count_nonzero(often)].tolist():
        rows = left[pair[left] == one]
        rows = rows[~near[at[rows]]]
        gap = distances(scene, pair[rows], seen.take(rows), deep=False)
        near[at[rows[gap <= scene.margin[one]]]] = True
    return near


def _near_spheres(placed: Placed) -> tuple[Rows, Rows]:
    """The positions and pairs (R,) that spheres don't tell apart: of a sphere and the box of a body that stands still, of two spheres else."""
    scene = placed.scene
    found_at, found_pair = [], []
    for body in np.unique(scene.first):
        (pairs,) = np.nonzero(scene.first == body)
        others = scene.second[pairs]
        apart = placed.middle[others] - placed.middle[body]
        reach = scene.bound[others] + scene.margin[pairs]
        if scene.joint[body] == 0:
            apart = np.maximum(np.abs(apart.reshape(-1, 3) @ scene.rotation[body]) - scene.half[body], 0.0)
            apart = apart.reshape(len(pairs), -1, 3)
            reach = reach + scene.radius[body]
        else:
            reach = reach + scene.bound[body]
        near = np.einsum("kpi,kpi->kp", apart, apart) <= (reach**2)[:, None]
        which, where = np.nonzero(near)
        found_at.append(where)
        found_pair.append(pairs[which])
    if not found_at:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    return np.concatenate(found_at), np.concatenate(found_pair)
