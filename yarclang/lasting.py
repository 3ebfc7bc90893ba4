"""Duration of a program: the time that is known before it runs, and the number of its waits.

Motions and dwells have a known duration. A WAIT for an input and a HOLD end at an unknown time, so they are
counted instead. The two branches of a WHEN may have different durations; a program then has a shortest and a
longest time. The number of passes of a loop is unknown as well, so the times count each loop once, and the
text of the duration says this (`ONCE`). All packages and commands get their times from this module.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Literal

from yarclang.frozen import frozen

Mark = Literal["wait", "hold", "ask", "when", "else", "end", "finish", "loop", "next", "exit", "endloop"]
Part = float | Mark
"""Part of a program: a known time [s], or a mark.

Marks stand for waits, branches and loops; `ask` is a wait followed by a branch.
"""

ONCE = "each loop once"
"""Text after times that count every loop once."""

_PRINTED = 5e-4
"""If the shortest and the longest time differ by at most this, only one time is printed [s]."""


@frozen
class Lasting:
    """Duration of a program or of some of its steps.

    Attributes:
        least: known time of motions and dwells, if the shortest branches are taken [s].
        most: known time of motions and dwells, if the longest branches are taken [s].
        fewest: smallest possible number of waits for an input or the operator.
        waits: largest possible number of waits for an input or the operator.
        loops: True if these values count each loop once.
    """

    least: float = 0.0
    most: float = 0.0
    fewest: int = 0
    waits: int = 0
    loops: bool = False

    def then(self, other: Lasting) -> Lasting:
        """Return the duration of this part followed by another part."""
        return Lasting(
            self.least + other.least,
            self.most + other.most,
            self.fewest + other.fewest,
            self.waits + other.waits,
            self.loops or other.loops,
        )

    def either(self, other: Lasting) -> Lasting:
        """Return the duration if either this part or another part is carried out."""
        return Lasting(
            min(self.least, other.least),
            max(self.most, other.most),
            min(self.fewest, other.fewest),
            max(self.waits, other.waits),
            self.loops or other.loops,
        )

    def times(self, count: int) -> Lasting:
        """Return the duration if this part is carried out `count` times."""
        return Lasting(
            count * self.least, count * self.most, count * self.fewest, count * self.waits, self.loops
        )

    @property
    def varies(self) -> bool:
        """True if the shortest and the longest time differ when printed."""
        return self.most - self.least > _PRINTED

    def text(self, seconds: Callable[[float], str] | None = None) -> str:
        """Return the duration in words.

        Examples: `7.953 s`, `140.000 s and 40 waits`, `5.000 to 7.953 s and 1 to 2 waits`, `0.000 to 7.953 s,
        each loop once`.

        Args:
            seconds: formats a time with its unit; None for seconds with three decimals.
        """
        write = seconds or _seconds
        least, most = write(self.least), write(self.most)
        if not self.varies or least == most:
            known = most
        else:
            # Two numbers with one unit: only the second number gets the unit.
            (number, *unit), (_, *other) = least.split(), most.split()
            known = f"{number if len(unit) == 1 and unit == other else least} to {most}"
        once = f", {ONCE}" if self.loops else ""
        if not self.waits:
            return f"{known}{once}"
        count = f"{self.waits}" if self.fewest == self.waits else f"{self.fewest} to {self.waits}"
        return f"{known} and {count} wait{'s' * (self.waits != 1)}{once}"

    def to_json(self) -> dict[str, float | int | bool]:
        """Return plain data for JSON, with the unit in each name."""
        return {
            "duration_s": self.most,
            "duration_at_least_s": self.least,
            "waits": self.waits,
            "waits_at_least": self.fewest,
            "loops": self.loops,
        }


NO_TIME = Lasting()


def known(seconds: float) -> Lasting:
    """Return a duration without waits, of a known time [s]."""
    return Lasting(seconds, seconds)


@frozen
class Schedule:
    """Start times of the parts of a program (such as its steps).

    Attributes:
        lasting: the duration of the whole program.
        places: start of each part, and the end of the program [s]. The branches of a WHEN are placed one
            after the other, as a chart draws them, so that each place in the program has a time of its own.
        clocks: latest known time at which the program reaches each part and its end [s]. Both branches of a
            WHEN begin at the same time, and the part after the WHEN begins after the longer branch.
    """

    lasting: Lasting
    places: tuple[float, ...]
    clocks: tuple[float, ...]


@frozen
class _Open:
    """A WHEN or a loop whose end hasn't been reached yet.

    Attributes:
        before: duration from the start of the enclosing WHEN or loop to the start of this one.
        clock: the clock at its start [s].
        is_loop: True for a loop.
        other: duration of the first branch of a WHEN, or of a loop up to its EXITs (None: none yet).
        end: the clock at the end of `other` [s].
        ends: True if the program does not reach the end of the first branch.
        whole: duration of a pass that another pass follows; None: no such pass yet.
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
    """The duration so far, while the parts of a program are visited in order.

    Attributes:
        so_far: duration since the start of the innermost open WHEN or loop.
        clock: latest known time here [s].
        ends: True if this place cannot be reached.
        open: the open WHENs and loops, outermost first.
        endings: durations of the branches in which the program ends, or repeats for ever.
    """

    so_far: Lasting = NO_TIME
    clock: float = 0.0
    ends: bool = False
    open: list[_Open] = field(default_factory=list)
    endings: list[Lasting] = field(default_factory=list)

    def take(self, mark: Mark) -> None:
        """Process a mark: a wait, or the start or end of a branch or a loop."""
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
        """Return the time since the body of the open WHEN or loop with index `depth` - 1 began.

        For depth 0, it is the time since the program's start.
        """
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
        """Merge the two branches of a WHEN. A branch in which the program ends is left out."""
        other, end = (NO_TIME, when.clock) if when.other is None else (when.other, when.end)
        if when.ends:
            self.so_far = when.before.then(self.so_far)
        elif self.ends:
            self.so_far, self.clock, self.ends = when.before.then(other), end, False
        else:
            self.so_far, self.clock = when.before.then(self.so_far.either(other)), max(self.clock, end)

    def _left(self, loop: _Open) -> None:
        """Add the duration of a loop, and continue after it. The shortest duration is that of the shortest
        way to the loop's end or to an EXIT. The longest duration is that of the longest single pass.
        """
        took = None if self.ends else self.so_far
        if loop.other is not None:
            took = loop.other if took is None else took.either(loop.other)
            self.clock = loop.end if self.ends else max(self.clock, loop.end)
        if took is None:  # the loop never ends, or the program ends in it
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
    """Compute when each part of a program begins, and the duration of the whole program.

    A WHEN or a loop without an end, in a program with errors, ends with the program.
    """
    now, place = _Clock(), 0.0
    places, clocks = [], []
    for part in parts:
        places.append(place)
        # The second branch of a WHEN begins at the same clock as the first one.
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
    if now.ends and endings:  # the program ends in all branches
        so_far = endings.pop()
    for one in endings:
        so_far = so_far.either(one)
    return Schedule(so_far, (*places, place), (*clocks, now.clock))


def _seconds(seconds: float) -> str:
    return f"{seconds:.3f} s"
