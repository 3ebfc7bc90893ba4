"""Find joints whose motion the collision check can't see: the link that such a joint moves, with all links
rigidly attached to it, has no collision shape. The warnings are shown when a robot is made and when it is
checked, not when a program is compiled.
"""

from __future__ import annotations

from yarclang.diagnostics import Diagnostic
from yarclang.robot.chain import check_bodies
from yarclang.robot.model import Robot
from yarclang.robot.urdf import read_urdf
from yarclang.source import SourceFile


def bare_links(robot: Robot) -> tuple[Diagnostic, ...]:
    """Return a warning for each joint whose link has no collision shape; links rigidly attached to this link
    count as its parts. A robot that wasn't read from files gets no warnings.
    """
    if robot.written is None:
        return ()
    urdf = read_urdf(SourceFile(robot.urdf, robot.written.urdf))
    before = len(urdf.findings)
    shapes = {name: [one.tag for one in link.all("collision")] for name, link in urdf.links.items()}
    check_bodies(urdf, [urdf.joints[name] for name in robot.joint_names], shapes)
    return tuple(urdf.findings[before:])
