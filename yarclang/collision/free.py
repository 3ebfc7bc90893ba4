"""Whether single joint positions are free, asked one by one and thousands of times: Pinocchio moves the bodies, coal looks at the pairs."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from yarclang.collision.bodies import Scene
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.proof import SLACK
from yarclang.frozen import frozen
from yarclang.robot.model import Chain
from yarclang.shapes import Array


@frozen(eq=False)
class FreeSpace:
    """The joint positions at which all pairs of a scene's bodies stay farther apart than their margins, and some more.

    `model`, `data`, `geometry`, `pairs` and `manager` are Pinocchio's; the manager looks closer only at pairs whose boxes along the axes, with the margins about
    them, overlap. Inside of a hollow mesh nothing is near: there `gaps` is needed.
    """

    scene: Scene
    model: Any
    data: Any
    geometry: Any
    pairs: Any
    manager: Any

    def has(self, q: Array) -> bool:
        """Return True if a joint position (n,) [rad or m] is one of them."""
        import pinocchio

        return not pinocchio.computeCollisions(self.model, self.data, self.manager, q, True)


def free_space(scene: Scene, more: Array | None = None) -> FreeSpace:
    """What is free in a scene.

    Args:
        scene: bodies and pairs.
        more: (K,) how much farther apart than its margin each pair stays [m].
    """
    import pinocchio

    model = _model(scene.chain)
    data = model.createData()
    pinocchio.forwardKinematics(model, data, np.zeros(scene.chain.size))
    geometry = pinocchio.GeometryModel()
    for number, body in enumerate(scene.bodies):
        placed = data.oMi[body.joint].inverse() * pinocchio.SE3(np.array(body.base_from_body))
        shape = body.geometry.of_coal
        geometry.addGeometryObject(pinocchio.GeometryObject(str(number), body.joint, placed, shape))
    for first, second in zip(scene.pairs.first.tolist(), scene.pairs.second.tolist(), strict=True):
        geometry.addCollisionPair(pinocchio.CollisionPair(first, second))
    pairs = geometry.createData()
    apart = scene.pairs.margin + SLACK + (0.0 if more is None else more)
    for pair, margin in enumerate(apart.tolist()):
        pairs.collisionRequests[pair].security_margin = margin
    # made after the margins were set: each body's box grows by half of its largest margin
    manager = pinocchio.BroadPhaseManager_NaiveCollisionManager(model, geometry, pairs)
    return FreeSpace(scene, model, data, geometry, pairs, manager)


@lru_cache(maxsize=32)
def plain_free_space(scene: Scene) -> FreeSpace:
    """What is free in a scene, with no more than its margins; remembered by the scene's identity."""
    return free_space(scene)


def gaps(scene: Scene, q: Array) -> Array:
    """How far each pair is from its margin at one joint position (n,), (K,) [m]: negative where it is too near."""
    every = np.arange(len(scene.pairs.first))
    seen = relative(place(scene, q[None]), np.zeros_like(every), every)
    left: Array = distances(scene, every, seen) - scene.pairs.margin
    return left


def _model(chain: Chain) -> Any:
    """The arm for Pinocchio, whose joints are the chain's screws: all frames are turned as {B} with all joints at zero."""
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
"""A screw that slides by less a turn [m/rad] only turns."""
