"""Decide quickly if a joint position is free of collisions, for searches that ask thousands of times.

The library Pinocchio places the bodies, and the library coal checks the pairs.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.placing import box_gaps, distances, place, relative
from yarclang.collision.proof import SLACK
from yarclang.collision.tiles import TiledMesh
from yarclang.frozen import frozen
from yarclang.robot.model import Chain
from yarclang.shapes import Array


@frozen(eq=False)
class FreeSpace:
    """The joint positions at which all pairs of a scene keep their margins and an additional distance.

    `model`, `data`, `geometry`, `pairs` and `manager` are objects of Pinocchio. The manager examines only
    pairs whose axis-aligned boxes, grown by the margins, overlap. Pairs that come near each other at no joint
    position are left out. A body inside a hollow mesh isn't noticed; use `gaps` for such bodies.

    `tiled` are the indices of the pairs with a large mesh in tiles. Pinocchio doesn't check these pairs,
    since it would need a tree of all triangles. `apart` (K,) is the distance that each pair must keep [m].
    """

    scene: Scene
    model: Any
    data: Any
    geometry: Any
    pairs: Any
    manager: Any
    tiled: Rows
    apart: Array

    def has(self, q: Array) -> bool:
        """Return True if a joint position (n,) [rad or m] is free."""
        import pinocchio

        if pinocchio.computeCollisions(self.model, self.data, self.manager, q, True):
            return False
        return not len(self.tiled) or self._is_free_of_tiles(q)

    def _is_free_of_tiles(self, q: Array) -> bool:
        seen = relative(place(self.scene, q[None]), np.zeros_like(self.tiled), self.tiled)
        near = np.flatnonzero(box_gaps(self.scene, self.tiled, seen) <= self.apart[self.tiled])
        pair = self.tiled[near]
        return bool((distances(self.scene, pair, seen.take(near)) > self.apart[pair]).all())


def free_space(scene: Scene, more: Array | None = None) -> FreeSpace:
    """Prepare the check that all pairs of bodies of a scene keep their distances.

    Args:
        scene: the bodies and pairs.
        more: (K,) the distance that each pair keeps in addition to its margin [m].
    """
    import pinocchio

    model = _model(scene.chain)
    data = model.createData()
    pinocchio.forwardKinematics(model, data, np.zeros(scene.chain.size))
    geometry = pinocchio.GeometryModel()
    tiles = np.array([isinstance(body.geometry.solid, TiledMesh) for body in scene.bodies], dtype=np.bool_)
    in_tiles = tiles[scene.pairs.first] | tiles[scene.pairs.second]
    apart = scene.pairs.margin + SLACK + (0.0 if more is None else more)
    meet = _can_meet(scene, apart)
    others = np.flatnonzero(meet & ~in_tiles).tolist()
    objects: dict[int, int] = {}
    for number in sorted({*scene.pairs.first[others].tolist(), *scene.pairs.second[others].tolist()}):
        body = scene.bodies[number]
        # Compute the pose of the body relative to its joint: the inverse of the joint's pose in {B} times the
        # body's pose in {B}, both with all joints at zero.
        placed = data.oMi[body.joint].inverse() * pinocchio.SE3(np.array(body.base_from_body))
        thing = pinocchio.GeometryObject(str(number), body.joint, placed, body.geometry.of_coal)
        objects[number] = geometry.addGeometryObject(thing)
    for pair in others:
        first, second = int(scene.pairs.first[pair]), int(scene.pairs.second[pair])
        geometry.addCollisionPair(pinocchio.CollisionPair(objects[first], objects[second]))
    pairs = geometry.createData()
    for number, pair in enumerate(others):
        pairs.collisionRequests[number].security_margin = float(apart[pair])
    # Create the manager after the margins are set: each body's box grows by half of its largest margin.
    manager = pinocchio.BroadPhaseManager_NaiveCollisionManager(model, geometry, pairs)
    return FreeSpace(scene, model, data, geometry, pairs, manager, np.flatnonzero(meet & in_tiles), apart)


def _can_meet(scene: Scene, apart: Array) -> NDArray[np.bool_]:
    """Return a mask (K,) of the pairs that some joint position could bring nearer than `apart` (K,) [m].

    A body that the arm carries stays within a ball around a point on the first axis. A point on a joint's
    axis and a point on the next joint's axis keep their distance, since a joint turns the next axis about its
    own axis. The ball's radius is the sum of these distances and of the distance from the last axis point to
    the farthest point of the body. For arms with prismatic joints, the mask contains all pairs.
    """
    boxes, points = scene.boxes, _on_axes(scene.chain)
    if points is None:
        return np.ones(len(scene.pairs.first), dtype=np.bool_)
    joints, carrier = boxes.joint, np.maximum(boxes.joint - 1, 0)
    # Add up the distances from the point on the first axis to the body, along the points on the axes.
    way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    reach = way[carrier] + np.linalg.norm(boxes.middle - points[carrier], axis=1) + boxes.bound
    # Compute the distance of the point on the first axis from the rounded box of a body that doesn't move.
    seen = np.einsum("bij,bi->bj", boxes.rotation, points[0] - boxes.middle)
    away = np.linalg.norm(np.maximum(np.abs(seen) - boxes.half, 0.0), axis=1) - boxes.radius
    first, second = scene.pairs.first, scene.pairs.second
    one, other = np.where(joints[first] > 0, first, second), np.where(joints[first] > 0, second, first)
    near: NDArray[np.bool_] = away[other] - reach[one] <= apart
    kept: NDArray[np.bool_] = near | (joints[other] > 0) | (joints[one] == 0)
    return kept


def _on_axes(chain: Chain) -> Array | None:
    """Return a point (n, 3) on the axis of each joint with all joints at zero [m]; None if a joint is
    prismatic or helical.
    """
    linear, angular = chain.screws[:, :3], chain.screws[:, 3:]
    rate = np.einsum("ni,ni->n", angular, angular)
    if (
        not len(rate)
        or rate.min() == 0.0
        or (np.abs(np.einsum("ni,ni->n", linear, angular)) > _NO_PITCH * rate).any()
    ):
        return None
    points: Array = np.cross(angular, linear) / rate[:, None]
    return points


@lru_cache(maxsize=32)
def plain_free_space(scene: Scene) -> FreeSpace:
    """Return the check of the pairs of a scene with their margins and no additional distance.

    The result is cached by the identity of the scene.
    """
    return free_space(scene)


def gaps(scene: Scene, q: Array) -> Array:
    """Return, for each pair of bodies, the distance less the margin at one joint position (n,), as (K,) [m].

    A value is negative if the two bodies are too near.
    """
    every = np.arange(len(scene.pairs.first))
    seen = relative(place(scene, q[None]), np.zeros_like(every), every)
    left: Array = distances(scene, every, seen) - scene.pairs.margin
    return left


def _model(chain: Chain) -> Any:
    """Build Pinocchio's model of the arm from the screw axes of its joints. With all joints at zero, all
    frames of the model are parallel to {B}.
    """
    import pinocchio

    model = pinocchio.Model()
    parent, at = 0, np.zeros(3)
    for number, screw in enumerate(chain.screws):
        linear, angular = screw[:3], screw[3:]
        rate = float(np.linalg.norm(angular))
        point = at
        if not rate:
            joint = pinocchio.JointModelPrismaticUnaligned(linear)
        else:
            # Compute the point of the joint's axis that is nearest to the origin, and the pitch of its screw
            # [m/rad] (Lynch and Park, ch. 3.3).
            point = np.cross(angular, linear) / rate**2
            pitch = float(angular @ linear) / rate
            axis = angular / rate
            joint = (
                pinocchio.JointModelHelicalUnaligned(axis, pitch)
                if abs(pitch) > _NO_PITCH
                else pinocchio.JointModelRevoluteUnaligned(axis)
            )
        shift = pinocchio.SE3(np.eye(3), point - at)
        parent, at = model.addJoint(parent, joint, shift, f"J{number}"), point
    return model


_NO_PITCH = 1e-12
"""Pitch [m/rad] below which a screw joint counts as revolute."""
