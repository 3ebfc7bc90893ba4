"""Kinematics of serial arms: forward, inverse, along a path. Whole arrays at a time, SI units.

`fk` has the poses and Jacobians. `nearest_solutions` is for one pose and a robot's limits, `track`
follows a path, `follow` finds the exact joint positions of many samples next to seeds, `branches` has
all solutions.
"""

from yarclang.robot.kinematics.fk import flange_poses, poses_and_jacobians, tool_poses
from yarclang.robot.kinematics.inverse import branches, follow
from yarclang.robot.kinematics.nearest import Solutions, Unreachable, full_turns, nearest_solutions
from yarclang.robot.kinematics.reach import reach_radii
from yarclang.robot.kinematics.track import Broken, Track, track

__all__ = [
    "Broken",
    "Solutions",
    "Track",
    "Unreachable",
    "branches",
    "flange_poses",
    "follow",
    "full_turns",
    "nearest_solutions",
    "poses_and_jacobians",
    "reach_radii",
    "tool_poses",
    "track",
]
