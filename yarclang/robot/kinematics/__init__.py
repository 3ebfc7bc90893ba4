"""Compute forward and inverse kinematics of serial arms, and follow paths. Functions take whole arrays, in SI
units.

`fk` computes poses and Jacobians. `nearest_solutions` finds the joint positions for one pose within a robot's
limits. `track` follows a path. `follow` finds the exact joint positions for many poses, each near a seed.
`branches` returns all solutions of a pose. `reaching` finds some joint position for each of many poses.
`nearness` measures the distance of joint positions from a singularity.
"""

from yarclang.robot.kinematics.fk import flange_poses, poses_and_jacobians, tool_poses
from yarclang.robot.kinematics.inverse import branches, follow
from yarclang.robot.kinematics.nearest import Solutions, Unreachable, full_turns, nearest_solutions
from yarclang.robot.kinematics.reach import arm_length, reach_radii
from yarclang.robot.kinematics.search import reaching
from yarclang.robot.kinematics.singularity import (
    Nearness,
    nearness,
    smallest_singular_values,
)
from yarclang.robot.kinematics.track import Broken, Track, track

__all__ = [
    "Broken",
    "Nearness",
    "Solutions",
    "Track",
    "Unreachable",
    "arm_length",
    "branches",
    "flange_poses",
    "follow",
    "full_turns",
    "nearest_solutions",
    "nearness",
    "poses_and_jacobians",
    "reach_radii",
    "reaching",
    "smallest_singular_values",
    "tool_poses",
    "track",
]
