"""Reader of the controller texts that yarcc emits, and of no other texts.

The judge has a reader of its own: it must know what a text does, and not what its writer intended. Every line
must have the one form that is allowed in its place, so that no unchecked line can have an effect.
"""

from __future__ import annotations

import re

import numpy as np

from yarclang.certify.pmac.course import CONDITION, read_course, why_worse
from yarclang.certify.pmac.cursor import Cursor
from yarclang.certify.pmac.own import TM_STEPS_PER_MS, Guard, Marks, PmacText
from yarclang.certify.read.header import read_preamble
from yarclang.certify.read.lines import Refusal, check_characters, shown
from yarclang.certify.read.text import ControllerText, Sent, Start, Unreadable
from yarclang.emitted.header import Header
from yarclang.memory import NO_MEMORY, Memory
from yarclang.pmac.controller import TurboPmac
from yarclang.pmac.program import LOADING, Target
from yarclang.units import MS

_TARGET_LINE = 2

_LOW = re.compile(r"I16=([0-9]{1,6})")
_FULL = re.compile(r"I17=([0-9]{1,6})")
_DEFINE = re.compile(r"DEFINE ROT ([0-9]{1,9})")
_PLAIN = r"([0-9]{1,15}(?:\.[0-9]{1,12})?)"
_COMPARE = re.compile(rf"IF\(ABS\(M([0-9]+)61([-+])(\(-)?{_PLAIN}(\))?\)>{_PLAIN}\)")


def read(text: str, controller: TurboPmac, memory: Memory = NO_MEMORY) -> ControllerText | Unreadable:
    """Read a whole controller text.

    Args:
        text: the text that yarcc emitted.
        controller: defines the axes, motors and coordinate system that the text must name.
        memory: cache of parsed move lines, keyed by their text.

    Returns:
        The content, or the first line that differs from what yarcc emits.
    """
    cursor = Cursor(text, controller, memory)
    try:
        check_characters(text)
        return _read(cursor, controller)
    except Refusal as refusal:
        return Unreadable(*refusal.args)


def _read(cursor: Cursor, controller: TurboPmac) -> ControllerText:
    preamble = read_preamble(cursor)
    header, system = preamble.header, controller.coordinate_system
    target = _target(header)
    cursor.expect("CLOSE ALL", "END GATHER", "DELETE GATHER")
    outputs = _read_outputs(cursor)
    cursor.expect(f"&{system}")
    marks, guard, setup, loads = None, None, tuple[str, ...](), 0
    if target == "rotary":
        marks = _read_rotary(cursor, controller)
        setup = tuple(one.text for one in cursor.sent)
        cursor.expect("OPEN ROT", "CLEAR")
        loads = len(cursor.sent)
        start = _read_rotary_start(cursor)
    else:
        start, guard = _read_prog_start(cursor, controller)
    cursor.expect("SPLINE1")
    course, arms = read_course(cursor, preamble.barriers, target, system)
    if not cursor.at_end:
        cursor.refuse(f"is {shown(cursor.peek())} after CLOSE" + why_worse(cursor.peek()))
    loaded: tuple[Sent, ...] = tuple(cursor.sent[loads:-1]) if marks is not None else ()
    own = PmacText(marks, guard, arms, setup, loaded)
    return ControllerText(
        header,
        preamble.entries,
        start,
        course,
        outputs,
        cursor.decimals,
        MS / TM_STEPS_PER_MS,
        own,
        preamble.registers,
        preamble.watches,
        preamble.searches,
        preamble.offsets,
        preamble.allows,
        preamble.keeps,
    )


def _target(header: Header) -> Target:
    """Return the buffer for which the text is written, and check what its header says about loading it."""
    for target, loading in LOADING.items():
        form = re.escape(loading).replace(re.escape("{system}"), "[0-9]{1,2}")
        if header.target == target and re.fullmatch(form, header.loading):
            return target
    raise Refusal(
        _TARGET_LINE, f"has the target {shown(header.target)}, or another note on how it is loaded", "Y1151"
    )


def _read_outputs(cursor: Cursor) -> tuple[tuple[str, float], ...]:
    """Read the PLC that sets outputs to their safe values after the guard or the watchdog has stopped the
    motion.

    The PLC must do nothing else.
    """
    if cursor.peek() != "OPEN PLC 28 CLEAR":
        return ()
    cursor.expect("OPEN PLC 28 CLEAR", "IF(P8100=2 OR P8104=2)")
    outputs: list[tuple[str, float]] = []
    while found := CONDITION.fullmatch(cursor.peek()):
        outputs.append((found[1], float(found[2])))
        cursor.take()
    cursor.expect("ENDIF", "CLOSE", "ENABLE PLC 28")
    return tuple(outputs)


def _read_rotary(cursor: Cursor, controller: TurboPmac) -> Marks:
    """Read the definition of the rotary buffer, with the marks of its guard."""
    cursor.expect("".join(f"#{motor}J/" for motor in controller.motors), "DELETE ROT")
    low, full, words = (
        int(_expected(cursor, form, what)[1])
        for form, what in (
            (_LOW, "I16, the lines below which the guard holds,"),
            (_FULL, "I17, the lines from which the buffer counts as full,"),
            (_DEFINE, "DEFINE ROT with the buffer's size"),
        )
    )
    cursor.expect("B0")
    return Marks(low, full, words)


def _expected(cursor: Cursor, form: re.Pattern[str], what: str) -> re.Match[str]:
    line = cursor.take()
    found = form.fullmatch(line)
    if found is None:
        cursor.refuse(f"is {shown(line)}; expected: {what}", back=1)
    return found


def _read_rotary_start(cursor: Cursor) -> Start:
    cursor.expect("RAPID", "ABS")
    line = cursor.line
    point = cursor.block()
    if point is None or len(point) != 1:
        cursor.refuse("isn't the expected single move to the start")
    cursor.expect("DWELL0")
    return Start(line, point[0])


def _read_prog_start(cursor: Cursor, controller: TurboPmac) -> tuple[Start, Guard]:
    if re.fullmatch(r"OPEN PROG [1-9][0-9]{0,4} CLEAR", cursor.take()) is None:
        cursor.refuse("isn't the expected OPEN PROG with CLEAR", back=1)
    line = cursor.line
    cursor.expect("P8101=1", "WHILE(P8101=1)", "P8101=0")
    places, widths, steps = [], [], []
    for motor in controller.motors:
        compare = cursor.take()
        matched = _COMPARE.fullmatch(compare)
        if matched is None or int(matched[1]) != motor or bool(matched[3]) != bool(matched[5]):
            cursor.refuse(
                f"is {shown(compare)}; expected: the comparison of M{motor}61 with the start", back=1
            )
        # The text subtracts the start from the register: `+5` and `-(-5)` both mean a start at -5.
        negative = (matched[2] == "+") != bool(matched[3])
        places.append(-float(matched[4]) if negative else float(matched[4]))
        widths.append(float(matched[6]))
        steps.append(10.0 ** -len(matched[4].partition(".")[2]))
        cursor.expect("P8101=1")
        if re.fullmatch(r'SEND"[^"]*"', cursor.take()) is None:
            cursor.refuse("isn't the expected SEND with a text", back=1)
        cursor.expect("ENDIF")
    cursor.expect("IF(P8101=1)", "STOP", "ENDIF", "ENDWHILE", "ABS")
    return Start(line, None), Guard(np.array(places), np.array(widths), np.array(steps))
