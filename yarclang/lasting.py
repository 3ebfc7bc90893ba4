"""How long a program takes: the seconds that are known before it runs, and the number of its waits.

Motions and dwells take a known time. A WAIT on an input and a HOLD end when somebody else decides: their time isn't known, so they are counted. The two
ways of a WHEN may take different times: then a program takes from the shortest to the longest. How many passes a loop makes isn't known either: in the longest time each loop
makes one, or as many as lead to its end at least, and what is said of it says so. Every room and every command takes its figures from here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Literal

from yarclang.frozen import frozen

Mark = Literal["wait", "hold", "ask", "when", "else", "end", "finish", "loop", "next", "exit", "endloop"]
Part = float | Mark
"""What a program does, in order: a known time [s], or something whose time isn't known; and where its ways part (`ask`: behind a wait) and meet."""

ONCE = "each loop once"
"""Stands behind times of which nobody knows how often loops are gone through."""

_PRINTED = 5e-4
"""Times that differ by less are printed as one [s]."""


@frozen
class Lasting:
    """The time that something takes.

    `least` and `most` [s] are the known times of motions and dwells along the shortest and the longest ways; `fewest` and `waits` count what waits for an
    input or the operator, along the ways with the fewest and the most of them. `loops`: they count each loop once.
    """

    least: float = 0.0
    most: float = 0.0
    fewest: int = 0
    waits: int = 0
    loops: bool = False

    def then(self, other: Lasting) -> Lasting:
        """Return the time of this, and of another thing after it."""
        return Lasting(
            self.least + other.least,
            self.most + other.most,
            self.fewest + other.fewest,
            self.waits + other.waits,
            self.loops or other.loops,
        )

    def either(self, other: Lasting) -> Lasting:
        """Return the time of this or of another thing: nobody knows which of both is done."""
        return Lasting(
            min(self.least, other.least),
            max(self.most, other.most),
            min(self.fewest, other.fewest),
            max(self.waits, other.waits),
            self.loops or other.loops,
        )

    def times(self, count: int) -> Lasting:
        """Return the time of doing this `count` times."""
        return Lasting(
            count * self.least, count * self.most, count * self.fewest, count * self.waits, self.loops
        )

    @property
    def varies(self) -> bool:
        """True if the ways take different times, as they are printed."""
        return self.most - self.least > _PRINTED

    def text(self, seconds: Callable[[float], str] | None = None) -> str:
        """Return the time in words: `7.953 s`, `140.000 s and 40 waits`, `5.000 to 7.953 s and 1 to 2 waits`, `0.000 to 7.953 s, each loop once`.

        Args:
            seconds: writes a time, with its unit; None: in s with three decimals.
        """
        write = seconds or _seconds
        least, most = write(self.least), write(self.most)
        if not self.varies or least == most:
            known = most
        else:
            # of two numbers with one unit, the second has it
            (number, *unit), (_, *other) = least.split(), most.split()
            known = f"{number if len(unit) == 1 and unit == other else least} to {most}"
        once = f", {ONCE}" if self.loops else ""
        if not self.waits:
            return f"{known}{once}"
        count = f"{self.waits}" if self.fewest == self.waits else f"{self.fewest} to {self.waits}"
        return f"{known} and {count} wait{'s' * (self.waits != 1)}{once}"

    def to_json(self) -> dict[str, float | int | bool]:
        """Return plain data, the unit in each name."""
        return {
            "duration_s": self.most,
            "duration_at_least_s": self.least,
            "waits": self.waits,
            "waits_at_least": self.fewest,
            "loops": self.loops,
        }


NO_TIME = Lasting()


def known(seconds: float) -> Lasting:
    """Return a time without waits [s]."""
    return Lasting(seconds, seconds)


@frozen
class Schedule:
    """When each part of a program begins.

    Attributes:
        lasting: the time of all of it.
        places: of each part, and of the end, the time [s] with the ways of a WHEN one after the other, as they are drawn: each place of the program has its own.
        clocks: of each part, and of the end, the latest known time [s] at which the program gets there: both ways of a WHEN begin at once, and what
            comes after them begins after the longer way.
    """

    lasting: Lasting
    places: tuple[float, ...]
    clocks: tuple[float, ...]


@frozen
class _Open:
    """A WHEN or a loop that isn't ended: what the program took up to there, and the clock there.

    `other` is the time of the first way of a WHEN, or that up to the EXITs of a loop (None: there is none yet), `end` the clock at its end, and `ends` is True if the program
    doesn't come to the end of the first way. `whole` is the time of the passes that lead to another one.
    """

    before: Lasting
    clock: float
    is_loop: bool = False
    other: Lasting | None = None
    end: float = 0.0
    ends: bool = False
    whole: Lasting | None = None


@dataclass(slots=True)
class _Clock:
    """What was gone through: `so_far` since the innermost thing that is open, and the latest clock here. `ends`: no way leads here."""

    so_far: Lasting = NO_TIME
    clock: float = 0.0
    ends: bool = False
    open: list[_Open] = field(default_factory=list)
    endings: list[Lasting] = field(default_factory=list)
    """The times of the ways in which the program ends, or goes on for ever."""

    def take(self, mark: Mark) -> None:
        """Go through what takes no known time."""
        match mark:
            case "wait" | "hold":
                self.so_far = self.so_far.then(Lasting(fewest=1, waits=1))
            case "ask":
                self.take("wait")
                self.take("when")
            case "when" | "loop":
                self.open.append(_Open(self.so_far, self.clock, mark == "loop"))
                self.so_far = NO_TIME
            case "else" if self.open:
                top = self.open[-1]
                self.open[-1] = replace(top, other=self.so_far, end=self.clock, ends=self.ends)
                self.so_far, self.clock, self.ends = NO_TIME, top.clock, False
            case "finish":
                self.endings.append(self._since(0))
                self.ends = True
            case "next" | "exit":
                self._leave(mark)
                self.ends = True
            case "end" if self.open:
                self._met(self.open.pop())
            case "endloop" if self.open:
                self._left(self.open.pop())
            case _:
                pass

    def _since(self, depth: int) -> Lasting:
        """Return the time since what is open so deep, or since the program's start."""
        whole = self.so_far
        for one in reversed(self.open[depth:]):
            whole = one.before.then(whole)
        return whole

    def _leave(self, mark: Mark) -> None:
        at = next((at for at in range(len(self.open) - 1, -1, -1) if self.open[at].is_loop), None)
        if at is None or self.ends:
            return
        loop, took = self.open[at], self._since(at + 1)
        if mark == "next":
            took = replace(took, loops=True)
            self.open[at] = replace(loop, whole=took if loop.whole is None else loop.whole.either(took))
        else:
            other = took if loop.other is None else loop.other.either(took)
            self.open[at] = replace(loop, other=other, end=max(loop.end, self.clock))

    def _met(self, when: _Open) -> None:
        """Go on where two ways meet. One in which the program ends doesn't get there."""
        other, end = (NO_TIME, when.clock) if when.other is None else (when.other, when.end)
        if when.ends:
            self.so_far = when.before.then(self.so_far)
        elif self.ends:
            self.so_far, self.clock, self.ends = when.before.then(other), end, False
        else:
            self.so_far, self.clock = when.before.then(self.so_far.either(other)), max(self.clock, end)

    def _left(self, loop: _Open) -> None:
        """Go on behind a loop, which takes a pass and more, or just the way to where it is left."""
        took = None if self.ends else self.so_far
        if loop.other is not None:
            took = loop.other if took is None else took.either(loop.other)
            self.clock = loop.end if self.ends else max(self.clock, loop.end)
        if took is None:  # it goes on for ever, or the program ends in it
            if loop.whole is not None:
                self.so_far = loop.before.then(loop.whole)
                self.endings.append(self._since(0))
            return
        if loop.whole is not None:
            least, most = min(took.least, took.most), max(took.most, loop.whole.most)
            took = Lasting(least, most, took.fewest, max(took.waits, loop.whole.waits), True)
            self.clock = max(self.clock, loop.clock + most)
        self.so_far, self.ends = loop.before.then(took), False


def schedule_of(parts: Iterable[Part]) -> Schedule:
    """Compute when each part of a program begins, and how long all of it takes. A way without an end, of a program with errors, ends with the program."""
    now, place = _Clock(), 0.0
    places, clocks = [], []
    for part in parts:
        places.append(place)
        # a second way begins with the clock of the first one
        clocks.append(now.open[-1].clock if part == "else" and now.open else now.clock)
        if isinstance(part, float):
            now.so_far, place, now.clock = now.so_far.then(known(part)), place + part, now.clock + part
        else:
            now.take(part)
    while now.open:
        if now.open[-1].is_loop:
            now.take("endloop")
        else:
            now.take("end")
        now.ends = False
    so_far, endings = now.so_far, now.endings
    if now.ends and endings:  # the program ends in all its ways
        so_far = endings.pop()
    for one in endings:
        so_far = so_far.either(one)
    return Schedule(so_far, (*places, place), (*clocks, now.clock))


def _seconds(seconds: float) -> str:
    return f"{seconds:.3f} s"
