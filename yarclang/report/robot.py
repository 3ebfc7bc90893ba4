"""Describe a robot as text."""

from __future__ import annotations

from yarclang.robot.joint_names import joint_labels
from yarclang.robot.model import Robot
from yarclang.units import MS


def robot_text(robot: Robot) -> str:
    """Return a description of a robot as text for people: joints and their limits, frames, positions and
    controller.
    """
    limits, units = robot.limits, robot.axis_units
    names = joint_labels(robot.joint_names)
    wide = max(8, *(len(name) + 2 for name in names))
    lines = [
        f"{robot.name}: {robot.title}",
        "",
        f"{'joint':{wide}}{'axis':6}{'from':>9}{'to':>9}{'per s':>9}{'per s2':>9}{'per s3':>9}",
    ]
    for joint, name in enumerate(names):
        numbers = (limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk)
        cells = "".join(f"{values[joint] / units[joint]:>9.5g}" for values in numbers)
        lines.append(f"{name:{wide}}{robot.controller.axes[joint]:6}{cells} {robot.axis_unit_names[joint]}")
    lines.append("")
    lines.append("frames on the flange: " + ", ".join(f"{{{name}}}" for name in robot.flange_from_frame))
    for tool in robot.tools:
        mass = f", {tool.mass:g} kg" if tool.mass else ""
        away = "" if tool.mounted else ", not mounted"
        lines.append(f"tool {tool.name}: {len(tool.shapes)} shape{'s' * (len(tool.shapes) != 1)}{mass}{away}")
    for name, q in robot.positions.items():
        lines.append(f"joint position {name}: " + " ".join(f"{value:g}" for value in q / units))
    controller = robot.controller
    lines.append(
        f"controller {controller.kind}, {controller.text}, segments of "
        f"{controller.smallest_segment / MS:.4g} to {controller.largest_segment / MS:g} ms"
    )
    return "\n".join(lines)
