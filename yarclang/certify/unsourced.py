"""Judgement of a controller text without its program: what the text's map says about the program, and a note
about what cannot be judged.
"""

from __future__ import annotations

import math

from yarclang import hir
from yarclang.cell.model import Cell
from yarclang.certify.read.reader import reader_of
from yarclang.certify.read.text import Barred, ControllerText, assignments_of
from yarclang.diagnostics import Diagnostic
from yarclang.findings import Severity
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span

_MOST = 4
"""Largest number of items of one kind that a note lists. If there are more, the note states how many."""


def told_program(
    content: ControllerText, robot: Robot, source: SourceFile, cell: Cell | None = None
) -> hir.Program:
    """Return a program with what the map of a controller text states: the commands, the branches, and which
    commands move.

    Args:
        content: the controller text, as the judge has read it.
        robot: the robot that the text is for.
        source: the file that findings refer to.
        cell: the robot's surroundings.
    """
    start = reader_of(robot.controller).start(content, robot).q
    barriers = {item.step: item for item in content.course if isinstance(item, Barred)}
    steps: list[hir.Step] = []
    for entry in content.entries:
        origin = hir.Origin(entry.index, entry.name, source, Span.on_line(entry.source_line, 1, 2))
        if entry.first is None:
            # The map gives the names of commands without lines, but not their details. Barriers such as the
            # end of the program are in the text itself.
            barrier = barriers.get(entry.step)
            steps.append(_way(origin, barrier) or hir.SetOutput(origin, hir.Signal("", ""), 0.0))
            continue
        goal = hir.JointGoal(start)  # a placeholder: the path is not judged
        blend = None if entry.blend is None else hir.Reading(math.inf, math.inf)
        steps.append(hir.JointMove(origin, goal, "", hir.Timing(None), blend=blend))
    return hir.Program(
        source, start, tuple(steps), cell=cell, registers=content.registers, watches=content.watches
    )


def _way(origin: hir.Origin, barrier: Barred | None) -> hir.Step | None:
    """Return the step of a barrier, such as a branch, a loop or a wait; None for other commands."""
    signal = hir.Signal("", "")
    match barrier:
        case Barred(kind="when", decided=decided, again=again, timeout=within) if decided is not None:
            return hir.When(origin, decided, again, within)
        case Barred(kind="set", decided=decided, register=register, output=output) if decided is not None:
            return hir.Assign(origin, register or hir.Signal(output, output), decided)
        case Barred(kind="else"):
            return hir.Else(origin)
        case Barred(kind="end"):
            return hir.EndWhen(origin)
        case Barred(kind="loop"):
            return hir.Loop(origin)
        case Barred(kind="next"):
            return hir.NextPass(origin)
        case Barred(kind="exit"):
            return hir.Exit(origin)
        case Barred(kind="endloop"):
            return hir.EndLoop(origin)
        case Barred(kind="stop" | "abort" as kind, name=text):
            return hir.Finish(origin, kind == "abort", text)
        case Barred(kind="say", name=text):
            return hir.Say(origin, text)
        case Barred(kind="hold"):
            return hir.Hold(origin, "", barrier.register)
        case Barred(kind="wait", decided=decided, timeout=timeout) if decided is not None:
            return hir.WaitUntil(origin, decided, timeout)
        case Barred(kind="wait"):
            return hir.WaitInput(origin, signal, 0.0, None)
    return None


def unjudged(content: ControllerText, source: SourceFile, cell: Cell | None) -> Diagnostic:
    """Return a note that lists what cannot be judged without the program.

    The note is a warning if the list contains a condition, a register or an output.

    Args:
        content: the controller text, as the judge has read it.
        source: the file that the note refers to.
        cell: the robot's surroundings, if known.
    """
    missing = ["its path and times"]
    if cell is None:
        missing.append("its surroundings")
    elif cell.zones:
        missing.append("which frame is the tool that zones watch ({TCP} was taken)")
    if cell is not None and cell.parts:
        missing.append("its parts, which grippers carry")
    if cell is not None and cell.tools:
        missing.append("which tool is on the flange")
    if free := [entry.at for entry in content.entries if entry.any_jerk]:
        missing.append(
            f"the jerk of {len(free)} commands"
            if len(free) > 1
            else f"the jerk of the command in line {free[0]}"
        )
    conditions = [
        f"'{item.condition}' in line {item.line}"
        for item in content.course
        if isinstance(item, Barred) and item.condition != "-" and item.kind not in ("set", "hold")
    ]
    counted = [f"line {item.line}" for item in content.course if isinstance(item, Barred) and item.register]
    if conditions:
        missing.append(f"what it waits for ({_listed(conditions)})")
    if content.watches:
        missing.append(f"what it watches ({_listed([one.name for one in content.watches])})")
    if content.searches:
        missing.append(f"what it searches for ({_listed([one.name for one in content.searches])})")
    if content.offsets:
        frames = [f"{{{one.frame}}} in step {one.step}" for one in content.offsets]
        missing.append(f"what is shifted when it runs ({_listed(frames)})")
    if content.allows:
        pairs = dict.fromkeys(f"{one.first} and {one.second}" for one in content.allows)
        missing.append(f"which bodies may touch ({_listed([*pairs])})")
    if counted:
        missing.append(f"its registers ({_listed(counted)})")
    outputs = [
        f"'{item.condition}' in line {item.line}"
        for item in content.course
        if isinstance(item, Barred) and item.output
    ]
    outputs += [
        f"{variable}={value:.9g} in " + ("the PLC of safe values" if line is None else f"line {line}")
        for line, variable, value in assignments_of(content)
    ]
    if outputs:
        missing.append(f"its outputs ({_listed(outputs)})")
    message = f"judged without its program, {content.header.source}: not judged are {_joined(missing)}"
    help_ = "put the program beside this text"
    if cell is None:
        help_ += "; --cell FILE says what is around the robot"
    level: Severity | None = "warning" if conditions or counted or outputs else None
    return Diagnostic("Y1193", message, source, help=help_, level=level)


def _listed(items: list[str]) -> str:
    more = f" and {len(items) - _MOST:,} more" if len(items) > _MOST else ""
    return ", ".join(items[:_MOST]) + more


def _joined(items: list[str]) -> str:
    return items[0] if len(items) == 1 else ", ".join(items[:-1]) + " and " + items[-1]
