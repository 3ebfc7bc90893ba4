"""Read a controller text for the rotary buffer of a Turbo PMAC.

Every line must have the one form allowed in its place.
"""

import re
from dataclasses import dataclass, field
from typing import NoReturn

from yarclang.verify.exact import RefusedError

PRINTED = 10**12
"""Positions are integers in units of 1e-12 deg or mm, which represent the decimals of a text exactly."""
STEPS = 4096
"""Steps per millisecond in which the controller represents segment times."""

_LONGEST_DWELL = 8_388_607
"""Longest DWELL of the controller [ms]."""
_HASH = "([0-9a-f]{64})"
_HEADER = (
    r"; yarcc (\S{1,40}): .*",
    r"; target rotary",
    rf"; robot (\S+) {_HASH}",
    rf"; program {_HASH}",
    r"; made with .*",
    r"; start ([-A-Z0-9.]+) \(.*\)",
    r"; duration (.*)",
    r"; longest .*",
    r"; ways round: .*",
    r"; loading .{1,200}",
    r"; commands: .*",
    r"; certificate .*",
    rf"; sha256 {_HASH}",
)
_OPTIONAL = (r"; longest .*", r"; ways round: .*")
_ENTRY = (
    r"; command ([0-9]{1,9}) (\S+) (\S+) ([0-9]{1,9}) "
    r"(?:([1-9][0-9]{0,8}) ([1-9][0-9]{0,8})(?: blend ([0-9]{1,6}))?( any-jerk)?|- -)"
)
_BARRIER = (
    r"; barrier ([0-9]{1,9}) ((wait|hold|when|else|end|set|stop|abort|say|loop|next|exit|endloop) "
    r"([0-9]{1,9}) (\S{1,4000}) (\S+) .+)"
)
_REGISTER = r"; (?:register|watch|search|offset|allow|keep) .+"
_VALUE = r"(-?[0-9]{1,10}(?:\.[0-9]{1,9})?)"
_NUMBER = r"(-?[0-9]{1,7}(?:\.[0-9]{1,12})?)"


@dataclass
class Entry:
    """A command of the program, as listed in the comments of the controller text (the map).

    `first` and `last` are the lines of its first and last move (0: it has none), and `blend` is the number of
    segments of its blend into the next command. `any_jerk` is True if it has no jerk limit.
    """

    step: int
    title: str
    first: int
    last: int
    blend: int | None
    any_jerk: bool


@dataclass
class Item:
    """An action of a controller text.

    Attributes:
        kind: run, dwell, put, barrier, or stand (a slow RAPID).
        line: number of the line.
        what: for a barrier its line of the map (the listed commands), for a dwell its printed time [ms], for
            a put VARIABLE=VALUE.
        step: for a barrier, the index of its command.
        steps: for a run, the segment time [1/4096 ms].
        points: for a run, its points.
        lines: for a run, the numbers of the lines with its points.
        puts: for a run, the outputs that are set between its points, each as line number and text.
    """

    kind: str
    line: int
    what: str = ""
    step: int = -1
    steps: int = 0
    points: list[tuple[int, ...]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    puts: list[tuple[int, str]] = field(default_factory=list)


@dataclass
class Text:
    """A controller text as it was read: the header, the list of the program's commands (the map), and the
    actions. `loaded` are the number of the line before the first line in the buffer, and of the last one.
    """

    version: str
    robot: str
    fingerprint: str
    start_said: str
    duration: str
    entries: list[Entry]
    barriers: dict[int, tuple[str, int, str]]
    registers: list[str]
    safe: list[str]
    marks: tuple[int, int, int]
    start: tuple[int, ...]
    loaded: tuple[int, int]
    course: list[Item]
    arms: list[tuple[int, bool]]
    decimals: int


def exactly(printed: str, scale: int = PRINTED) -> int:
    """Return a printed decimal number exactly, in units of 1 / scale, a power of ten with enough digits."""
    whole, _, decimals = printed.partition(".")
    power: int = scale // 10 ** len(decimals)
    return int(whole + decimals) * power


class _Reading:
    """The lines of a controller text, and the number of the next line to be read."""

    def __init__(self, text: str, axes: list[str]) -> None:
        if re.search(r"[^\n\x20-\x7e]", text) or not text.endswith("\n"):
            raise RefusedError(
                "the text has a character that is no printable ASCII, or its last line has no end"
            )
        self.lines = text[:-1].split("\n")
        self.at = 0
        self.decimals = 0
        self.move = re.compile("".join(re.escape(axis) + _NUMBER for axis in axes))

    def refuse(self, reason: str) -> NoReturn:
        """Refuse the last line taken."""
        shown = self.lines[self.at - 1] if self.at <= len(self.lines) else "the text's end"
        raise RefusedError(f"line {self.at} of the text, {shown[:60]!r}: {reason}")

    def peek(self) -> str:
        """Return the next line; empty at the end."""
        return self.lines[self.at] if self.at < len(self.lines) else ""

    def take(self) -> str:
        """Return the next line and move on."""
        line = self.peek()
        self.at += 1
        if not line or (len(line) > 254 and not line.startswith(";")):
            self.refuse("the text ends too early, or the line is empty or longer than the controller takes")
        return line

    def match(self, form: str) -> re.Match[str]:
        """Take the next line, and refuse the text if the line doesn't match `form` (a regular expression)."""
        found = re.fullmatch(form, self.take())
        if found is None:
            self.refuse(f"another line belongs here ({form[:40]})")
        return found

    def expect(self, *lines: str) -> None:
        """Take the next lines, and refuse the text if they don't equal the given ones."""
        for line in lines:
            if self.take() != line:
                self.refuse(f"{line!r} belongs here")

    def point(self) -> tuple[int, ...] | None:
        """Take the next line and return its point; None if it is not a move line."""
        found = self.move.fullmatch(self.peek())
        if found is None:
            return None
        self.at += 1
        for printed in found.groups():
            self.decimals = max(self.decimals, len(printed.partition(".")[2]))
        return tuple(exactly(printed) for printed in found.groups())


def read(text: str, axes: list[str], motors: list[int], system: int) -> Text:
    """Read a whole controller text.

    Args:
        text: the text.
        axes: letters of the axes.
        motors: motors that are closed before the program is loaded.
        system: number of the coordinate system.
    """
    reading = _Reading(text, axes)
    said: list[str] = []
    for form in _HEADER:
        if form in _OPTIONAL and not reading.peek().startswith(form[:-2]):
            continue
        said += reading.match(form).groups()
    entries, barriers, registers = [], {}, []
    while reading.peek().startswith("; command"):
        step, index, name, source, first, last, blend, free = reading.match(_ENTRY).groups()
        title = f"{index} {name} {source}"
        ends = (int(first or 0), int(last or 0))
        entries.append(Entry(int(step), title, *ends, int(blend) if blend else None, bool(free)))
    if [entry.step for entry in entries] != list(range(len(entries))):
        reading.refuse("the map's commands aren't numbered from 0 on")
    while reading.peek().startswith("; barrier"):
        line, what, kind, step, _, _ = reading.match(_BARRIER).groups()
        if int(line) in barriers or int(step) >= len(entries) or entries[int(step)].first:
            reading.refuse("a second barrier of a line, or one of a command that isn't there or moves")
        barriers[int(line)] = (what, int(step), kind)
    while reading.peek().startswith(("; register", "; watch", "; search", "; offset", "; allow", "; keep")):
        registers.append(reading.match(_REGISTER)[0])
    reading.expect("CLOSE ALL", "END GATHER", "DELETE GATHER")
    safe = []
    if reading.peek() == "OPEN PLC 28 CLEAR":
        reading.expect("OPEN PLC 28 CLEAR", "IF(P8100=2 OR P8104=2)")
        while reading.peek() != "ENDIF":
            safe.append(reading.match(rf"[MPQ][0-9]{{1,4}}={_VALUE}")[0])
        reading.expect("ENDIF", "CLOSE", "ENABLE PLC 28")
    reading.expect(f"&{system}", "".join(f"#{motor}J/" for motor in motors), "DELETE ROT")
    low, full = (int(reading.match(rf"{name}=([0-9]{{1,6}})")[1]) for name in ("I16", "I17"))
    words = int(reading.match("DEFINE ROT ([0-9]{1,9})")[1])
    reading.expect("B0", "OPEN ROT", "CLEAR")
    clear = reading.at
    reading.expect("RAPID", "ABS")
    start = reading.point()
    if start is None:
        reading.refuse("the start belongs here")
    reading.expect("DWELL0", "SPLINE1")
    course, arms = _read_course(reading, barriers)
    if reading.at != len(reading.lines):
        raise RefusedError(f"line {reading.at + 1} of the text comes after CLOSE")
    version, robot, fingerprint, _, start_said, duration, _ = said
    head = (version, robot, fingerprint, start_said, duration, entries, barriers, registers, safe)
    return Text(*head, (low, full, words), start, (clear, reading.at - 1), course, arms, reading.decimals)


def _read_course(
    reading: _Reading, barriers: dict[int, tuple[str, int, str]]
) -> tuple[list[Item], list[tuple[int, bool]]]:
    """Read the lines from the first TM up to CLOSE: return the actions, and the lines where the guard (the
    watchdog against a failing host) is armed (True) and disarmed.
    """
    course: list[Item] = []
    arms: list[tuple[int, bool]] = []
    waiting = dict(barriers)
    run: Item | None = None
    puts = False  # True between an output that is set with a move, and this move
    while True:
        line = reading.at + 1
        point = reading.point()
        if point is not None:
            if run is None:
                reading.refuse("a move before the first TM")
            run.points.append(point)
            run.lines.append(line)
            puts = False
            continue
        content = reading.take()
        if puts and not re.match(r"P8100=(1|P8100&2)$|M[0-9]{1,4}==", content):
            reading.refuse("no move follows an output that is set with one")
        is_put = re.fullmatch(rf"[MPQ][0-9]{{1,4}}={_VALUE}", content)
        if found := re.fullmatch("P8100=(1|P8100&2)", content):
            arms.append((line, found[1] == "1"))
        elif run is not None and run.points and re.fullmatch(rf"M[0-9]{{1,4}}=={_VALUE}", content):
            run.puts.append((line, content.replace("==", "=")))
            puts = True
        elif found := re.fullmatch(r"TM([0-9]{1,4}(?:\.[0-9]{1,12})?)", content):
            steps = exactly(found[1]) * STEPS
            if steps % PRINTED or not 0 < steps < 4096 * STEPS * PRINTED:
                reading.refuse("the controller keeps multiples of 1/4096 ms below 4096 ms")
            if run is not None and (not run.points or run.steps == steps // PRINTED):
                reading.refuse("the same TM again, or one after another, isn't known to end a sequence")
            run = Item("run", line, steps=steps // PRINTED)
            course.append(run)
        elif run is not None and not run.points:
            reading.refuse("a TM without moves")
        elif content == "CLOSE":
            break
        elif line in waiting:
            if content != "STOP":
                reading.refuse("the map has a barrier here, which is STOP")
            run = None
            what, step, _ = waiting.pop(line)
            course.append(Item("barrier", line, what, step))
        elif found := re.fullmatch(r"DWELL([0-9]{1,7}(?:\.[0-9]{1,9})?)", content):
            run = None
            if exactly(found[1]) > _LONGEST_DWELL * PRINTED:
                reading.refuse("a dwell that is longer than the controller takes")
            course.append(Item("dwell", line, found[1] if exactly(found[1]) else "0"))
        elif content == "RAPID":
            run = None
            reading.expect("ABS")
            stand = reading.point()
            if stand is None:
                reading.refuse("a move to where the robot stands belongs after this line")
            reading.expect("DWELL0", "SPLINE1")
            course.append(Item("stand", line, points=[stand]))
        elif is_put and run is None:
            course.append(Item("put", line, content))
        else:
            reading.refuse("no line that belongs here")
    if waiting:
        reading.refuse(f"the map has a barrier in line {min(waiting)}, which isn't there")
    return course, arms
