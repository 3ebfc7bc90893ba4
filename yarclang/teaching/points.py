"""Points of motions that can be touched up, and the changes of their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from yarclang.assist.sketch import Sketch
from yarclang.assist.symbols import Symbol
from yarclang.assist.vocabulary import command_of
from yarclang.commands.spec import Values
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.semantics.names.scope import BASE
from yarclang.semantics.values.units import joint_kinds
from yarclang.syntax.ast import Number, Statement, Value, WayPoint, Word
from yarclang.teaching.edits import Draft, Edited, Program
from yarclang.teaching.holding import (
    Around,
    holding,
    joint_numbers,
    pose_numbers,
    position_numbers,
    units_of,
)
from yarclang.units import Kind

_DECLARED: Mapping[str, Values] = {
    "FRAME": Values.POSE_RPY,
    "FRAME_QUAT": Values.POSE_QUAT,
    "JOINTS": Values.JOINTS,
    "POSE": Values.POSE_RPY,
}


@dataclass(frozen=True, slots=True)
class Point:
    """A point that can be touched up. Its numbers are in a motion, or in a declaration that the motion names.

    Attributes:
        statement: the statement that contains the numbers.
        values: the numbers.
        meaning: what the numbers stand for, such as joint positions or a pose.
        symbol: the declaration, if it contains the numbers.
    """

    statement: Statement
    values: tuple[Number, ...]
    meaning: Values
    symbol: Symbol | None = None


def meanings(statement: Statement) -> tuple[Values, ...]:
    """Return the meaning of the values of each waypoint of a statement, such as joint positions or a pose.

    The result is empty if the statement is neither a motion nor a declaration with a position.
    """
    word = statement.name.name
    if statement.index is None and word in _DECLARED:
        return (_DECLARED[word],) * min(len(statement.waypoints), 1)
    found = command_of(word)
    if found is None:
        return ()
    spec, target, _ = found
    values = spec.targets.get(target)
    if values is None:
        return ()
    count, leading = len(statement.waypoints), spec.leading
    return (*leading[:count], *(values,) * (count - len(leading)))


def point_of(
    sketch: Sketch, statement: Statement, number: int = 0, meant: tuple[Values, ...] = ()
) -> Point | None:
    """Return the point that contains the numbers of a waypoint; None if it can't be touched up.

    Args:
        sketch: parsed structure of the text.
        statement: a motion, or a declaration of a frame, a pose or joints.
        number: number of the waypoint, from 1; 0 for the last one.
        meant: result of `meanings` for the statement, if it is already known.
    """
    meant = meant or meanings(statement)
    if not meant or not -1 <= number - 1 < len(meant):
        return None
    meaning, waypoint = meant[number - 1], statement.waypoints[number - 1]
    if meaning.is_delta:
        return None
    values = own_values(statement, waypoint)
    if len(values) == 1 and isinstance(word := values[0], Word):
        symbol = sketch.names.meant(word.name, False, statement.line)
        point = _declared(sketch, symbol, None)
        # A waypoint that is only a position uses only a part of the declared pose, so the pose isn't touched
        # up by it.
        return None if meaning is Values.POSITION else point
    if not all(isinstance(one, Number) for one in values) or not values:
        return None
    numbers = tuple(one for one in values if isinstance(one, Number))
    if (
        statement.index is not None
        and statement.base is not None
        and not any(one.value for one in numbers[:6])
    ):
        symbol = sketch.names.meant(statement.base.name, True, statement.line)
        if symbol is not None and len(statement.waypoints) == 1 and not meaning.is_quaternion:
            return _declared(sketch, symbol, None)
    return Point(statement, numbers, meaning)


def own_values(statement: Statement, waypoint: WayPoint) -> tuple[Value, ...]:
    """Return the values of a waypoint; for JOINTS and POSE, the values after the name."""
    if statement.index is None and statement.name.name in ("JOINTS", "POSE"):
        return waypoint.values[1:]
    return waypoint.values


def _declared(sketch: Sketch, symbol: Symbol | None, wanted: Values | None) -> Point | None:
    """Return the point that a declaration contains; None if the declaration is within a block, is replaced by
    a later one of the same name, or has values that aren't numbers.
    """
    if symbol is None or symbol.inside or sketch.names.declared(symbol.name, symbol.is_frame) is not symbol:
        return None
    statement = symbol.statement
    meaning = _DECLARED.get(statement.name.name)
    if meaning is None or wanted not in (None, meaning) or not statement.waypoints:
        return None
    values = own_values(statement, statement.waypoints[0])
    numbers = tuple(one for one in values if isinstance(one, Number))
    return Point(statement, numbers, meaning, symbol) if len(numbers) == len(values) else None


def touch_up(around: Around, line: int, joints: Array, number: int = 0) -> Edited:
    """Write the robot's present position into a motion, or into the declaration that the motion names.

    Args:
        around: the program.
        line: line of the motion or declaration.
        joints: (n,) present joint positions [rad or m].
        number: number of the waypoint, from 1; 0 for the last one.

    Raises:
        Trouble: the point can't be touched up; the message is the reason.
    """
    program = around.program
    statement = program.statement(line)
    point = point_of(program.sketch, statement, number)
    if point is None:
        raise Trouble(
            f"line {line} can't be touched up: {_why_not(program, statement, number)}",
            "teach a new motion, or change the line by hand",
            "taught",
        )
    wanted = _numbers(around, statement, point, joints)
    if len(wanted) != len(point.values):
        raise Trouble(
            f"line {point.statement.line} has {len(point.values)} values, {len(wanted)} are needed",
            "correct the line first",
            "taught",
        )
    draft = Draft(program)
    pairs = [(one, new) for one, new in zip(point.values, wanted, strict=True) if _differs(one, new)]
    for one, new in reversed(pairs):
        at, old = point.statement.line + one.place.row, one.place
        text = draft.content(at)
        draft.changed[at] = f"{text[: old.start - 1]}{new}{text[old.end - 1 :]}"
    return draft.finished(point.statement.line, _told(program, line, point, len(pairs)))


def _differs(one: Number, new: str) -> bool:
    """Return True if a number and a number that is given as text have different values."""
    return one.value != float(new)


def _told(program: Program, line: int, point: Point, changed: int) -> str:
    if not changed:
        return f"line {point.statement.line} already has the position of the robot"
    if point.symbol is None:
        return f"touched line {line} up"
    symbol = point.symbol
    uses = sum(one.symbol is symbol for one in program.sketch.names.uses)
    name = f"{{{symbol.name}}}" if symbol.is_frame else symbol.name
    others = f", which {uses} line{'s' * (uses != 1)} use{'s' * (uses == 1)}" if uses else ""
    return f"touched up the declaration of {name} in line {point.statement.line}{others}"


def _why_not(program: Program, statement: Statement, number: int) -> str:
    meant = meanings(statement)
    if not meant:
        return f"{statement.name.name} has no target"
    if not -1 <= number - 1 < len(meant):
        return f"it has {len(meant)} waypoints"
    if meant[number - 1].is_delta:
        return "its values are increments"
    values = own_values(statement, statement.waypoints[number - 1])
    if len(values) == 1 and isinstance(word := values[0], Word):
        symbol = program.sketch.names.meant(word.name, False, statement.line)
        if symbol is None:
            return f"{word.name} isn't declared in this file"
        return (
            f"{word.name} is a {'parameter' if symbol.kind == 'parameter' else 'name'} that isn't declared "
            "as numbers outside of blocks"
        )
    return "its target isn't written as numbers"


def _numbers(around: Around, asked: Statement, point: Point, joints: Array) -> list[str]:
    """Return new numbers for a point, so that it is at the robot's present position.

    Args:
        around: the program.
        asked: the motion or declaration that the user has selected.
        point: the point.
        joints: (n,) present joint positions [rad or m].
    """
    statement, line = point.statement, point.statement.line
    is_declaration = statement.index is None and statement.name.name in _DECLARED
    holds = holding(around.program, line, declares=is_declaration)
    own = {**holds.units, **units_of(statement)}

    def units(*kinds: Kind) -> dict[Kind, str]:
        return {kind: own.get(kind, holds.unit(kind)) for kind in kinds}

    if point.meaning.of_joints:
        return joint_numbers(around.robot, joints, units(*joint_kinds(around.robot)))
    used = asked if is_declaration and asked is not statement else None
    moving = holds.moving or around.tool
    if used is not None and used.moving is not None:
        moving = used.moving.name
    elif not is_declaration and statement.moving is not None:
        moving = statement.moving.name
    base = statement.base.name if statement.base else holds.base or BASE
    if is_declaration and used is None:
        frame = around.scope.frame(statement.moving.name) if statement.moving else None
        if frame is not None and frame.on_flange:
            raise Trouble(
                f"line {line} declares a tool, whose frame isn't set by the robot's position",
                "calibrate the tool, or change the line by hand",
                "taught",
            )
    pose = around.pose(joints, moving, base, line)
    if point.meaning is Values.POSITION:
        return position_numbers(pose[:3, 3], units("length"))
    return pose_numbers(pose, units("length", "angle"), quaternion=point.meaning.is_quaternion)
