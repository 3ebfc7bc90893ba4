"""Write the URDF of a robot for ROS programs on the computer that has the robot's files. The URDF refers to
the meshes by the paths of their files.
"""

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
    """A robot's URDF for programs on the same computer. It refers to the meshes by local paths.

    Attributes:
        urdf: the text.
        base: name of the link that is the frame {B}.
        flange: name of the link that is the frame {FLANGE}.
        tool: name of the link that is the frame {TCP}; for a robot without a {TCP}, the flange's link.
    """

    urdf: str
    base: str
    flange: str
    tool: str


def described(robot: Robot) -> Result[Described]:
    """Return the URDF of a robot, for programs on the same computer.

    Meshes are named by file URIs with local paths. The robot's frames and mounted tools are links, and only
    the robot's own axes are moving joints.

    Returns:
        The description; None, with an error, if the files of the robot can't be read. A missing mesh is
        reported as a finding, and the URDF keeps the mesh's name as it was.
    """
    read = urdf_of(robot)
    if isinstance(read, Diagnostic):
        return Result(None, (read,))
    urdf, base, flange = read
    bodies, meshes = bodies_of(robot, urdf), FileMeshes(robot)
    text = urdf_text(urdf, flange, bodies, meshes, frozenset(robot.joint_names))
    tcp = robot.flange_from_frame.get("TCP")
    tool = next((link for link, pose in bodies.frames.items() if pose is tcp), flange)
    help_ = "put the file where the URDF expects it; the robot is exported without it"
    findings = tuple(replace(one, help=help_) for one in dict.fromkeys(meshes.findings))
    return Result(Described(text, base, flange, tool), findings)
