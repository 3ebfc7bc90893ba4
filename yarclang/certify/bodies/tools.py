"""Checks of the tool changes in a controller text: the tool on the flange must be the one that the program
states.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from yarclang import hir
from yarclang.cell.model import Parts
from yarclang.collision.zones.watched import tool_frame
from yarclang.diagnostics import Diagnostic, grouped
from yarclang.handling.grasp import Grasp
from yarclang.handling.racks import MOST_TURN, apart
from yarclang.handling.walk import Followed, Handling
from yarclang.robot.model import Robot
from yarclang.units import DEG, MM

NOBODY = "no tool"


def changed(handling: Handling, grasp: Grasp, origin: hir.Origin) -> list[Diagnostic]:
    """Return findings about a tool changer's lock that opens or closes in the wrong place."""
    if not grasp.closes:
        return list(_put_back(grasp, origin))
    step = handling.steps[grasp.step]
    if grasp.moved or (isinstance(step, hir.SetOutput) and step.tool is not None):
        return []  # `_other_than_said` checks TOOL lines
    message = "the tool changer locks, but no tool is at the flange"
    if grasp.near is not None:
        message += f": {_away(grasp.near.item.name, grasp)}"
    return [_finding("Y0940", message, origin, _DOCK)]


def _put_back(grasp: Grasp, origin: hir.Origin) -> Iterator[Diagnostic]:
    for item in grasp.before.held(grasp.variable):
        rack = item.part.rack
        if rack is None:
            continue
        distance, turn = apart(rack, grasp.base_from_flange)
        if distance > rack.reach or turn > MOST_TURN:
            message = f"{item.name} is put down beside its place: {_away(item.name, grasp)}"
            yield _finding("Y0952", message, origin, _DOCK)
        for part in grasp.before.items:
            if part.gripper in rack.grippers:
                message = f"{item.name} is put down while its gripper holds {part.name}"
                yield _finding("Y0952", message, origin, f"put {part.name} down first")


def _away(name: str, grasp: Grasp) -> str:
    """Return in words the distance of the flange from a tool's place, and the allowed distance."""
    rack = next(one.part.rack for one in grasp.before.items if one.name == name)
    assert rack is not None  # each tool of a changer has a rack
    distance, turn = apart(rack, grasp.base_from_flange)
    return (
        f"the flange is {distance / MM:.4g} mm and {turn / DEG:.3g} deg from the place of {name}, and at "
        f"most {rack.reach / MM:.4g} mm and {MOST_TURN / DEG:.3g} deg are allowed"
    )


def tool_findings(
    handling: Handling, found: Followed, robot: Robot, again: Mapping[int, str]
) -> list[Diagnostic]:
    """Return findings about the tools of a controller text.

    There are three kinds: TOOL lines that are not true, branches that meet with different tools on the
    flange, and uses of frames of tools that aren't on the flange.

    Args:
        handling: the program.
        found: the cell's states that result from the text's motions.
        robot: the robot.
        again: for each step of a motion, the tool on the flange as `yarclang.certify.read.tools` computes it.
    """
    if handling.cell is None or not handling.cell.tools:
        return []
    findings = [*_other_than_said(handling, found), *_not_agreed(handling, found)]
    findings += _frames(handling, found.before, robot)
    if not findings and not found.unlike:
        findings += _contradicted(handling, found.before, again)
    return list(grouped(findings))


def _other_than_said(handling: Handling, found: Followed) -> Iterator[Diagnostic]:
    for number, on in found.tools.items():
        step = handling.steps[number]
        assert isinstance(step, hir.SetOutput)  # only TOOL lines are in `tools`
        said, grasp = step.tool, found.grasps.get(number)
        if on == ((said,) if said else ()):
            continue
        if len(on) > 1 or not said:
            message = f"after this line {' or '.join(on)} may be on the flange instead of {said or NOBODY}"
            yield _finding("Y0951", message, step.origin, _AGREE)
        elif on:
            message = f"{said} isn't taken: {on[0]} is on the flange"
            help_ = f"put {on[0]} back first: TOOL NONE at its place"
            yield _finding("Y0951", message, step.origin, help_)
        elif grasp is None:
            message = f"{said} isn't taken: the changer is already locked, without a tool"
            yield _finding("Y0951", message, step.origin, "unlock it first: TOOL NONE")
        elif _stands(grasp.before, said):
            message = f"{said} isn't taken: {_away(said, grasp)}"
            yield _finding("Y0951", message, step.origin, _DOCK)
        else:
            message = f"{said} isn't taken: it isn't at its place"
            yield _finding("Y0951", message, step.origin, "put it back before this line")


def dropped_at_stops(program: hir.Program) -> Iterator[Diagnostic]:
    """Yield findings about outputs that would unlock the tool changer at each stop."""
    lock = None if program.cell is None else program.cell.lock
    if lock is None or lock.grip is None:
        return
    for output in program.outputs:
        if lock.variable not in {one.variable for one in output.signal.bits} or output.safe is None:
            continue
        bit = [one.variable for one in output.signal.bits].index(lock.variable)
        value = output.safe if len(output.signal.bits) == 1 else float(int(output.safe) >> bit & 1)
        if value != lock.grip.value:
            name = output.signal.name
            message = (
                f"{name} ({lock.variable}) unlocks the tool changer at each stop, so that the tool falls"
            )
            help_ = f"declare {name} without a safe value, or without {lock.variable}"
            yield Diagnostic("Y0952", message, program.source, help=help_)


def _contradicted(
    handling: Handling, before: Mapping[int, Parts], again: Mapping[int, str]
) -> Iterator[Diagnostic]:
    """Yield a finding for the first motion for which two computations disagree about the tool on the flange.

    The second computation is that of `yarclang.certify.read.tools`.
    """
    for number in sorted(before):
        step, on = handling.steps[number], before[number].tools
        if number in again and on != ((again[number],) if again[number] else ()):
            assert isinstance(step, hir.Motion)  # only motions have a state before them
            message = (
                f"{again[number] or NOBODY} is on the flange in this motion, but it was proved with the "
                f"bodies of {' and '.join(on) or NOBODY}"
            )
            yield _finding("Y1194", message, step.origin, "")
            return


def _stands(parts: Parts, name: str) -> bool:
    return any(
        one.name == name and one.part.rack is not None and one.pose == one.part.rack.base_from_body.tobytes()
        for one in parts.items
    )


def _not_agreed(handling: Handling, found: Followed) -> Iterator[Diagnostic]:
    for number, parted in found.parted.items():
        step, began = handling.steps[number], parted.began
        one, other = (name or NOBODY for name in parted.tools)
        where = f"{began.origin.name} in line {began.origin.span.line}"
        message = f"the branches of {where} meet here with different tools on the flange: {one} and {other}"
        assert not isinstance(step, hir.Gap)  # branches never meet at a gap
        yield _finding("Y0953", message, step.origin, _AGREE)


def _frames(handling: Handling, before: Mapping[int, Parts], robot: Robot) -> Iterator[Diagnostic]:
    """Yield findings about moved or watched frames of tools that aren't on the flange."""
    cell = handling.cell
    assert cell is not None  # without a cell, there are no tools to change
    owners: dict[str, set[str]] = {}
    for one in cell.parts:
        for name in one.rack.frames if one.rack is not None else ():
            owners.setdefault(name, set()).add(one.body.name)
    watched = any({"tool", "tcp"} & {*zone.watch} for zone in cell.zones)
    for number in sorted(before):
        step, on = handling.steps[number], {*before[number].tools}
        assert isinstance(step, hir.Motion)  # only motions have a state before them
        origin = step.origin
        if origin.moving is None and not watched:
            continue
        link = origin.tool if origin.moving is None else origin.moving
        names = [tool_frame(robot).name] if link is None else []
        while link is not None:
            names.append(link.name)
            link = link.parent
        for name in names:
            if name in owners and not on & owners[name]:
                of = " or ".join(sorted(owners[name]))
                does = "moves" if origin.moving is not None else "has zones watch"
                message = (
                    f"{origin.name} {does} {{{name}}}, a frame of {of}, but {' or '.join(on) or NOBODY} is "
                    "on the flange"
                )
                help_ = f"name a frame that is on the robot, such as {{FLANGE}}, or take {of} first"
                yield _finding("Y0954", message, origin, help_)
                break


def _finding(code: str, message: str, origin: hir.Origin, help_: str) -> Diagnostic:
    return Diagnostic(code, message, origin.source, origin.span, help_, place=origin.place)


_DOCK = "move {FLANGE} to the tool's place, or correct the place under [[tools]] in the cell.toml"
_AGREE = "end all branches with the same tool, or change the tool on each branch before it is used"
