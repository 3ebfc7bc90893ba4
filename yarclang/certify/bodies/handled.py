"""Poses of the cell's parts while a controller text runs, and checks of picking up and putting down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from yarclang import hir
from yarclang.cell.model import Cell, Parts
from yarclang.certify.bodies.tools import changed, dropped_at_stops, tool_findings
from yarclang.certify.read.layout import Layout
from yarclang.certify.read.tools import tools_again
from yarclang.diagnostics import Diagnostic, grouped
from yarclang.frozen import frozen
from yarclang.handling.allowing import Allowances, allowances_of
from yarclang.handling.grasp import Grasp
from yarclang.handling.seating import deepest, first_of, nearest_to
from yarclang.handling.surroundings import INTO, MOST_UNSURE
from yarclang.handling.walk import Handling, followed, handling_of
from yarclang.robot.model import Robot
from yarclang.units import MM

ON = 5e-3
"""Distance [m], in addition to the margin, up to which a released part counts as lying on the nearest body.

A part that is farther away would fall.
"""


@frozen(eq=False)
class Handled:
    """The cell's state and the parts that the robot carries, during each motion.

    Attributes:
        cell: the program's cell, as it is before the first motion.
        cells: the cell's state by the step of the motion; empty if the state never changes.
        carried: names of the carried parts by the step of the motion; empty without parts.
        allowances: for each step, the lines of program or cell that allow bodies to touch.
    """

    cell: Cell | None
    cells: Mapping[int, Cell | None]
    carried: Mapping[int, tuple[str, ...]]
    allowances: Allowances = field(default_factory=dict)

    def at(self, step: int) -> Cell | None:
        """Return the cell's state during a motion."""
        return self.cells.get(step, self.cell)


def follow(layout: Layout, program: hir.Program, robot: Robot) -> tuple[Handled, list[Diagnostic]]:
    """Compute where the cell's parts are during each motion, from the positions at which the text's motions
    end.

    Args:
        layout: the whole text; in a partial plan, motions may be missing.
        program: the program. Its steps set outputs, and its cell defines which outputs move grippers.
            `yarclang.certify.flow` proves that the text sets the same outputs between the same motions.
        robot: the robot whose flange carries the parts.
    """
    if program.cells is not None:
        return Handled(program.cell, program.cells, {}, allowances_of(program)), []
    handling = handling_of(robot, program.cell, program.steps)
    if not handling.is_needed:
        return Handled(program.cell, {}, {}), []
    start = layout.begins[0] if len(layout.begins) else program.start
    ends = {place.step: layout.ends[row] for row, place in enumerate(layout.places)}
    walked = followed(handling, start, ends)
    carried = {step: tuple(one.name for one in parts.held()) for step, parts in walked.before.items()}
    flowing = {place.step for place in layout.places if place.behind is not None}
    findings = list(_findings(handling, walked.grasps, walked.before, flowing))
    findings += _computed(handling) if handling.has_parts else []
    findings += _not_as_before(handling, walked.unlike)
    findings += _left_over(handling, walked.grasps, walked.end)
    findings += tool_findings(handling, walked, robot, tools_again(handling, start, ends))
    findings += dropped_at_stops(program)
    return Handled(program.cell, walked.cells, carried, handling.allowances), findings


def _findings(
    handling: Handling, grasps: Mapping[int, Grasp], before: Mapping[int, Parts], flowing: set[int]
) -> list[Diagnostic]:
    """Return findings about the use of grippers, in the order of the program."""
    findings: list[Diagnostic] = []
    motions = sorted(before)
    for number, grasp in grasps.items():
        origin = _origin(handling, number)
        last = max((step for step in motions if step < number), default=None)
        if last in flowing:
            does = "closes" if grasp.closes else "opens"
            message = (
                f"the gripper {does} while the robot moves, between two motions that flow into each other"
            )
            findings.append(_finding("Y0944", message, origin, _REST))
        if grasp.grip.changes:
            findings += changed(handling, grasp, origin)
        elif grasp.closes and not grasp.moved:
            findings.append(_nothing(grasp, origin))
        elif grasp.closes:
            findings += _taken(handling, grasp, origin)
        elif grasp.moved:
            findings += _put_down(handling, grasp, origin)
    for step in motions:
        unsure = {one.part.body.name for one in before[step].held() if not one.is_sure}
        if len(unsure) > MOST_UNSURE:
            command = handling.steps[step]
            assert isinstance(command, hir.Motion)
            message = (
                f"after the WHENs before it any of {len(unsure)} parts may be in the grippers, and at most "
                f"{MOST_UNSURE} are allowed"
            )
            findings.append(_finding("Y0945", message, command.origin, _UNSURE))
            break
    return list(grouped(findings))


def _computed(handling: Handling) -> list[Diagnostic]:
    """Return findings about SET lines that give a computed value to an output that moves or removes parts.

    After such a line, the parts' poses are unknown.
    """
    findings = []
    cell = handling.cell
    moving = set() if cell is None else {*cell.grips, *cell.removals}
    for step in handling.steps:
        if isinstance(step, hir.Assign) and not isinstance(step.target, str):
            for bit in step.target.bits:
                if bit.variable in moving:
                    message = (
                        f"{step.target.name} moves parts ({bit.variable}), and its value is known only at "
                        "run time"
                    )
                    findings.append(
                        _finding(
                            "Y0949",
                            message,
                            step.origin,
                            "set it ON or OFF, in the branches of a WHEN or CASE",
                        )
                    )
    return list(grouped(findings))


def _not_as_before(handling: Handling, unlike: Mapping[int, str]) -> list[Diagnostic]:
    """Return findings about loops that don't leave each part where it was when the loop began.

    A later pass of such a loop would differ from the one pass that is proved.
    """
    findings = []
    for number, name in unlike.items():
        step = handling.steps[number]
        assert isinstance(step, hir.NextPass)  # only NextPass repeats a loop
        message = (
            f"{name} isn't where it was when the loop began, so the next pass would differ from the proved "
            "one"
        )
        findings.append(_finding("Y0948", message, step.origin, _AS_BEFORE))
    return list(grouped(findings))


def _origin(handling: Handling, number: int) -> hir.Origin:
    step = handling.steps[number]
    assert isinstance(step, hir.SetOutput)  # only outputs move grippers
    return step.origin


def _finding(code: str, message: str, origin: hir.Origin, help_: str) -> Diagnostic:
    return Diagnostic(code, message, origin.source, origin.span, help_, place=origin.place)


def _nothing(grasp: Grasp, origin: hir.Origin) -> Diagnostic:
    frame, near = grasp.grip.frame, grasp.near
    tool = grasp.grip.tool
    if tool is not None and tool not in grasp.before.tools:
        on = ", ".join(grasp.before.tools) or "no tool"
        message = f"the gripper at {{{frame}}} belongs to {tool}, but {on} is on the flange"
        return _finding("Y0954", message, origin, f"take {tool} first: TOOL {tool} at its place")
    if near is None:
        message = f"the gripper at {{{frame}}} closes on nothing: all parts are taken"
    else:
        message = (
            f"the gripper at {{{frame}}} closes on nothing: {near.item.name}, the nearest part, is "
            f"{near.distance / MM:.4g} mm away, and the gripper's reach is {grasp.grip.reach / MM:.4g} mm"
        )
    return _finding("Y0940", message, origin, _NEARER)


def _taken(handling: Handling, grasp: Grasp, origin: hir.Origin) -> list[Diagnostic]:
    """Return findings about the parts that a gripper picks up: a part in the air or inside a body, or one
    that overlaps its gripper.
    """
    cell = handling.cell
    if cell is None:
        return []
    findings = []
    margin = {one.name: one.margin for one in cell.obstacles}
    for item in first_of(grasp):
        name, near = item.name, nearest_to(handling.robot, cell, grasp, item.name)
        if near is None or near.least > ON + max(margin.get(near.other or "", 0.0), item.part.body.margin):
            message = f"{name} has no support when the program starts: "
            message += (
                f"{near.other}, the nearest body, is {near.least / MM:.3g} mm away"
                if near
                else "the cell has no other body"
            )
            findings.append(_finding("Y0946", message, origin, _START))
        elif near.least < -INTO:
            message = f"{name} is {-near.least / MM:.3g} mm deep in {near.other} when the program starts"
            findings.append(_finding("Y0946", message, origin, _START))
    for name in grasp.moved:
        if (deep := deepest(handling.robot, cell, grasp, name)) is not None:
            depth = f"{-deep.least / MM:.3g} mm"
            message = f"{deep.other} is {depth} deep in {name} when the gripper closes"
            findings.append(_finding("Y0947", message, origin, _DEEP.format(depth)))
    return findings


def _put_down(handling: Handling, grasp: Grasp, origin: hir.Origin) -> list[Diagnostic]:
    """Return findings about released parts: inside a body, or in the air."""
    findings = []
    margin = {one.name: one.margin for one in handling.cell.obstacles} if handling.cell else {}
    beside = handling.supports(grasp)
    for name in grasp.moved:
        own = [one for one in beside if one.part == name]
        if own and (worst := min(own, key=lambda one: one.least)).least < -INTO:
            message = f"{name} is put down {-worst.least / MM:.3g} mm deep in {worst.other}"
            findings.append(_finding("Y0942", message, origin, _INTO))
        elif not any(one.least <= ON + margin.get(one.other or "", 0.0) for one in own):
            nearest = min(own, key=lambda one: one.least, default=None)
            where = "nothing is near it"
            if nearest is not None:
                where = f"{nearest.other}, the nearest body, is {nearest.least / MM:.3g} mm away"
            findings.append(_finding("Y0943", f"{name} is released without support: {where}", origin, _AIR))
    return findings


def _left_over(handling: Handling, grasps: Mapping[int, Grasp], end: Parts) -> list[Diagnostic]:
    """Return findings about parts that are picked up and never put down."""
    findings = []
    if handling.cell is not None and handling.cell.present is not None and handling.cell.present.goes_on:
        return []  # the next line of the session may put them down
    for item in end.held():
        if item.part.rack is not None:
            continue  # the next program begins with the tool
        taken = [one for one in grasps.values() if one.closes and item.name in one.moved]
        if not taken:
            continue  # the robot has carried the part from the start
        may = "is" if item.is_sure else "may be"
        message = f"{item.name} is taken here, and {may} still in the gripper when the program ends"
        findings.append(_finding("Y0941", message, _origin(handling, taken[-1].step), _DOWN))
    return list(grouped(findings))


_AS_BEFORE = (
    "let a machine take away what the loop puts down (an output with removes in the cell.toml), and let all "
    "branches of a WHEN or CASE in the loop leave the parts alike; or write a fixed number of passes with "
    "REPEAT"
)
_REST = "remove BLEND from the motion before: parts are taken and put down at rest"
_NEARER = (
    "move the gripper's frame to the part, or correct the part's place or the gripper's reach in the "
    "cell.toml"
)
_INTO = "put it down higher, or correct the shapes in the cell.toml"
_AIR = "put it down lower, or add its support to the cell.toml"
_DOWN = "open the gripper before the program ends, unless another program opens it"
_START = "correct frame or xyz of the part in the cell.toml, or add its support"
_DEEP = (
    "the part's or the gripper's frame may be wrong by about {}; fingers on two sides of a part are best "
    "described as two bodies"
)
_UNSURE = "end the branches of a WHEN with the same parts in the grippers"
