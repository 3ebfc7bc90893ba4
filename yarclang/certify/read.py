"""Reads the controller text that yarcc emits, and nothing else.

The judge has a reader of its own: what a writer believes to have written is no evidence. Every
line must have the one form that is allowed in its place, so that no line can do what nobody checked.
"""

from __future__ import annotations

import re

import numpy as np

from yarclang.certify.course import CONDITION, read_course, why_worse
from yarclang.certify.cursor import Cursor, Refusal, shown
from yarclang.certify.text import Barred, ControllerText, Entry, Start, Target, Unreadable
from yarclang.memory import NO_MEMORY, Memory
from yarclang.robot.model import Controller

_TARGET = re.compile(r"; target (rotary|prog)")
_ENTRY = re.compile(
    r"; command ([0-9]+) (\S+) (\S+) ([0-9]+) (?:([0-9]+) ([0-9]+)(?: blend ([0-9]{1,6}))?|- -)"
)
_BARRIER = re.compile(r"; barrier ([0-9]+) (wait|hold|when|else|end) ([0-9]+) (\S+) (\S+) (.*)")
_PLAIN = r"([0-9]{1,15}(?:\.[0-9]{1,12})?)"
_COMPARE = re.compile(rf"IF\(ABS\(M([0-9]+)61([-+])(\(-)?{_PLAIN}(\))?\)>{_PLAIN}\)")


def read(text: str, controller: Controller, memory: Memory = NO_MEMORY) -> ControllerText | Unreadable:
    """Read a whole text.

    Args:
        text: what yarcc emitted.
        controller: whose axes, motors and coordinate system the text must name.
        memory: keeps what move lines say, by their very text.

    Returns:
        What it says, or the first place that isn't what yarcc emits.
    """
    if not text.isascii():
        line = next(i for i, content in enumerate(text.split("\n"), 1) if not content.isascii())
        return Unreadable(line, "has a character that isn't ASCII")
    if not text.endswith("\n"):
        return Unreadable(text.count("\n") + 1, "doesn't end with a line feed")
    cursor = Cursor(text, controller, memory)
    try:
        return _read(cursor, controller)
    except Refusal as refusal:
        return Unreadable(*refusal.args)


def _read(cursor: Cursor, controller: Controller) -> ControllerText:
    target, entries, barriers = _read_header(cursor)
    system = f"&{controller.coordinate_system}"
    cursor.expect("CLOSE ALL", "END GATHER", "DELETE GATHER")
    outputs = _read_outputs(cursor)
    cursor.expect(system)
    start = (_read_rotary_start if target == "rotary" else _read_prog_start)(cursor, controller)
    cursor.expect("SPLINE1")
    course = read_course(cursor, barriers, target, controller.coordinate_system)
    cursor.skip_remarks()
    if not cursor.at_end:
        cursor.refuse(f"is {shown(cursor.peek())} behind CLOSE" + why_worse(cursor.peek()))
    return ControllerText(target, entries, start, course, outputs, cursor.decimals)


def _read_header(cursor: Cursor) -> tuple[Target, tuple[Entry, ...], dict[int, Barred]]:
    target: Target | None = None
    entries: list[Entry] = []
    barriers: dict[int, Barred] = {}
    while (line := cursor.peek()).startswith(";"):
        if found := _ENTRY.fullmatch(line):
            step, index, name, source_line, first, last, blend = found.groups()
            entries.append(
                Entry(
                    cursor.line,
                    int(step),
                    "" if index == "-" else index,
                    name,
                    int(source_line),
                    int(first) if first else None,
                    int(last) if last else None,
                    int(blend) if blend else None,
                )
            )
        elif found := _TARGET.fullmatch(line):
            if target is not None:
                cursor.refuse("names the target a second time")
            target = "rotary" if found[1] == "rotary" else "prog"
        elif found := _BARRIER.fullmatch(line):
            timeout = None if found[5] == "-" else float(found[5])
            barriers[int(found[1])] = Barred(
                int(found[1]), found[2], int(found[3]), found[4], timeout, found[6].removeprefix("-")
            )
        elif re.match(r"; *(command|target|barrier)\b", line):
            cursor.refuse(f"is no line of the map: {shown(line)}")
        cursor.skip()
    if target is None:
        cursor.refuse("the header names no target")
    return target, tuple(entries), barriers


def _read_outputs(cursor: Cursor) -> tuple[tuple[str, float], ...]:
    """A PLC that does nothing but give outputs their safe values when the guard has held the motion."""
    cursor.skip_remarks()
    if cursor.peek() != "OPEN PLC 28 CLEAR":
        return ()
    cursor.expect("OPEN PLC 28 CLEAR", "IF(P8100=2)")
    outputs: list[tuple[str, float]] = []
    while found := CONDITION.fullmatch(cursor.peek()):
        outputs.append((found[1], float(found[2])))
        cursor.skip()
    cursor.expect("ENDIF", "CLOSE", "ENABLE PLC 28")
    return tuple(outputs)


def _read_rotary_start(cursor: Cursor, controller: Controller) -> Start:
    cursor.expect("".join(f"#{motor}J/" for motor in controller.motors), "DELETE ROT")
    while re.fullmatch(r"I1[67]=[0-9]{1,6}", cursor.peek()):  # the marks of the buffer's guard
        cursor.skip()
    found = re.fullmatch(r"DEFINE ROT ([0-9]{1,9})", cursor.take())
    if found is None or int(found[1]) < controller.rotary_words:
        cursor.refuse(f"DEFINE ROT with at least {controller.rotary_words} words belongs here", back=1)
    cursor.expect("B0", "OPEN ROT", "CLEAR", "RAPID", "ABS")
    line = cursor.line
    point = cursor.block()
    if point is None or len(point) != 1:
        cursor.refuse("one move to the start belongs here")
    cursor.expect("DWELL0")
    return Start(line, rapid=point[0])


def _read_prog_start(cursor: Cursor, controller: Controller) -> Start:
    if re.fullmatch(r"OPEN PROG [1-9][0-9]{0,4} CLEAR", cursor.take()) is None:
        cursor.refuse("OPEN PROG with CLEAR belongs here", back=1)
    line = cursor.line
    cursor.expect("P8101=1", "WHILE(P8101=1)", "P8101=0")
    places, widths, steps = [], [], []
    for motor in controller.motors:
        compare = cursor.take()
        found = _COMPARE.fullmatch(compare)
        if found is None or int(found[1]) != motor or bool(found[3]) != bool(found[5]):
            cursor.refuse(f"the comparison of M{motor}61 with the start belongs here", back=1)
        # the register minus x: x is negative for a plus sign or one in parentheses
        negative = (found[2] == "+") != bool(found[3])
        places.append(-float(found[4]) if negative else float(found[4]))
        widths.append(float(found[6]))
        steps.append(10.0 ** -len(found[4].partition(".")[2]))
        cursor.expect("P8101=1")
        if re.fullmatch(r'SEND"[^"]*"', cursor.take()) is None:
            cursor.refuse("SEND with a text belongs here", back=1)
        cursor.expect("ENDIF")
    cursor.expect("IF(P8101=1)", "STOP", "ENDIF", "ENDWHILE", "ABS")
    return Start(line, guard=np.array(places), guard_width=np.array(widths), guard_step=np.array(steps))
