"""Compute the origins of a robot's joint frames as its URDF defines them. They are needed for pictures, and
for the check of the centres of mass.

The screws of a chain determine the joints' axes, but not the position of each joint along its axis. A URDF
determines both.
"""

from __future__ import annotations

import numpy as np

from yarclang.diagnostics import Diagnostic
from yarclang.robot.link_shapes import link_places
from yarclang.robot.model import Array, Robot
from yarclang.robot.urdf import Urdf, read_urdf
from yarclang.toml.reading import parse_toml, read_text


def urdf_of(robot: Robot) -> tuple[Urdf, str] | None:
    """Return the URDF of a robot, and the name of the link that is {B}. Return None if the robot wasn't read
    from files, or if its files can't be read any more.
    """
    table, source = read_text(robot.file, ""), read_text(robot.folder / robot.urdf, "")
    if isinstance(table, Diagnostic) or isinstance(source, Diagnostic):
        return None
    said, urdf = parse_toml(table), read_urdf(source)
    if isinstance(said, Diagnostic) or not urdf.sound or urdf.root is None:
        return None
    base = said.get("base")
    if base not in urdf.links or not all(name in urdf.joints for name in robot.joint_names):
        return None
    return urdf, str(base)


def joint_points(robot: Robot) -> Array | None:
    """Return the origins of the joint frames and of the flange in {B} with all joints at zero, as (n + 1, 3)
    [m]. Return None if the URDF can't be read any more.
    """
    found = urdf_of(robot)
    if found is None:
        return None
    urdf, base = found
    joints = [urdf.joints[name] for name in robot.joint_names]
    places = link_places(urdf, joints)
    base_from_root = np.linalg.inv(places[base][0])
    points = [(base_from_root @ places[joint.child][0])[:3, 3] for joint in joints]
    return np.vstack((*points, robot.chain.base_from_flange[:3, 3]))
