"""Describe declared names in hover texts, in Markdown."""

from __future__ import annotations

from pathlib import PurePath

import numpy as np

from yarclang.assist.pose_lines import chain_lines, joints_text
from yarclang.assist.sketch import Sketch
from yarclang.assist.symbols import Symbol, Use
from yarclang.assist.view import View
from yarclang.assist.vocabulary import FRAMES, entry_text
from yarclang.decisions import Register, shown_variable
from yarclang.hir import Array, FrameLink, Gap, Output
from yarclang.report.inspection.inspected import chain_of
from yarclang.report.module_text import SubText, describe_module
from yarclang.report.pose_text import pose_text
from yarclang.semantics.names.scope import (
    Formula,
    Frame,
    Input,
    JointPosition,
    Named,
    Pose,
    RackTool,
    Scope,
    Table,
)
from yarclang.semantics.values.amounts import Amount
from yarclang.syntax.print import print_expression

_CALLED = {
    "frame": "a frame",
    "number": "a number",
    "table": "a table",
    "function": "a function",
    "joints": "a joint position",
    "register": "a register",
    "pose": "a pose",
    "input": "an input",
    "output": "an output",
    "sub": "a SUB",
    "module": "a module",
    "parameter": "a parameter",
}


def meaning_of(view: View, named: Symbol | Use, line: int) -> list[str]:
    """Return the paragraphs of a hover text that explain a name declared or used in a line; empty if the name
    is unknown.
    """
    symbol = named if isinstance(named, Symbol) else named.symbol
    if isinstance(named, Use) and named.module:
        return _of_module(view, named, line)
    if symbol is not None:
        return _of_symbol(view, view.sketch, symbol)
    return _from_outside(view, named.name, named.is_frame)


def _of_symbol(view: View, sketch: Sketch, symbol: Symbol) -> list[str]:
    """Describe a name that this file or one of its modules declares."""
    title = f"{{{symbol.name}}}" if symbol.is_frame else symbol.name
    if symbol.kind == "sub":
        return sub_lines(sketch, symbol.name)
    if symbol.kind == "module":
        module = view.module(symbol.name)
        return module_lines(module) if module else [f"**{title}**: a module that can't be read"]
    lines = [f"**{title}**: {_CALLED[symbol.kind]}", "", *_code(sketch, symbol)]
    own = sketch is view.sketch
    if symbol.is_frame:
        link = _link(view, symbol, sketch) if symbol.kind == "frame" else None
        return [*lines, *chain_lines(link)] if link else lines
    scope = view.scope if own else None
    meaning = scope.declared(symbol.name) if scope and not symbol.inside else None
    return [*lines, *_value(view, meaning)]


def _of_module(view: View, use: Use, line: int) -> list[str]:
    """Describe a name in a module: the word after the dot of `PALLET.GRID`."""
    symbol = view.sketch.names.meant(use.module, False, line)
    module = view.module(use.module) if symbol and symbol.kind == "module" else None
    found = module.names.meant_by(use) if module else None
    if module is None or found is None:
        return []
    lines = _of_symbol(view, module, found)
    if found.is_frame and view.scope:
        frame = view.scope.frame(f"{use.module}.{use.name}")
        lines += list(chain_lines(frame.link)) if frame and frame.link else []
    return lines


def _from_outside(view: View, name: str, is_frame: bool) -> list[str]:
    """Describe a name of the robot or the cell."""
    if is_frame:
        frame = _known_frame(view, name)
        if frame is not None and frame.link is not None:
            file = frame.link.source
            told = [f"**{{{name}}}**: a frame of {PurePath(file.name).name}"] if file else []
            told = told or [
                entry_text(f"{{{name}}}", FRAMES[name])
                if name in FRAMES
                else f"**{{{name}}}**: a frame of the robot"
            ]
            return [*told, "", *chain_lines(frame.link)]
        return [entry_text(f"{{{name}}}", FRAMES[name])] if name in FRAMES else []
    robot = view.robot
    meaning = view.scope.name(name) if view.scope else None
    if meaning is None and robot is not None and name in robot.positions:
        meaning = JointPosition(robot.positions[name])
    if meaning is None:
        return []
    where = view.scope.where(name) if view.scope else None
    whose = f" of {PurePath(where.source.name).name}" if where else " of the robot"
    return [f"**{name}**: {_kind(meaning)}{whose}", "", *_value(view, meaning)]


def _known_frame(view: View, name: str) -> Frame | None:
    if view.scope is not None:
        return view.scope.frame(name)
    return Scope.of_robot(view.robot).frame(name) if view.robot is not None else None


def _kind(meaning: Named) -> str:
    from yarclang.semantics.names.scope import KINDS

    return KINDS[type(meaning)]


def _value(view: View, meaning: Named | None) -> list[str]:
    match meaning:
        case Amount():
            return [f"- is {meaning}"]
        case Table(sizes=(size,)):
            return [f"- has {size} number{'s' * (size > 1)}, with the indices 0 to {size - 1}"]
        case Table(sizes=(rows, columns)):
            return [f"- has {rows} rows of {columns} numbers: the row's index first, both from 0"]
        case Formula(parameters=parameters, body=body):
            given = ", ".join(name + (f" ({unit.name})" if unit else "") for name, unit in parameters)
            return [f"- of {given}: `{print_expression(body)}`"]
        case JointPosition(q=q) if view.robot is not None:
            lines = [f"- {joints_text(view.robot, q)}"]
            if "TCP" in view.robot.flange_from_frame:
                from yarclang.robot.kinematics.fk import tool_poses

                pose = tool_poses(view.robot.chain, q[None], view.robot.flange_from_frame["TCP"])[0]
                lines.append(f"- `{{TCP}}` in `{{B}}`: {pose_text(pose)}")
            return lines
        case Pose(transform=transform, link=link):
            lines = []
            if link is not None and link.parent is not None:
                inside: Array = np.linalg.inv(_base_from(link)) @ transform
                lines.append(f"- in `{{{link.name}}}`: {pose_text(inside)}")
            return [*lines, f"- in `{{B}}`: {pose_text(transform)}", *(chain_lines(link) if link else ())]
        case Input(signal):
            return [f"- reads {shown_variable(signal.variable)} of the controller"]
        case Register(low=low, high=high, first=first):
            return [f"- an integer from {low} to {high} that begins with {first}"]
        case Output(signal, safe):
            kept = "stays at a stop" if safe is None else f"{safe:g} at any stop, hold or fault"
            return [f"- sets {shown_variable(signal.variable)} of the controller; {kept}"]
        case RackTool(lock=lock):
            return [f"- a tool of the cell; {lock.name} ({shown_variable(lock.variable)}) locks it"]
        case _:
            return []


def _base_from(link: FrameLink) -> Array:
    """Return base_from_frame (4, 4) of a fixed frame."""
    transform: Array = link.parent_from_frame
    while (parent := link.parent) is not None:
        link, transform = parent, parent.parent_from_frame @ transform
    return transform


def _link(view: View, symbol: Symbol, sketch: Sketch) -> FrameLink | None:
    """Return the frame that a line declares, with its parents. If the line is in a block, the frame is found
    by a command that uses it.
    """
    if view.scope is not None and sketch is view.sketch:
        frame = view.scope.frame(symbol.name)
        if frame and frame.link and frame.link.span and frame.link.span.line == symbol.statement.line:
            return frame.link
    for step in view.program.steps if view.program else ():
        if isinstance(step, Gap):
            continue
        for end in (step.origin.moving, step.origin.base):
            for link in chain_of(end):
                same = link.span is not None and link.span.line == symbol.statement.line
                if (
                    same
                    and link.name == symbol.name
                    and link.source
                    and link.source.name == sketch.source.name
                ):
                    return link
    return None


def _code(sketch: Sketch, symbol: Symbol) -> list[str]:
    """Return the lines that declare a name."""
    first = symbol.statement.line
    rows = [sketch.source.line(first + row).strip() for row in range(symbol.statement.rows)]
    return ["```yarc", *rows, "```", ""]


def described_sub(sketch: Sketch, name: str) -> SubText | None:
    """Return the comment above a SUB, parsed; None without one."""
    return next((one for one in describe_module(sketch.module).subs if one.name == name), None)


def sub_lines(sketch: Sketch, name: str) -> list[str]:
    """Return the description of a SUB from its head and its comment, in Markdown."""
    sub = described_sub(sketch, name)
    if sub is None:
        return []
    lines = ["```yarc", f"SUB {sub.head}", "```", ""]
    lines += [sub.purpose, ""] if sub.purpose else []
    lines += [f"- `{one.name}`: {one.meaning}" for one in sub.parameters if one.meaning]
    return lines


def module_lines(sketch: Sketch) -> list[str]:
    """Return the description of a module, with one line for each of its SUBs, in Markdown."""
    module = describe_module(sketch.module)
    lines = [f"**{module.name}**: a module", "", *(f"{one}\n" for one in module.paragraphs)]
    return [*lines, *(f"- `{module.name}.{sub.head}`: {sub.purpose}" for sub in module.subs)]
