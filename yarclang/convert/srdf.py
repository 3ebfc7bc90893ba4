"""Read the named states of an SRDF (`group_state`) as named joint positions."""

from __future__ import annotations

import re

import numpy as np

from yarclang.convert.course import Content, Wishes, in_axis_units
from yarclang.convert.names import legal_name
from yarclang.convert.table import LARGEST
from yarclang.diagnostics import Collector
from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.robot.urdf_xml import Element, UrdfText, parse_xml
from yarclang.source import SourceFile, Span

_NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)


def content_of_srdf(source: SourceFile, robot: Robot, wishes: Wishes, findings: Collector) -> Content | None:
    """Return the joint positions of all group states of an SRDF that concern the robot's joints. Return None,
    with an error, if a state has mistakes.

    States of other groups, for example of a gripper, are reported and ignored.

    Args:
        source: the file.
        robot: the robot.
        wishes: the options.
        findings: collects findings.
    """
    text = UrdfText(source, "an SRDF")
    parse_xml(text)
    for one in text.findings:
        findings.add("Y1507", one.message, one.span, one.help)
    root = text.root
    if root is None or findings.has_errors:
        return None
    states = root.all("group_state")
    if not states:
        help_ = (
            "an SRDF has <group_state name=... group=...> with a <joint name=... value=...> for each joint"
        )
        findings.add("Y1509", f"<{root.tag}> has no group_state", _span(text, root), help_)
        return None
    wanted = wishes.joints or robot.joint_names
    taken: dict[str, tuple[Array, int]] = {}
    for state in states:
        name = re.sub(r"[\s.-]+", "_", state.attributes.get("name", "").strip())
        q = _values(text, state, robot, wanted, findings)
        if q is None:
            if findings.has_errors:
                return None
            continue
        span = _span(text, state)
        if refusal := legal_name(name):
            findings.add("Y1510", refusal, span, "choose another name in the SRDF")
            return None
        if name.upper() in taken:
            message = f"{name} is already the name of another state, in line {taken[name.upper()][1]}"
            findings.add("Y1510", message, span, "give each state its own name")
            return None
        taken[name.upper()] = q, span.line
    if not taken:
        message = f"no state has exactly the joints of {robot.name}"
        findings.add("Y1511", message, _span(text, root), _joints_help(robot))
        return None
    positions = tuple((name, q) for name, (q, _) in taken.items())
    return Content(
        f"{len(positions)} named state{'s' * (len(positions) != 1)} of an SRDF", positions=positions
    )


def _values(
    text: UrdfText, state: Element, robot: Robot, wanted: tuple[str, ...], findings: Collector
) -> Array | None:
    """Return the joint values (n,) of a group state [deg, mm].

    Return None with an error if the state is wrong, or None with a warning if it belongs to another group.
    """
    given = {joint.attributes.get("name", ""): joint for joint in state.all("joint")}
    shown = state.attributes.get("name", "")[:40]
    missing = [name for name in wanted if name not in given]
    extra = [name for name in given if name not in wanted]
    span = _span(text, state)
    if len(missing) == len(wanted):
        findings.add("Y1503", f"ignored: state {shown}, which names other joints", span)
        return None
    if missing or extra:
        parts = [
            f"{what} {', '.join(some)}" for what, some in (("missing", missing), ("unknown", extra)) if some
        ]
        message = f"the joints of state {shown} aren't those of {robot.name}: {'; '.join(parts)}"
        findings.add("Y1511", message, span, _joints_help(robot))
        return None
    q = np.empty(robot.size)
    for number, name in enumerate(wanted):
        value = given[name].attributes.get("value", "")
        if not _NUMBER.fullmatch(value) or abs(float(value)) > LARGEST:
            message = f"state {shown}: the value of {name} is {value[:40]!r}, which isn't a finite number"
            findings.add(
                "Y1505", message, _span(text, given[name]), "values are in rad, m for prismatic joints"
            )
            return None
        q[number] = float(value)
    return in_axis_units(robot, q)


def _joints_help(robot: Robot) -> str:
    names = ", ".join(robot.joint_names)
    return (
        f"{robot.name} has {names}; if the file names them differently, give its names in this order by "
        "--joints"
    )


def _span(text: UrdfText, element: Element) -> Span:
    """Return the position of an XML element's tag in the text, up to the end of its first line."""
    line = text.text.count("\n", 0, element.start) + 1
    column = element.start - text.starts[line - 1] + 1
    return Span.on_line(
        line, column, min(len(text.source.line(line)) + 1, column + element.end - element.start)
    )
