"""Declarations of taught frames and positions: the lines that declare them, the names that are allowed, and
where they are inserted in the text.
"""

from __future__ import annotations

import re

from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.semantics.declared.meanings import FIXED_FRAMES, is_word
from yarclang.semantics.names.scope import BASE
from yarclang.semantics.values.units import joint_kinds
from yarclang.syntax.ast import Block, Statement
from yarclang.syntax.words import DECLARATIONS
from yarclang.teaching.changing import change
from yarclang.teaching.edits import Draft, Edited, Program
from yarclang.teaching.holding import Around, Holding, holding, joint_numbers, pose_numbers
from yarclang.teaching.indices import indentation
from yarclang.units import Kind

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}")


def declare(around: Around, what: str, name: str, joints: Array) -> Edited:
    """Insert a declaration of the robot's present position as a frame, a pose or a joint position.

    Args:
        around: the program.
        what: "frame", "pose" or "joints".
        name: name of the declaration.
        joints: (n,) present joint positions [rad or m].

    Raises:
        Trouble: the name can't be declared, or a frame isn't known.
    """
    draft = Draft(around.program)
    after = put_declaration(draft, around, what, name, joints, around.program.size + 1)
    upper = name.strip("{} ").upper()
    shown = f"{{{upper}}}" if what == "frame" else upper
    return draft.finished(draft.new_line(after), f"declared {shown} where the robot stands")


def declare_pose(around: Around, name: str, pose: Array, parent: str, *, again: bool = False) -> Edited:
    """Insert a declaration of a frame with a given pose.

    Args:
        around: the program.
        name: name of the frame.
        pose: parent_from_frame (4, 4) [m].
        parent: the frame to which the new frame is fixed.
        again: True to change the values of an existing FRAME line of this name.

    Raises:
        Trouble: the name can't be declared.
    """
    program = around.program
    upper = name.strip("{} ").upper()
    own = program.sketch.names.declared(upper, True)
    if again and own is not None:
        statement = own.statement
        if statement.name.name != "FRAME" or own.kind != "frame":
            what = f"{{{upper}}} is declared by {statement.name.name} in line {statement.line}"
            raise Trouble(what, "change that line by hand, or choose another name", "name")
        numbers = pose_numbers(pose, {"length": "mm", "angle": "deg"})
        fields = dict(zip(("x", "y", "z", "roll", "pitch", "yaw"), numbers, strict=True))
        return change(
            program, statement.line, {**fields, "units": "mm,deg", "base": parent}, around.robot.joint_names
        )
    check_name(around, upper, is_frame=True)
    draft = Draft(program)
    after = place_of_declarations(program, program.size + 1)
    holds = holding(program, after + 1, declares=True)
    units: dict[Kind, str] = {kind: holds.unit(kind) for kind in ("length", "angle")}
    named = () if holds.base == parent else (f"{{{parent}}}",)
    text = " ".join(("FRAME", f"{{{upper}}}", *pose_numbers(pose, units), *units_part(units, holds), *named))
    draft.add(after, indentation(program, after) + text)
    return draft.finished(draft.new_line(after), f"declared {{{upper}}}")


def put_declaration(draft: Draft, around: Around, what: str, name: str, joints: Array, line: int) -> int:
    """Add a declaration of the robot's present position below the program's other declarations.

    Args:
        draft: the changes.
        around: the program.
        what: "frame", "pose" or "joints".
        name: name of the declaration.
        joints: (n,) present joint positions [rad or m].
        line: first line that uses the declaration.

    Returns:
        The number of the line after which the declaration is inserted.

    Raises:
        Trouble: the name can't be declared, or a frame isn't known.
    """
    program = draft.program
    name = check_name(around, name, is_frame=what == "frame", of_pose=what == "pose")
    after = place_of_declarations(program, line)
    holds = holding(program, after + 1, declares=True)
    if what == "joints":
        text = joints_line(around, name, joints, holds)
    else:
        head = f"FRAME {{{name}}}" if what == "frame" else f"POSE {name}"
        text = place_line(around, head, joints, holds, after + 1)
    draft.add(after, indentation(program, after) + text)
    return after


def check_name(around: Around, name: str, *, is_frame: bool, of_pose: bool = False) -> str:
    """Return a name in upper case if it can be declared.

    Args:
        around: the program.
        name: the wanted name.
        is_frame: True for the name of a frame.
        of_pose: True for the name of a pose, which may be P and digits.

    Raises:
        Trouble: the name can't be declared.
    """
    name = name.strip("{} " if is_frame else " ")
    upper = name.upper()
    if _NAME.fullmatch(name) is None:
        raise Trouble(
            f"{name[:60]!r} is no name",
            "a name is made of letters, digits and _, and begins with a letter",
            "name",
        )
    if (is_frame and upper in FIXED_FRAMES) or (not is_frame and is_word(upper, of_pose=of_pose)):
        raise Trouble(f"{upper} is a word of the language", "choose another name", "name")
    for one in around.program.sketch.names.symbols:
        if one.name == upper and one.is_frame == is_frame:
            raise Trouble(
                f"{upper} is declared already, in line {one.span.line}",
                "choose another name, or touch up that line",
                "name",
            )
    known = around.scope.frame(upper) if is_frame else around.scope.name(upper)
    if known is not None:
        raise Trouble(f"{upper} is declared already, by the robot or its cell", "choose another name", "name")
    return upper


def place_of_declarations(program: Program, line: int) -> int:
    """Return the number of the line after which a new declaration is inserted. The declaration is inserted
    after the other declarations and before the first command.

    Args:
        program: the program.
        line: first line that uses the declaration.
    """
    after = 0
    for node in program.sketch.nodes:
        if isinstance(node, Block) or not _is_declaration(node) or node.line >= line:
            break
        after = node.line + node.rows - 1
    if after:
        return after
    first = next((one.line for one in program.sketch.module.statements), program.size + 1)
    comments = {number for number, _ in program.sketch.module.comment_lines}
    while after + 1 in comments and after + 1 < min(first, line):
        after += 1
    # A comment directly above the first command may belong to this command.
    return after if after + 1 != first else 0


def _is_declaration(statement: Statement) -> bool:
    return statement.index is None and statement.name.name in DECLARATIONS


def joints_line(around: Around, name: str, joints: Array, holds: Holding) -> str:
    """Return the line `JOINTS NAME ...` that declares joint positions. Units that DEFAULT gives are left out.

    Args:
        around: the program.
        name: name of the declaration.
        joints: (n,) joint positions [rad or m].
        holds: values from DEFAULT that the line may omit.
    """
    kinds = joint_kinds(around.robot)
    units = {kind: holds.unit(kind) for kind in kinds}
    numbers = joint_numbers(around.robot, joints, units)
    return " ".join(("JOINTS", name, *numbers, *units_part(units, holds)))


def place_line(around: Around, head: str, joints: Array, holds: Holding, line: int) -> str:
    """Return the line `FRAME {NAME} ...` or `POSE NAME ...` that declares the tool's pose in the base frame
    of the line.

    Args:
        around: the program.
        head: the first words of the line: FRAME or POSE, and the name.
        joints: (n,) present joint positions [rad or m].
        holds: values from DEFAULT that the line may omit.
        line: number of the line.

    Raises:
        Trouble: a frame isn't known in the line.
    """
    base, moving = holds.base or BASE, holds.moving or around.tool
    units: dict[Kind, str] = {kind: holds.unit(kind) for kind in ("length", "angle")}
    numbers = pose_numbers(around.pose(joints, moving, base, line), units)
    named = () if holds.base else (f"{{{base}}}",)
    return " ".join((head, *numbers, *units_part(units, holds), *named))


def units_part(units: dict[Kind, str], holds: Holding) -> tuple[str, ...]:
    """Return the units that DEFAULT doesn't give, as one text in brackets; empty if DEFAULT gives all of
    them.
    """
    needed = [unit for kind, unit in units.items() if kind not in holds.units]
    return (f"({','.join(needed)})",) if needed else ()
