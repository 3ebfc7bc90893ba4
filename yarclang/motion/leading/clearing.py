"""Move a redundant arm past obstacles on a Cartesian path, by joint motions that keep the moving frame on its
path (self-motion).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.hir import Array, Motion
from yarclang.motion.avoid.room import TOUCH, Room
from yarclang.motion.cartesian import CartesianPath, flange_poses_of
from yarclang.motion.leading.solving import Solver
from yarclang.motion.singular import NEAR, nearest_singularity
from yarclang.robot.kinematics.bending import bent
from yarclang.robot.kinematics.singularity import smallest_singular_values

_PLACES = 65
"""Least number of places of a path that are checked for obstructions. At least three are checked for each
place at which inverse kinematics was solved.
"""

_WANTED = 0.02
"""Distance that bodies and zones should keep in addition to their margins if possible [m]."""

_CLEAR = 1.5 * NEAR
"""Smallest singular value of the Jacobian above which closeness to a singularity has no cost."""

_SINGULAR = 0.5
"""Cost of a singularity, relative to the cost of bodies that touch."""


def kept_clear(solver: Solver, step: Motion, path: CartesianPath) -> CartesianPath:
    """Find a joint motion that is free of obstructions along the frame path of `path`, and return it as a
    path.

    The given path is returned if it is free already, or if no other joint motion is found. Among several, a
    joint motion that isn't slowed by a singularity is preferred. A free path isn't changed to avoid a
    singularity, since this may demand more of the joints than passing it.
    """
    robot = solver.robot
    room = solver.room(step) if robot.size > 6 else None
    if room is None or _is_free(room, path):
        return path
    velocity = robot.limits.velocity

    def cost(q: Array) -> Array:
        # Cost of a joint position: closeness to a singularity plus closeness to bodies and zones, each from 0
        # to about 1.
        smallest = smallest_singular_values(robot.chain, q, path.flange_from_moving)
        total: Array = _SINGULAR * np.maximum(1.0 - smallest / _CLEAR, 0.0)
        return total + np.maximum(1.0 - room.clearances(q, _WANTED) / _WANTED, 0.0)

    poses = flange_poses_of(path.frame, path.flange_from_moving)
    better = path
    for followed in bent(robot.chain, robot.limits, poses, path.followed, cost):
        candidate = replace(path, followed=followed)
        if not _is_free(room, candidate):
            continue
        if nearest_singularity(candidate, velocity) is None:
            return candidate
        if better is path:
            better = candidate
    return better


def _is_free(room: Room, path: CartesianPath) -> bool:
    """Return True if a path is free of obstructions at sampled places.

    The first place isn't checked, since the robot is there anyway.
    """
    places = np.linspace(0.0, 1.0, max(_PLACES, 3 * len(path.followed.s)))[1:]
    return bool((room.clearances(path.followed.at(places), TOUCH) > 0.0).all())
