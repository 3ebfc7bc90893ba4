"""A robot's description for readers on the same computer: its URDF as ROS reads it, with the files of its meshes where they are."""

from __future__ import annotations

from dataclasses import replace

from yarclang.diagnostics import Diagnostic, Result
from yarclang.export.moveit.bodies import bodies_of
from yarclang.export.moveit.package import urdf_of
from yarclang.export.moveit.urdf import FileMeshes, urdf_text
from yarclang.frozen import frozen
from yarclang.robot.model import Robot


@frozen
class Described:
    """A URDF as text, and its links {B}, {FLANGE} and {TCP} (the flange if the robot has no {TCP})."""

    urdf: str
    base: str
    flange: str
    tool: str


def described(robot: Robot) -> Result[Described]:
    """Return a robot's URDF with meshes as file URIs, its frames and mounted tools as links, and only the robot's axes as joints that move.

    Returns:
        None with an error if the robot's files can't be read; a mesh that is missing is a finding, and keeps its name.
    """
    read = urdf_of(robot)
    if isinstance(read, Diagnostic):
        return Result(None, (read,))
    urdf, base, flange = read
    bodies, meshes = bodies_of(robot, urdf), FileMeshes(robot)
    text = urdf_text(urdf, flange, bodies, meshes, frozenset(robot.joint_names))
    tcp = robot.flange_from_frame.get("TCP")
    tool = next((link for link, pose in bodies.frames.items() if pose is tcp), flange)
    help_ = "put it where the URDF names it; the robot is described without it"
    findings = tuple(replace(one, help=help_) for one in dict.fromkeys(meshes.findings))
    return Result(Described(text, base, flange, tool), findings)
