"""Compute what the robot does when it carries out a controller text, command by command: the curves of the
motions, and the actions between the motions.

Only the controller text is used, and the certificate's own parser reads it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from yarclang.certify.read.reader import reader_of
from yarclang.certify.read.text import Barred, ControllerText, Dwelt, Entry, Put, Run, Stood, Unreadable
from yarclang.decisions import SHIFTS, Shifted, Watch
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.lasting import NO_TIME, Lasting
from yarclang.memory import NO_MEMORY
from yarclang.motion.curve import Curve
from yarclang.pipeline.line_map import LineMap, map_lines
from yarclang.progress import tell
from yarclang.robot.model import Array, Robot
from yarclang.source import SourceFile
from yarclang.units import MS

Kind = Literal[
    "motion",
    "dwell",
    "set",
    "wait",
    "hold",
    "when",
    "else",
    "end",
    "stop",
    "abort",
    "say",
    "loop",
    "next",
    "exit",
    "endloop",
]


@frozen(eq=False)
class Act:
    """The robot's action for one command.

    Attributes:
        what: description of a command without motion, for people and for comparison.
        curve: the executed motion [rad or m]; None for a command without motion.
        duration: duration of the command [s], as far as it is known in advance.
        step: number of the command in the program; -1 if the controller text doesn't contain it.
        carries: parts that grippers hold during a motion; None if unknown.
        may_touch: pairs of bodies that may touch during the motion.
        keeps: rules of KEEP that apply to the motion.
    """

    kind: Kind
    place: str
    name: str
    source_line: int
    what: str = ""
    curve: Curve | None = None
    duration: float = 0.0
    step: int = -1
    carries: tuple[str, ...] | None = None
    may_touch: tuple[str, ...] = ()
    keeps: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Return a title such as `P0010 MOVEL`, or the name alone if there is no index."""
        return f"{self.place} {self.name}" if self.place else self.name


@frozen(eq=False)
class Executed:
    """All actions of a controller text, in order.

    Attributes:
        start: (n,) [rad or m] joint positions before the first action.
        lasting: duration of all actions.
        watches: inputs that hold the robot during its motions.
    """

    name: str
    robot: Robot
    start: Array
    acts: tuple[Act, ...]
    lasting: Lasting = NO_TIME
    watches: tuple[Watch, ...] = ()

    @property
    def duration(self) -> float:
        """Return the total time of all motions and dwells [s]; of several branches, the longest counts.
        Waiting for inputs isn't included.
        """
        return self.lasting.most


def executed(
    text: str, robot: Robot, name: str, carried: Mapping[int, tuple[str, ...]] | None = None
) -> Result[Executed]:
    """Compute the actions of a controller text.

    Args:
        text: a text of yarcc.
        robot: the robot that the text is for.
        name: name of the text in messages.
        carried: parts that grippers hold during each motion, by the number of its step, from the certificate;
            None if unknown.

    Returns:
        None, with a finding, if the text isn't one that yarcc writes for this robot's controller.
    """
    tell("reading the controller's text", 0)
    reader = reader_of(robot.controller)
    content = reader.read(text, robot.controller, NO_MEMORY)
    if isinstance(content, Unreadable):
        message = f"line {content.line} {content.reason}"
        help_ = "the text was changed after yarcc wrote it: compile the program again"
        return Result(None, (Diagnostic(content.code, message, SourceFile(name, text), help=help_),))
    start = reader.start(content, robot).q
    acts = tuple(_acts(content, map_lines(text), robot, start))
    if carried is not None:
        acts = tuple(
            replace(act, carries=carried.get(act.step, ())) if act.curve is not None else act for act in acts
        )
    allowed = {
        keep.step: [each for each in content.allows if each.step == keep.step] for keep in content.allows
    }
    acts = tuple(
        replace(act, may_touch=tuple(f"{keep.first} and {keep.second}" for keep in allowed[act.step]))
        if act.step in allowed and act.curve is not None
        else act
        for act in acts
    )
    rules: dict[int, tuple[str, ...]] = {}
    for keep in content.keeps:
        rules[keep.step] = (*rules.get(keep.step, ()), keep.rule)
    acts = tuple(
        replace(act, keeps=rules[act.step]) if act.step in rules and act.curve is not None else act
        for act in acts
    )
    return Result(Executed(name, robot, start, acts, content.schedule.lasting, content.watches))


def _acts(content: ControllerText, mapped: LineMap, robot: Robot, start: Array) -> list[Act]:
    entries = {entry.step: entry for entry in content.entries}
    offsets = {one.step: one for one in content.offsets}
    moving = [entry for entry in content.entries if entry.first is not None]
    stand, acts = start, []
    for item in content.course:
        match item:
            case Run():
                acts += _motions(item, moving, stand, robot)
                stand = item.points[-1] * robot.axis_units
            case Stood(point=point):
                stand = point * robot.axis_units
            case Barred():
                acts.append(_barrier(item, entries[item.step], offsets.get(item.step)))
            case Dwelt(line=line, milliseconds=milliseconds) if milliseconds > 0.0:
                acts.append(
                    _between(mapped, line, "dwell", f"stands for {milliseconds:g} ms", milliseconds * MS)
                )
            case Put(line=line, variable=variable, value=value):
                acts.append(_between(mapped, line, "set", f"{variable} becomes {value:g}"))
    return acts


def _motions(run: Run, moving: list[Entry], stand: Array, robot: Robot) -> list[Act]:
    """Return one action for each command in an uninterrupted sequence of moves. The entries of these commands
    are removed from the front of `moving`.

    The control points of a sequence that starts at S are S, S, S, c1 ... cM, cM, cM.
    """
    points = run.points * robot.axis_units
    control = np.concatenate((np.tile(stand, (3, 1)), points, np.tile(points[-1], (2, 1))))
    acts: list[Act] = []
    place = segment = 0
    while place < len(run.lines) and moving:
        entry = moving.pop(0)
        behind = int(np.searchsorted(run.lines, entry.last or 0, side="right"))
        size = behind - place + (2 if behind == len(run.lines) else 0)
        if size < 1:
            break
        curve = Curve(control[segment : segment + size + 3], run.segment_ms * MS, np.empty(0))
        duration = size * run.segment_ms * MS
        acts.append(
            Act("motion", entry.index, entry.name, entry.source_line, "", curve, duration, entry.step)
        )
        place, segment = behind, segment + size
    return acts


def _barrier(item: Barred, entry: Entry, offset: Shifted | None) -> Act:
    late = "" if item.timeout is None else f", after {item.timeout:g} s the other branch"
    subject = {
        "wait": f"waits for {item.name} ({item.condition}), "
        + ("without a time limit" if item.timeout is None else f"at most {item.timeout:g} s"),
        "hold": f"holds for the operator: {item.name}" if item.name else "holds for the operator",
        "when": f"the program branches at {item.name} ({item.condition}){late}",
        "else": "the other branch",
        "end": "the branches meet",
        "loop": "a loop begins",
        "next": "the loop repeats",
        "exit": "the loop is left",
        "endloop": "the loop ends",
        "set": item.name,
        "stop": "the program ends",
        "say": f"tells the operator: {item.name}",
        "abort": f"the program ends as a fault: {item.name}",
    }[item.kind]
    if offset is not None:
        both = zip(SHIFTS, offset.registers, strict=True)
        shifts = ", ".join(f"{axis} {register}" for axis, register in both if register)
        subject = f"{{{offset.frame}}} is shifted by {shifts}"
    place, name, line = entry.index, entry.name, entry.source_line
    return Act(item.kind, place, name, line, subject, step=item.step)  # type: ignore[arg-type]


def _between(mapped: LineMap, line: int, kind: Kind, subject: str, duration: float = 0.0) -> Act:
    stretch = mapped.at(line)
    command = stretch.command if stretch is not None else None
    if command is None:
        return Act(kind, "", kind.upper(), 0, subject, None, duration)
    return Act(kind, command.index, command.name, command.source_line, subject, None, duration, command.step)
