"""Reads the controller text that yarcc emits, and nothing else.

The judge has a reader of its own: what a writer believes to have written is no evidence. Every
line must have the one form that is allowed in its place, so that no line can do what nobody checked.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.cursor import Cursor, Refusal, shown
from yarclang.robot.model import Array, Controller

Target = Literal["rotary", "prog"]

TM_STEPS_PER_MS = 4096
"""TM is a fixed-point number of 12 integer and 12 fraction bits (TSRM 476, I42 = 0)."""
LARGEST_TM_MS = 4096

_TARGET = re.compile(r"; target (rotary|prog)")
_ENTRY = re.compile(
    r"; command ([0-9]+) (\S+) (\S+) ([0-9]+) (?:([0-9]+) ([0-9]+)(?: blend ([0-9]{1,6}))?|- -)"
)
_TRIGGER = re.compile(r"(M[0-9]{1,4})==(-?[0-9]+(?:\.[0-9]{1,9})?)")
_TM = re.compile(r"TM([0-9]{1,4}(?:\.[0-9]{1,12})?)")
_BARRIER = re.compile(r"; barrier ([0-9]+) (wait|hold|when|else|end) ([0-9]+) (\S+) (\S+) (.*)")
_CONDITION = re.compile(r"([IPQM][0-9]{1,4})=(-?[0-9]+(?:\.[0-9]{1,9})?)")
_DWELL = re.compile(r"DWELL([0-9]{1,7}(?:\.[0-9]{1,9})?)")
_PLAIN = r"([0-9]{1,15}(?:\.[0-9]{1,12})?)"
_COMPARE = re.compile(rf"IF\(ABS\(M([0-9]+)61([-+])(\(-)?{_PLAIN}(\))?\)>{_PLAIN}\)")


@dataclass(frozen=True, slots=True)
class Unreadable:
    """The first place of the text that isn't what yarcc emits: its line (from 1), the reason, the code."""

    line: int
    reason: str
    code: str = "Y1151"


@dataclass(frozen=True, slots=True)
class Entry:
    """A line `; command` of the header: which move lines belong to which step of the program.

    `first` and `last` are lines of the text, from 1; None for a step without move lines. `blend` is the number of segments, half
    of them before and half behind the command's end, in which it flows into the next one; None where it ends at rest.
    """

    at: int
    step: int
    index: str
    name: str
    source_line: int
    first: int | None
    last: int | None
    blend: int | None = None


@dataclass(frozen=True, slots=True)
class Put:
    """A variable gets a value: at rest, or, where it is `synchronous`, when the move of the next line begins."""

    line: int
    variable: str
    value: float
    synchronous: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One spline sequence: the move lines between two values of TM.

    `segment_ms` is TM [ms], exact; `points` (M, n) are the printed numbers [deg or mm];
    `lines` (M,) are their lines in the text. `puts` are the outputs set between them, while the robot moves.
    """

    segment_ms: float
    tm_line: int
    points: Array
    lines: NDArray[np.int64]
    puts: tuple[Put, ...] = ()


@dataclass(frozen=True, slots=True)
class Dwelt:
    """DWELL: the sequence ends, and the robot stands for `milliseconds` more."""

    line: int
    milliseconds: float


@dataclass(frozen=True, slots=True)
class Barred:
    """A barrier: the program goes no further by itself. As the header's map says: what kind, which step, what is waited for
    (`condition`, such as M11=1, or -), how long [s] (None: for ever), and the input's name or the operator's text.
    """

    line: int
    kind: str
    step: int
    condition: str
    timeout: float | None
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Stood:
    """A slow RAPID to where the robot stands: `point` (n,) [deg or mm]."""

    line: int
    point: Array


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Where the motion starts.

    `rapid` (n,) [deg or mm] is the target of the RAPID move. A fixed program has no such
    move: it waits until each motor is within `guard_width` of `guard` (n,), both in
    1/(Ixx08 * 32) count as the register of the commanded position is; `guard_step` (n,) is
    the last printed digit of `guard`.
    """

    line: int
    rapid: Array | None = None
    guard: Array | None = None
    guard_width: Array | None = None
    guard_step: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ControllerText:
    """What the text makes the controller do, in order (`course`). `outputs` are variables and the values that they take when the
    guard has held the motion; `decimals` is the most that a move line prints.
    """

    target: Target
    entries: tuple[Entry, ...]
    start: Start
    course: tuple[Run | Dwelt | Put | Barred | Stood, ...]
    outputs: tuple[tuple[str, float], ...]
    decimals: int

    @property
    def runs(self) -> tuple[Run, ...]:
        """The sequences of moves."""
        return tuple(item for item in self.course if isinstance(item, Run))


def read(text: str, controller: Controller) -> ControllerText | Unreadable:
    """Read a whole text.

    Args:
        text: what yarcc emitted.
        controller: whose axes, motors and coordinate system the text must name.

    Returns:
        What it says, or the first place that isn't what yarcc emits.
    """
    if not text.isascii():
        line = next(i for i, content in enumerate(text.split("\n"), 1) if not content.isascii())
        return Unreadable(line, "has a character that isn't ASCII")
    if not text.endswith("\n"):
        return Unreadable(text.count("\n") + 1, "doesn't end with a line feed")
    cursor = Cursor(text, controller)
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
    course = _read_course(cursor, barriers, target, controller.coordinate_system)
    cursor.skip_remarks()
    if not cursor.at_end:
        cursor.refuse(f"is {shown(cursor.peek())} behind CLOSE" + _why(cursor.peek()))
    return ControllerText(target, entries, start, course, outputs, cursor.decimals)


def _read_header(cursor: Cursor) -> tuple[Target, tuple[Entry, ...], dict[int, Barred]]:
    target: Target | None = None
    entries: list[Entry] = []
    barriers: dict[int, Barred] = {}
    while (line := cursor.peek()).startswith(";"):
        if found := _TARGET.fullmatch(line):
            if target is not None:
                cursor.refuse("names the target a second time")
            target = "rotary" if found[1] == "rotary" else "prog"
        elif found := _ENTRY.fullmatch(line):
            index = "" if found[2] == "-" else found[2]
            first, last = (int(found[5]), int(found[6])) if found[5] else (None, None)
            blend = int(found[7]) if found[7] else None
            entries.append(
                Entry(cursor.line, int(found[1]), index, found[3], int(found[4]), first, last, blend)
            )
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
    while found := _CONDITION.fullmatch(cursor.peek()):
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


def _read_course(
    cursor: Cursor, barriers: dict[int, Barred], target: Target, system: int
) -> tuple[Run | Dwelt | Put | Barred | Stood, ...]:
    """Everything from the first TM up to CLOSE."""
    course = _Course()
    while True:
        cursor.skip_remarks()
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
        if found := _TM.fullmatch(content):
            course.segment(_segment_ms(found[1], cursor), line, found[1])
        elif found := _DWELL.fullmatch(content):
            course.finish()
            course.items.append(Dwelt(line, float(found[1])))
        elif content == "RAPID":
            course.finish()
            course.items.append(_read_stand(cursor, line))
        elif content in ("P8100=1", "P8100=0"):
            continue
        elif (found := _CONDITION.fullmatch(content)) and course.rests:
            course.items.append(Put(line, found[1], float(found[2])))
        elif (found := _TRIGGER.fullmatch(content)) and course.moves_on(cursor):
            course.puts.append(Put(line, found[1], float(found[2]), synchronous=True))
        else:
            cursor.refuse(f"is {shown(content)}: no move line, TM, P8100 or CLOSE" + _why(content), back=1)
    course.finish()
    if barriers:
        cursor.refuse(f"the map names a barrier in line {min(barriers)}, and none is there")
    return tuple(course.items)


class _Course:
    """What was read so far, and the sequence that isn't finished."""

    def __init__(self) -> None:
        self.items: list[Run | Dwelt | Put | Barred | Stood] = []
        self._ms: float | None = None
        self._tm_line = 0
        self._blocks: list[tuple[int, Array]] = []
        self.puts: list[Put] = []

    def moves_on(self, cursor: Cursor) -> bool:
        """Whether moves of the sequence stand before this place and right behind it: elsewhere an output that is set in step with a
        move is set at no known time, or not at all.
        """
        return bool(self._blocks) and cursor.move_follows()

    @property
    def rests(self) -> bool:
        """Whether the robot stands, and what comes next is calculated only then."""
        return self._ms is None

    def segment(self, ms: float, line: int, printed: str) -> None:
        """A new segment time ends a sequence; the same one isn't known to."""
        if ms == self._ms:
            raise Refusal(line, f"repeats TM{printed}: not known to end a sequence", "Y1151")
        self.finish()
        self._ms, self._tm_line = ms, line

    def moves(self, line: int, points: Array) -> None:
        """Move lines of the sequence."""
        if self._ms is None:
            raise Refusal(line, "is a move line before the first TM", "Y1151")
        self._blocks.append((line, points))

    def finish(self) -> None:
        """The sequence ends here."""
        if self._ms is None:
            return
        if not self._blocks:
            raise Refusal(self._tm_line, "is a TM without move lines", "Y1151")
        lines = np.concatenate([np.arange(line, line + len(block)) for line, block in self._blocks])
        points = np.concatenate([block for _, block in self._blocks])
        self.items.append(Run(self._ms, self._tm_line, points, lines, tuple(self.puts)))
        self._ms = None
        self._blocks.clear()
        self.puts.clear()


def _read_stand(cursor: Cursor, line: int) -> Stood:
    """The rest of RAPID, ABS, a point, DWELL0, SPLINE1."""
    cursor.expect("ABS")
    point = cursor.block()
    if point is None or len(point) != 1:
        cursor.refuse("one move to where the robot stands belongs here")
    cursor.expect("DWELL0", "SPLINE1")
    return Stood(line, point[0])


def _expect_barrier(cursor: Cursor, barrier: Barred, target: Target, system: int) -> None:
    """The lines that keep the program from going on."""
    if target == "rotary":
        cursor.expect("STOP")
        return
    condition = _CONDITION.fullmatch(barrier.condition)
    if barrier.kind in ("wait", "when") and condition is None:
        cursor.refuse("the map doesn't say for what this barrier waits")
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
            timer = f"I{5011 + 100 * system}"
            cursor.expect("P8102=1", "WHILE(P8102=1)")
            started = re.fullmatch(rf"{timer}=INT\(([0-9.]+)\*8388608/I10\)", cursor.take())
            if started is None or abs(float(started[1]) - barrier.timeout * 1e3) > 1e-3:
                cursor.refuse(f"{timer} for {barrier.timeout:g} s belongs here", back=1)
            cursor.expect(f"WHILE({missing} AND {timer}>0)WAIT", "P8102=0", f"IF({missing})", "P8102=1")
            _expect_text(cursor)
            cursor.expect("STOP", "ENDIF", "ENDWHILE")
        case _:
            _expect_text(cursor)
            cursor.expect("STOP")


def _expect_text(cursor: Cursor) -> None:
    if re.fullmatch(r'SEND"[^"]*"', cursor.take()) is None:
        cursor.refuse("SEND with a text belongs here", back=1)


def _segment_ms(printed: str, cursor: Cursor) -> float:
    """TM [ms], where the controller can keep it exactly."""
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


def _why(line: str) -> str:
    """What is worst about a line that doesn't belong here."""
    return ": an R starts the motion by itself" if re.search(r"(^|[^A-Z])R", line) else ""
