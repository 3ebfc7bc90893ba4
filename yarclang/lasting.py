"""How long a program takes: the seconds that are known before it runs, and the number of its waits.

Motions and dwells take a known time. A WAIT on an input and a HOLD end when somebody else decides: their time isn't known, so they are counted. The two
ways of a WHEN may take different times: then a program takes from the shortest to the longest. Every room and every command takes its figures from here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Literal

from yarclang.frozen import frozen

Mark = Literal["wait", "hold", "when", "else", "end", "finish"]
Part = float | Mark
"""What a program does, in order: a known time [s], or something whose time isn't known; and where its ways part and meet."""

_PRINTED = 5e-4
"""Times that differ by less are printed as one [s]."""


@frozen
class Lasting:
    """The time that something takes.

    `least` and `most` [s] are the known times of motions and dwells along the shortest and the longest ways; `fewest` and `waits` count what waits for an
    input or the operator, along the ways with the fewest and the most of them.
    """

    least: float = 0.0
    most: float = 0.0
    fewest: int = 0
    waits: int = 0

    def then(self, other: Lasting) -> Lasting:
        """Return the time of this, and of another thing after it."""
        return Lasting(
            self.least + other.least,
            self.most + other.most,
            self.fewest + other.fewest,
            self.waits + other.waits,
        )

    def either(self, other: Lasting) -> Lasting:
        """Return the time of this or of another thing: nobody knows which of both is done."""
        return Lasting(
            min(self.least, other.least),
            max(self.most, other.most),
            min(self.fewest, other.fewest),
            max(self.waits, other.waits),
        )

    def times(self, count: int) -> Lasting:
        """Return the time of doing this `count` times."""
        return Lasting(count * self.least, count * self.most, count * self.fewest, count * self.waits)

    @property
    def varies(self) -> bool:
        """True if the ways take different times, as they are printed."""
        return self.most - self.least > _PRINTED

    def text(self, seconds: Callable[[float], str] | None = None) -> str:
        """Return the time in words: `7.953 s`, `140.000 s and 40 waits`, `5.000 to 7.953 s and 1 to 2 waits`.

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
        if not self.waits:
            return known
        count = f"{self.waits}" if self.fewest == self.waits else f"{self.fewest} to {self.waits}"
        return f"{known} and {count} wait{'s' * (self.waits != 1)}"

    def to_json(self) -> dict[str, float | int]:
        """Return plain data, the unit in each name."""
        return {
            "duration_s": self.most,
            "duration_at_least_s": self.least,
            "waits": self.waits,
            "waits_at_least": self.fewest,
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
class _Parting:
    """A WHEN that is open: what it took up to there, its clock there, and its first way with the clock at the end of it, once that is known."""

    before: Lasting
    clock: float
    first: Lasting | None = None
    end: float = 0.0
    first_ends: bool = False
    """True if the program ends in the first way."""


def schedule_of(parts: Iterable[Part]) -> Schedule:
    """Compute when each part of a program begins, and how long all of it takes. A way without an end, of a program with errors, ends with the program."""
    so_far, place, clock, ends = NO_TIME, 0.0, 0.0, False
    endings: list[Lasting] = []
    open_: list[_Parting] = []
    places, clocks = [], []
    for part in parts:
        places.append(place)
        if part == "else" and open_:
            parting = open_.pop()
            open_.append(_Parting(parting.before, parting.clock, so_far, clock, ends))
            so_far, clock, ends = NO_TIME, parting.clock, False
        clocks.append(clock)
        match part:
            case "wait" | "hold":
                so_far = so_far.then(Lasting(fewest=1, waits=1))
            case "when":
                open_.append(_Parting(so_far, clock))
                so_far = NO_TIME
            case "finish":
                whole = so_far
                for parting in reversed(open_):
                    whole = parting.before.then(whole)
                endings.append(whole)
                ends = True
            case "end" if open_:
                (so_far, clock), ends = _met(open_[-1], so_far, clock, ends), open_.pop().first_ends and ends
            case float():
                so_far, place, clock = so_far.then(known(part)), place + part, clock + part
            case _:
                pass
    while open_:
        so_far, clock = _met(open_.pop(), so_far, clock, ends)
        ends = False
    if ends and endings:  # the program ends in all its ways
        so_far = endings.pop()
    for one in endings:
        so_far = so_far.either(one)
    return Schedule(so_far, (*places, place), (*clocks, clock))


def _met(parting: _Parting, way: Lasting, clock: float, ends: bool) -> tuple[Lasting, float]:
    """Return the time up to where two ways meet, and the clock there. A way in which the program ends doesn't get there."""
    other, end = (NO_TIME, parting.clock) if parting.first is None else (parting.first, parting.end)
    if parting.first_ends:
        return parting.before.then(way), clock
    if ends:
        return parting.before.then(other), end
    return parting.before.then(way.either(other)), max(clock, end)


def _seconds(seconds: float) -> str:
    return f"{seconds:.3f} s"
