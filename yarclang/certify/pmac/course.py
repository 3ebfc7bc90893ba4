"""Reading of a controller text from the start to CLOSE: sequences of moves, dwells, outputs, barriers."""

from __future__ import annotations

import re
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.pmac.cursor import Cursor
from yarclang.certify.pmac.own import TM_STEPS_PER_MS, Armed
from yarclang.certify.read.lines import Refusal, shown
from yarclang.certify.read.text import Barred, Dwelt, Put, Run, Stood
from yarclang.pmac.program import Target
from yarclang.robot.model import Array

LARGEST_TM_MS = 4096

CONDITION = re.compile(r"([MPQ][0-9]{1,4})=(-?[0-9]{1,10}(?:\.[0-9]{1,9})?)")
"""Assignment or comparison of a variable, such as M5=1, with the variable and the value as groups."""

_TRIGGER = re.compile(r"(M[0-9]{1,4})==(-?[0-9]{1,10}(?:\.[0-9]{1,9})?)")
_TM = re.compile(r"TM([0-9]{1,4}(?:\.[0-9]{1,12})?)")
_DWELL = re.compile(r"DWELL([0-9]{1,7}(?:\.[0-9]{1,9})?)")
_ARMED = re.compile(r"P8100=(1|P8100&2)")
_TIMER = r"=INT\(([0-9]{1,12}(?:\.[0-9]{1,9})?)\*8388608/I10\)"
_ASSIGNMENT = re.compile(r"([IPQM][0-9]+)={1,2}.*")


def read_course(
    cursor: Cursor, barriers: dict[int, Barred], target: Target, system: int
) -> tuple[tuple[Run | Dwelt | Put | Barred | Stood, ...], tuple[Armed, ...]]:
    """Read everything from the first TM up to CLOSE.

    Returns:
        The actions of the text in order (its course), and the lines that arm and disarm the guard.
    """
    course, arms = _Course(), list[Armed]()
    while True:
        line = cursor.line
        points = cursor.block()
        if points is not None:
            course.moves(line, points)
            continue
        if line in barriers:
            course.finish()
            _expect_barrier(cursor, barriers[line], target, system)
            course.items.append(barriers.pop(line))
            continue
        content = cursor.take()
        if content == "CLOSE":
            break
        if matched := _TM.fullmatch(content):
            course.segment(_segment_ms(matched[1], cursor), line, matched[1])
        elif matched := _DWELL.fullmatch(content):
            course.finish()
            course.items.append(Dwelt(line, float(matched[1])))
        elif content == "RAPID":
            course.finish()
            course.items.append(_read_stand(cursor, line))
        elif matched := _ARMED.fullmatch(content):
            arms.append(Armed(line, matched[1] == "1"))
        elif (matched := CONDITION.fullmatch(content)) and course.rests:
            course.items.append(Put(line, matched[1], float(matched[2])))
        elif (matched := _TRIGGER.fullmatch(content)) and course.moves_on(cursor):
            course.puts.append(Put(line, matched[1], float(matched[2]), synchronous=True))
        else:
            cursor.refuse(f"is {shown(content)}: {_why_not(content)}", back=1)
    course.finish()
    if barriers:
        cursor.refuse(f"ends the text, and the map names a barrier in line {min(barriers)}", back=1)
    return tuple(course.items), tuple(arms)


def _why_not(content: str) -> str:
    """Return the reason why a line is not allowed in the part between the start and CLOSE."""
    if (found := _ASSIGNMENT.fullmatch(content)) is not None:
        if found[1].startswith("I"):
            return "a program must not assign I-variables after its start"
        if found[1] == "P8100":
            return "the guard is armed by P8100=1 and disarmed by P8100=P8100&2 (older texts have P8100=0)"
        return f"{found[1]} may be assigned only at rest, or in the middle of a blend"
    return "no move line, TM, DWELL, P8100 or CLOSE" + why_worse(content)


class _Course:
    """State of the reading: the actions read so far, and the sequence of moves in progress."""

    def __init__(self) -> None:
        self.items: list[Run | Dwelt | Put | Barred | Stood] = []
        self._ms: float | None = None
        self._tm_line = 0
        self._blocks: list[tuple[int, Array]] = []
        self.puts: list[Put] = []

    def moves_on(self, cursor: Cursor) -> bool:
        """Return True if the next line is inside a sequence of moves: after a move and before another one.

        An output in step with a move is allowed only there. Elsewhere, the controller would set it at an
        unknown time, or not at all.
        """
        return bool(self._blocks) and cursor.move_follows()

    @property
    def rests(self) -> bool:
        """True if the robot stands still after the lines read so far, so that the controller computes the
        next line at rest.
        """
        return self._ms is None

    def segment(self, ms: float, line: int, printed: str) -> None:
        """Begin a sequence of moves with a new segment time.

        Refuse a TM with the same segment time: it is not known whether the controller ends a sequence there.
        """
        if ms == self._ms:
            raise Refusal(line, f"repeats TM{printed}: not known to end a sequence", "Y1151")
        self.finish()
        self._ms, self._tm_line = ms, line

    def moves(self, line: int, points: Array) -> None:
        """Add move lines to the sequence."""
        if self._ms is None:
            raise Refusal(line, "is a move line before the first TM", "Y1151")
        self._blocks.append((line, points))

    def finish(self) -> None:
        """End the sequence of moves in progress, if there is one."""
        if self._ms is None:
            return
        if not self._blocks:
            raise Refusal(self._tm_line, "is a TM without move lines", "Y1151")
        lines = [np.arange(line, line + len(block)) for line, block in self._blocks]
        points = [block for _, block in self._blocks]
        self.items.append(Run(self._ms, self._tm_line, _joined(points), _joined(lines), tuple(self.puts)))
        self._ms = None
        self._blocks.clear()
        self.puts.clear()


def _joined(parts: list[NDArray[Any]]) -> NDArray[Any]:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _read_stand(cursor: Cursor, line: int) -> Stood:
    """Read the rest of a slow RAPID: ABS, a point, DWELL0, SPLINE1."""
    cursor.expect("ABS")
    point = cursor.block()
    if point is None or len(point) != 1:
        cursor.refuse("isn't the expected single move to the robot's position")
    cursor.expect("DWELL0", "SPLINE1")
    return Stood(line, point[0])


def _expect_barrier(cursor: Cursor, barrier: Barred, target: Target, system: int) -> None:
    """Read the lines of a barrier, at which the program stops or waits."""
    if target == "rotary":
        cursor.expect("STOP")
        return
    condition = CONDITION.fullmatch(barrier.condition)
    if barrier.kind == "set" or (
        barrier.kind == "when" and (condition is None or barrier.timeout is not None)
    ):
        cursor.refuse("is decided by the streaming host, which a program buffer doesn't have")
    if barrier.kind in ("loop", "next", "exit", "endloop"):
        cursor.refuse("belongs to a loop, which the streaming host restarts: a program buffer has none")
    if barrier.kind in ("stop", "abort"):
        cursor.refuse("ends the program in the middle of its text, which a program buffer can't do")
    if barrier.kind == "hold" and barrier.register:
        cursor.refuse("asks the operator for a number, which a program buffer can't do")
    if barrier.kind == "say":
        cursor.refuse("is shown by the streaming host, which a program buffer doesn't have")
    if barrier.kind == "wait" and condition is None:
        cursor.refuse("is a barrier whose condition the map doesn't name")
    match barrier.kind, condition:
        case "when", _:
            cursor.expect(f"IF({barrier.condition})")
        case "else", _:
            cursor.expect("ELSE")
        case "end", _:
            cursor.expect("ENDIF")
        case "wait", found if found is not None:
            missing = f"{found[1]}!={found[2]}"
            if barrier.timeout is None:
                cursor.expect(f"WHILE({missing})WAIT")
                return
            # The timer counts down in servo cycles, of which 8388608 / I10 are in 1 ms (TSRM 43).
            timer = f"I{5011 + 100 * system}"
            cursor.expect("P8102=1", "WHILE(P8102=1)")
            started = re.fullmatch(timer + _TIMER, cursor.take())
            if started is None or abs(float(started[1]) - barrier.timeout * 1e3) > 1e-3:
                cursor.refuse(f"doesn't start {timer} for {barrier.timeout:g} s", back=1)
            cursor.expect(f"WHILE({missing} AND {timer}>0)WAIT", "P8102=0", f"IF({missing})", "P8102=1")
            _expect_text(cursor)
            cursor.expect("STOP", "ENDIF", "ENDWHILE")
        case _:
            _expect_text(cursor)
            cursor.expect("STOP")


def _expect_text(cursor: Cursor) -> None:
    if re.fullmatch(r'SEND"[^"]*"', cursor.take()) is None:
        cursor.refuse("isn't the expected SEND with a text", back=1)


def _segment_ms(printed: str, cursor: Cursor) -> float:
    """Return TM [ms], if the controller can represent it exactly."""
    exact = Decimal(printed)
    steps = exact * TM_STEPS_PER_MS
    if not 0 < exact < LARGEST_TM_MS or steps != steps.to_integral_value():
        cursor.refuse(
            f"is TM{printed}: the controller keeps multiples of 1/{TM_STEPS_PER_MS} ms "
            f"below {LARGEST_TM_MS} ms",
            back=1,
            code="Y1152",
        )
    return float(exact)


def why_worse(line: str) -> str:
    """Return an additional warning about a line that does not belong here, or an empty text."""
    return ": an R starts the motion by itself" if re.search(r"(^|[^A-Z])R", line) else ""
