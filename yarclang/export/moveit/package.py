"""Make a ROS package with the MoveIt configuration of a robot: all its files, as bytes."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from yarclang.collision.scene import scene_of
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.export.moveit.bodies import bodies_of
from yarclang.export.moveit.settings import settings_files
from yarclang.export.moveit.srdf import srdf_text
from yarclang.export.moveit.urdf import exported_urdf
from yarclang.export.package import Package
from yarclang.robot.model import Robot
from yarclang.robot.urdf import Urdf, read_urdf
from yarclang.toml.reading import parse_toml, read_text

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*", re.ASCII)


def package_of(robot: Robot) -> Result[Package]:
    """Return the MoveIt configuration package of a robot; None, with findings, if it can't be made."""
    findings = list(_names(robot))
    read = urdf_of(robot)
    if isinstance(read, Diagnostic):
        return Result(None, (*findings, read))
    scene = scene_of(robot, None)
    findings += scene.diagnostics
    if has_errors(findings) or scene.value is None:
        return Result(None, tuple(findings))
    urdf, base, flange = read
    findings += check_motors(robot)
    bodies = bodies_of(robot, urdf)
    name = f"{robot.name.lower()}_moveit_config"
    described = exported_urdf(robot, urdf, name, (base, flange), bodies)
    findings += described.diagnostics
    if described.value is None:
        return Result(None, tuple(findings))
    own = f"config/{robot.name.lower()}.srdf"
    files = {
        "package.xml": _package(name, robot).encode(),
        "CMakeLists.txt": _CMAKE.format(name=name).encode(),
        own: srdf_text(robot, urdf, (base, flange), bodies, scene.value).encode(),
        **{path: text.encode() for path, text in settings_files(robot).items()},
        **described.value,
    }
    return Result(Package(name, files), tuple(findings))


def _names(robot: Robot) -> list[Diagnostic]:
    """Return findings about names that ROS doesn't allow."""
    found = []
    for what, name in (("robot", robot.name), *(("joint", name) for name in robot.joint_names)):
        if not _NAME.fullmatch(name):
            message = f"the name of the {what}, {name[:60]}, isn't allowed for ROS parameters"
            where = "robot.toml" if what == "robot" else "the URDF and robot.toml"
            help_ = f"rename it in {where}, with a letter first, then letters, digits and _"
            found.append(Diagnostic("Y1534", message, help=help_))
    return found


def urdf_of(robot: Robot) -> tuple[Urdf, str, str] | Diagnostic:
    """Return the URDF of a robot, and the names of its links {B} and {FLANGE}. If the robot's files have
    changed since the robot was read from them, return a finding instead.
    """
    table = read_text(robot.file, "Name a folder with a robot.toml.")
    if isinstance(table, Diagnostic):
        return table
    said = parse_toml(table)
    if isinstance(said, Diagnostic):
        return said
    source = read_text(robot.folder / robot.urdf, "")
    if isinstance(source, Diagnostic):
        return source
    urdf = read_urdf(source)
    ends = str(said.get("base")), str(said.get("flange"))
    if not urdf.sound or urdf.root is None or not {*ends} <= {*urdf.links}:
        message = f"{robot.urdf} has changed since {robot.name} was read"
        return Diagnostic("Y1302", message, help="export it again; yarc robot check checks its files")
    return urdf, *ends


def _package(name: str, robot: Robot) -> str:
    return f"""<?xml version="1.0"?>
<!-- Written by yarc export for MoveIt. -->
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>MoveIt's configuration of {robot.name}, made of its robot.toml</description>
  <maintainer email="nobody@example.com">nobody</maintainer>
  <license>Proprietary</license>
  <buildtool_depend condition="$ROS_VERSION == 1">catkin</buildtool_depend>
  <buildtool_depend condition="$ROS_VERSION == 2">ament_cmake</buildtool_depend>
  <exec_depend>robot_state_publisher</exec_depend>
  <export>
    <build_type condition="$ROS_VERSION == 2">ament_cmake</build_type>
  </export>
</package>
"""


_CMAKE = """# Written by yarc export for MoveIt.
cmake_minimum_required(VERSION 3.10)
project({name})
if("$ENV{{ROS_VERSION}}" STREQUAL "1")
  find_package(catkin REQUIRED)
  catkin_package()
  install(DIRECTORY config urdf DESTINATION ${{CATKIN_PACKAGE_SHARE_DESTINATION}})
else()
  find_package(ament_cmake REQUIRED)
  install(DIRECTORY config urdf DESTINATION share/${{PROJECT_NAME}})
  ament_package()
endif()
"""


_SLACK = 1e-9


def check_motors(robot: Robot) -> Iterator[Diagnostic]:
    """Yield a warning for each motor that would exceed its speed limit before its joints reach their velocity
    limits.
    """
    actuation = robot.actuation
    speeds = robot.limits.velocity / robot.axis_units
    turns = np.abs(actuation.gear[:, None] * actuation.coupling)
    need = turns @ speeds
    for row in np.flatnonzero(need > actuation.velocity * (1.0 + _SLACK)):
        joints = [robot.joint_names[at] for at in np.flatnonzero(turns[row])]
        share = 100.0 * actuation.velocity[row] / need[row]
        together = "together " if len(joints) > 1 else ""
        message = (
            f"motor {robot.controller.motors[row]} allows {', '.join(joints)} {together}only "
            f"{share:.1f} % of their speed "
            "limits, which MoveIt can't know"
        )
        help_ = (
            f"limit MoveIt to {share:.0f} % (max_velocity_scaling_factor), or let yarc refuse motions that "
            "are too fast"
        )
        yield Diagnostic("Y1535", message, help=help_)
