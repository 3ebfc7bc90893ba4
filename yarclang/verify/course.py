"""Check everything in a controller text besides its motions: rests, branches, the guard (the watchdog against
a failing host), assignments, and the duration.
"""

import re
from bisect import bisect
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from itertools import pairwise, product
from math import ceil
from typing import Any

from yarclang.verify.exact import RefusedError, need
from yarclang.verify.reader import PRINTED, STEPS, Entry, Item, Text

Point = tuple[int, ...]

PARTING = ("when", "else", "end", "loop", "next", "exit", "endloop", "stop", "abort")
"""Barriers at which branches and loops begin, merge, repeat or end."""
_OWN = re.compile(r"P81[0-9][0-9]|M8116|M[0-9]{1,2}6[0-9]")
"""Variables that belong to the guard and the motors, which must not be inputs or outputs."""
_NAMED = re.compile(r"(?<![A-Z0-9_$])[MPQ][0-9]{1,4}(?![0-9])")
_MOST_PUTS = 64
"""Largest number of outputs that are set with one move."""
_MOST_WORDS = 1 << 24
"""Largest size of a rotary buffer: the controller has 24-bit addresses [words]."""
_LATE, _AHEAD = Fraction(1, 10), 2
"""Largest delay of the guard [s], and number of lines that the controller reads ahead of the motion."""


@dataclass
class Moved:
    """A command of the program, as the controller text's comments list it, with its segments.

    Segment k is the uniform cubic B-spline of the points k to k + 3 of `control`, and takes `steps` / 4096
    ms. A command without moves has no segments, and stays at `begin`.

    Attributes:
        entry: the command as listed.
        begin: position before the command.
        end: position after the command.
        control: control points of the command's sequence (moves without a rest between them).
        steps: duration of a segment [1/4096 ms].
        first: index of the command's first segment.
        last: index of the segment after the command's last one.
        before: number of segments of the blend at the command's start; None if it starts at rest.
        run: index of the command's sequence.
        after: index of the command before it, on one of the ways that lead to it; -1 for the first command.
    """

    entry: Entry
    begin: Point
    end: Point
    control: list[Point] = field(default_factory=list)
    steps: int = 0
    first: int = 0
    last: int = 0
    before: int | None = None
    run: int = -1
    after: int = -1

    @property
    def seconds(self) -> Fraction:
        """Duration of a segment [s]."""
        return Fraction(self.steps, STEPS * 1000)


@dataclass
class _Open:
    """A WHEN or a loop whose end hasn't been reached yet.

    `before` is the state at its start. `other` is the state at the end of a WHEN's other branch, or at a
    loop's EXITs. `again` is the state at the NEXTs, where a pass of a loop ends early.
    """

    loop: bool
    before: Any
    other: Any = None
    again: Any = None
    parted: bool = False


class Ways:
    """The state at a place of a controller text (such as the elapsed time), merged over all branches to the
    place.

    Attributes:
        at: the state here; None if no branch leads here.
        ended: the state at each STOP, ABORT or other early end. These states needn't agree.
    """

    def __init__(self, at: Any, merge: Callable[[Any, Any, int], Any]) -> None:
        self.at: Any = at
        self.ended = list[Any]()
        self.open, self._merge = list[_Open](), merge

    def _either(self, one: Any, other: Any, line: int) -> Any:
        if one is None or other is None:
            return other if one is None else one
        return self._merge(one, other, line)

    def passes(self, kind: str, line: int) -> Any:
        """Process a barrier (a line that branches, loops or stops). At the end of a loop, return the state
        merged over its NEXTs.
        """
        if kind in ("when", "loop"):
            self.open.append(_Open(kind == "loop", self.at, None if kind == "loop" else self.at))
        elif kind in ("stop", "abort"):
            self.ended += [] if self.at is None else [self.at]
            self.at = None
        elif kind in ("else", "end", "endloop"):
            one = self.open[-1] if self.open else _Open(False, None)
            own = bool(self.open) and one.loop == (kind == "endloop")
            need(own, f"line {line} ends or parts what isn't open")
            if kind == "else":
                need(not one.parted, f"line {line} is a second ELSE")
                one.other, self.at, one.parted = self.at, one.before, True
                return None
            self.open.pop()
            self.at = self._either(self.at, one.other, line)
            return one.again
        elif kind in ("next", "exit"):
            loops = [one for one in self.open if one.loop]
            need(bool(loops), f"line {line} belongs to a loop, and none is open")
            if kind == "next":
                loops[-1].again = self._either(loops[-1].again, self.at, line)
            else:
                loops[-1].other = self._either(loops[-1].other, self.at, line)
            self.at = None
        return None


def follow(text: Text) -> tuple[list[Moved], list[str]]:
    """Return the commands with their segments, and all actions of the controller text in order.

    The controller begins a sequence at rest at the current position, S, and ends it at rest in its last point
    E: the control points are S, S, S, the points, E, E (Turbo PMAC User Manual, page 289). Barriers must be
    at rest. An output must be at rest, or in the middle of a blend.
    """
    moving = [entry for entry in text.entries if entry.first]
    found: list[Moved] = []
    done: list[str] = []
    slack = min(PRINTED // 10**text.decimals, PRINTED // 500)

    def meet(one: tuple[Point, ...], other: tuple[Point, ...], line: int) -> tuple[Point, ...]:
        """Refuse positions that differ by more than the last printed digit, and return all of them."""
        for a, b in product(one, other):
            apart = max(abs(x - y) for x, y in zip(a, b, strict=True))
            need(apart <= slack, f"line {line}: ways that meet end {apart / PRINTED:.6g} deg or mm apart")
        return tuple(dict.fromkeys((*one, *other)))

    # The state is the position, or all positions at which the branches to this place end. The RAPID after
    # such a place leads to one of them exactly: differences never add up.
    standing, stood = Ways((text.start,), meet), (text.start,)
    before, last, known = dict[int, int](), Ways(-1, lambda one, *_: one), 0

    def reach(step: int) -> None:
        """Note which command comes before each command, up to `step`."""
        nonlocal known
        for k in range(known, step + 1):
            before[k] = -1 if last.at is None else last.at
            last.at = last.at if last.at is None else k
        known = step + 1

    waiting = deque(moving)
    behind: Item | None = None
    places: dict[int, Point | None] = {}
    step = -1
    for number, item in enumerate(text.course):
        led = item.kind == "stand" or behind is None or behind.kind != "barrier"
        need(led, f"line {item.line}: after a barrier, a RAPID to where the robot stands belongs here")
        if item.kind in ("put", "barrier"):
            need(behind is None or behind.kind != "run", f"line {item.line} comes before a motion's end")
        if item.kind == "run":
            step = _sequence(number, item, standing, waiting, found, done, step)
            reach(step)
        elif item.kind == "stand":
            need(behind is not None and behind.kind == "barrier", f"line {item.line}: a RAPID elsewhere")
            here = item.points[0]
            need(
                here in (standing.at or stood), f"line {item.line}: a RAPID to where the robot doesn't stand"
            )
            standing.at = standing.at and (here,)
        elif item.kind == "barrier":
            kind = text.barriers[item.line][2]
            need(step < item.step, f"line {item.line} isn't in the order of the map")
            reached = standing.at is not None or kind in ("else", "end", "endloop")
            need(reached, f"line {item.line} is never reached")
            step, stood = item.step, standing.at or stood
            ended = standing.at
            again = standing.passes(kind, item.line)
            reach(step - 1)
            last.passes(kind, item.line)
            if kind == "loop":  # each pass ends where the first one begins
                standing.open[-1].again = standing.at
            if kind == "endloop" and ended and again:
                meet(ended, again, item.line)
            done.append(f"barrier {item.what}")
        else:
            stops = behind is not None and behind.kind == "run"
            need(item.what != "0" or stops, f"line {item.line}: a DWELL0 that doesn't end a motion")
            done += [] if item.what == "0" else [f"{item.kind} {item.what}"]
        behind = item
        places[step] = standing.at and standing.at[0]
    need(not waiting, "the map has a command whose moves aren't there")
    need(not standing.open, "a way or a loop of the text has no end")
    by_step = {one.entry.step: one for one in found}
    reach(len(text.entries) - 1)
    at, rows = text.start, []
    for entry in text.entries:  # a command without moves is at the end of the branches before it
        if entry.step not in by_step:
            at = places.get(entry.step) or at
        one = by_step.get(entry.step) or Moved(entry, at, at)
        one.after, at = before[entry.step], one.end
        rows.append(one)
    return rows, done


def _sequence(
    number: int,
    item: Item,
    standing: Ways,
    waiting: deque[Entry],
    found: list[Moved],
    done: list[str],
    step: int,
) -> int:
    """Assign the segments of a sequence (moves without a rest between them) to its commands; return the last
    command's step.
    """
    need(standing.at is not None, f"line {item.line} is never reached")
    (start,), points = standing.at, item.points
    control = [start, start, start, *points, points[-1], points[-1]]
    place, before = 0, None
    put = 0  # number of outputs that were assigned to a corner
    each = Counter(bisect(item.lines, line) for line, _ in item.puts).values()
    need(max(each, default=0) <= _MOST_PUTS, f"line {item.line}: too many outputs are set with one move")
    numbers = {line: k for k, line in enumerate(item.lines)}
    while place < len(points):
        need(bool(waiting), f"the moves from line {item.lines[place]} on belong to no command")
        entry = waiting.popleft()
        need(step < entry.step, f"command {entry.step} isn't in the order of the map")
        fits = entry.first == item.lines[place] and entry.last in numbers
        need(fits, f"command {entry.step} has other lines")
        behind = numbers[entry.last] + 1
        need(behind > place, f"the lines of command {entry.step} end before they begin")
        last = behind + (2 if behind == len(points) else 0)
        rests = len(set(control[last : last + 3])) == 1
        knots = [a + 4 * b + c for a, b, c in zip(*control[last : last + 3], strict=True)]
        end = control[last + 2] if rests else tuple(knot // 6 for knot in knots)
        one = Moved(entry, standing.at[0], end, control, item.steps, place, last, before, number)
        blend = entry.blend
        need(blend is not None or rests, f"command {entry.step} doesn't end at rest")
        need(blend is None or behind < len(points), f"command {entry.step} flows on into nothing")
        need((blend or 0) % 2 == 0, f"command {entry.step} has a blend without a middle")
        longest = (last - place) * 2 + 1
        need((before or 0) + (blend or 0) <= longest, f"command {entry.step} is shorter than its blends")
        found.append(one)
        done.append(f"move {entry.step}")
        after = numbers.get(waiting[0].last or 0, place) + 1 if waiting else 0  # where the next command ends
        while put < len(item.puts):
            line, what = item.puts[put]
            off = bisect(item.lines, line) - behind
            if off > 1 or (behind < after and abs(off) > abs(bisect(item.lines, line) - after)):
                break  # it belongs to the next corner
            need(off >= -1 and blend is not None, f"line {line}: an output not in a blend's middle")
            done.append(f"put {what}")
            put += 1
        standing.at, place, before, step = (end,), behind, blend, entry.step
    need(put == len(item.puts), "an output is set after the last blend of a sequence")
    return step


Span = tuple[Fraction, Fraction, int, int]
"""Least and most time without waits [s], fewest and most waits, over all branches that lead to a place."""


def _widest(one: Span, other: Span, *_: int) -> Span:
    """Return the span that covers two spans."""
    return min(one[0], other[0]), max(one[1], other[1]), min(one[2], other[2]), max(one[3], other[3])


def span_of(text: Text) -> tuple[Span, bool]:
    """Return the shortest and longest duration of a controller text with its least and largest number of
    waits, and True if it has a loop.

    Each loop counts as one pass, up to the loop's end, a NEXT or an EXIT.
    """
    ways, loops = Ways((Fraction(0), Fraction(0), 0, 0), _widest), False
    for item in text.course:
        kind = text.barriers[item.line][2] if item.kind == "barrier" else item.kind
        asks = kind == "when" and text.barriers[item.line][0].split()[3] != "-"  # a WHEN that also waits
        time, wait = Fraction(0), asks or kind in ("wait", "hold")
        if kind == "run":
            time = Fraction((len(item.points) + 2) * item.steps, STEPS * 1000)
        elif kind == "dwell":
            time = Fraction(item.what) / 1000
        if ways.at is not None:
            least, most, fewest, waits = ways.at
            ways.at = least + time, most + time, fewest + wait, waits + wait
        again = ways.passes(kind, item.line)
        if again is not None:
            loops = True
            if ways.at is None:
                ways.ended.append(again)
            else:
                ways.at = ways.at[0], max(ways.at[1], again[1]), ways.at[2], max(ways.at[3], again[3])
    ends = ways.ended if ways.at is None else [*ways.ended, ways.at]
    need(bool(ends), "the text has no way to its end")
    return reduce(_widest, ends), loops


def check_duration(text: Text) -> None:
    """Check that the duration in the text's header is that of its segments and dwells."""
    (least, most, fewest, waits), loops = span_of(text)
    count = f"{fewest} to {waits}" if fewest < waits else f"{waits}"
    rest = f" and {count} wait{'s' * (waits != 1)}" if waits else ""
    rest += ", each loop once" if loops else ""
    said = re.match(
        r"(?:([0-9]{1,9}\.[0-9]{3}) to )?([0-9]{1,9}\.[0-9]{3}) s(.*?)(, segments .*)?$", text.duration
    )
    need(said is not None, "the header has no duration")
    if said is not None:
        shortest, longest = said[1] or said[2], said[2]
        if not said[1] and most - least <= Fraction(1, 1999):
            least = most  # the header has only the longest duration
        off = max(abs(Fraction(shortest) - least), abs(Fraction(longest) - most))
        same = off <= Fraction(1, 1999) and said[3] == rest
        need(same, "the header says another duration than the text has")


def check_guard(text: Text, robot: dict[str, Any]) -> None:
    """Check that the guard (the watchdog against a failing host) leaves enough lines for a stop on the path,
    and never stops the robot at the end of a motion.
    """
    low, full, words = text.marks
    runs = [item for item in text.course if item.kind == "run"]
    smallest = 3 * (robot["i8"] + 1) * Fraction(robot["i10"], 8_388_608)
    for run in runs:
        long = Fraction(run.steps, STEPS) >= smallest * (1 - Fraction(1, 10**9))
        need(long, f"line {run.line}: TM below {float(smallest):.6g} ms")
        largest = robot["largest_tm"] + Fraction(1, STEPS)
        need(run.steps <= largest * STEPS, f"line {run.line}: TM above the robot's longest")
    # A hold can need this many moves. The controller counts lines, but only moves take time.
    shortest = Fraction(min([run.steps for run in runs], default=STEPS * 1000), STEPS * 1000)
    moves_needed = ceil((robot["hold_time"] / 2 + _LATE) * (1 - Fraction(1, 10**9)) / shortest)
    need(not runs or low >= moves_needed, "I16 lines are too short for a hold")
    need(low < full, "I17 isn't above I16")
    need(full + _AHEAD <= words // (len(robot["axes"]) + 2), "the buffer can't hold I17 lines")
    need(words >= robot["rotary_words"], "the buffer is smaller than the robot's is to be")
    need(words <= _MOST_WORDS, "the buffer is larger than a controller's memory")
    barriers = [item.line for item in text.course if item.kind == "barrier"]
    lines, armed_lines = [line for run in runs for line in run.lines], [line for line, _ in text.arms]
    for begin, end in pairwise([text.loaded[0], *barriers, text.loaded[1]]):
        moves = lines[bisect(lines, begin) : bisect(lines, end)]
        arms = text.arms[bisect(armed_lines, begin) : bisect(armed_lines, end)]
        if end - begin - len(arms) <= full + _AHEAD or not moves:
            need(
                not arms,
                f"the lines from {begin + 1} to {end} arm or disarm the guard, and fit into the buffer",
            )
            continue
        armed = [on for _, on in arms] == [True, *[False] * (len(arms) - 1)] and len(arms) > 1
        need(armed, f"the guard isn't armed once, and then disarmed, from line {begin} on")
        (on, _), *off = arms
        need(on < moves[0], f"line {on}: the guard is armed late")
        behind = [line for line, _ in off] == list(range(moves[-1] + 1, moves[-1] + 1 + len(off)))
        need(behind, f"line {off[0][0]}: the guard isn't disarmed directly after the last move")
        need(end - moves[-1] >= low + _AHEAD, f"line {end}: the guard would hold the last moves")
        # From each line on, I16 lines contain enough moves, or all that are left.
        numbers = [on, *moves]
        last = [*moves[moves_needed - 1 :], *([moves[-1]] * moves_needed)]
        for number, ahead in zip(numbers, last, strict=False):
            need(ahead - number <= low, f"I16 lines after line {number} have too few moves for a hold")


def check_variables(text: Text, robot: dict[str, Any], outputs: list[str]) -> None:
    """Check that only outputs are assigned, and that conditions, watches and searches read no variable of the
    guard or of motors.
    """
    puts = [
        what for item in text.course for _, what in (*item.puts, (0, item.what if item.kind == "put" else ""))
    ]
    known = set(outputs)
    for put in [*filter(None, puts), *text.safe]:
        need(put.partition("=")[0] in known, f"{put}: no output of the program")
    need(len({put.partition("=")[0] for put in text.safe}) == len(text.safe), "an output has two safe values")
    conditions = [what.split()[2] for what, _, _ in text.barriers.values()]
    conditions += [line.split()[2] for line in text.registers if line.startswith("; watch ")]
    conditions += [line.split()[3] for line in text.registers if line.startswith("; search ")]
    asked = [name for condition in conditions for name in _NAMED.findall(condition)]
    for name in [*asked, *outputs]:
        own = _OWN.fullmatch(name) or name in robot["feedback"] or int(name[1:]) > 8191
        need(not own and name[1:] == str(int(name[1:])), f"{name} is a variable of the guard or of motors")
    for what, _, kind in text.barriers.values():
        into, assigns, _ = what.split()[2].partition(":=")
        if kind == "set" and assigns and not into.startswith("$"):
            need(set(into.split(",")) <= known, f"{into}: no output of the program")


def check_start(text: Text, robot: dict[str, Any], start: list[Fraction]) -> None:
    """Check that the controller text starts where the program and the text's header say, to the last
    printed digit.
    """
    exact = min(Fraction(1, 2 * 10**text.decimals), Fraction(1, 1000)) + Fraction(1, 10**9)
    for at, meant in zip(text.start, start, strict=True):
        need(abs(Fraction(at, PRINTED) - meant) <= exact, "the text starts elsewhere than the program")
    numbers = re.findall(r"([A-Z])(-?[0-9]+(?:\.[0-9]+)?)", text.start_said)
    need("".join(map("".join, numbers)) == text.start_said, "the header's start can't be read")
    need([axis for axis, _ in numbers] == robot["axes"], "the header's start has other axes")
    for at, (_, said) in zip(text.start, numbers, strict=True):
        if abs(Fraction(at, PRINTED) - Fraction(said)) > Fraction(1, 10**9):
            raise RefusedError("the header says another start than the text has")
