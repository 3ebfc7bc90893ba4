"""Results of checked random programs, and sums of these results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

_MOST_FINDS = 1000
"""Largest number of faulty programs that are kept in a sum."""


class Find(NamedTuple):
    """A program that has faults.

    Attributes:
        seed: seed of the program.
        robot: name or path of its robot.
        faults: the faults, as sentences.
    """

    seed: int
    robot: str
    faults: tuple[str, ...]


class Worst(NamedTuple):
    """The largest used fraction of a tolerance or a limit, and the seed of the first program that reached
    it.
    """

    share: float
    seed: int


@dataclass
class Piece:
    """Sum of the results of random programs with consecutive seeds.

    Attributes:
        first: the first seed.
        count: number of programs.
        compiled: number of programs that compile.
        refused: for each error code, the number of programs that don't compile and whose first error has
            this code.
        drawn: number of motions of each kind in all programs, whether they compile or not. A kind is a name
            under which motions are counted; a motion may have several.
        motions: number of motions of each kind in the programs that compile.
        microseconds: time of all motions in programs that compile [us]. It is an integer, so that the sum
            doesn't depend on the order.
        worst: for each tolerance and limit, the largest fraction of it that any program has used.
        finds: programs that have faults; at most `_MOST_FINDS`.
        found: number of programs that have faults, including those that aren't in `finds`.
        seconds: processor time of the work [s].
    """

    first: int
    count: int
    compiled: int = 0
    refused: dict[str, int] = field(default_factory=dict)
    drawn: dict[str, int] = field(default_factory=dict)
    motions: dict[str, int] = field(default_factory=dict)
    microseconds: int = 0
    worst: dict[str, Worst] = field(default_factory=dict)
    finds: list[Find] = field(default_factory=list)
    found: int = 0
    seconds: float = 0.0

    def add(
        self,
        seed: int,
        robot: str,
        refused: str,
        faults: tuple[str, ...],
        worst: Mapping[str, float],
        duration: float,
        features: Iterable[tuple[str, ...]],
    ) -> None:
        """Add the result of one program to this sum. `refused` is the code of the program's first error,
        empty if it compiles.
        """
        names = [name for one in features for name in one]
        _add(self.drawn, names)
        if refused:
            _add(self.refused, [refused])
        elif worst:
            self.compiled += 1
            self.microseconds += round(duration * 1e6)
            _add(self.motions, names)
        for name, share in worst.items():
            self._count(name, Worst(float(share), seed))
        if faults:
            self.found += 1
            self.finds.append(Find(seed, robot, faults))

    def _count(self, name: str, one: Worst) -> None:
        """Keep the largest used fraction of a tolerance or limit; of equal fractions, the one with the
        smallest seed.
        """
        known = self.worst.get(name)
        if known is None or (one.share, -one.seed) > (known.share, -known.seed):
            self.worst[name] = one

    def merge(self, other: Piece) -> None:
        """Add the results of another piece. The sum doesn't depend on the order of additions."""
        self.count += other.count
        self.compiled += other.compiled
        self.microseconds += other.microseconds
        self.seconds += other.seconds
        self.found += other.found
        for name in ("refused", "drawn", "motions"):
            ours, theirs = getattr(self, name), getattr(other, name)
            for key, number in theirs.items():
                ours[key] = ours.get(key, 0) + number
        for key, one in other.worst.items():
            self._count(key, one)
        self.finds = sorted([*self.finds, *other.finds])[:_MOST_FINDS]

    @property
    def written(self) -> dict[str, Any]:
        """Return the piece as data for JSON."""
        return {
            "first": self.first,
            "count": self.count,
            "compiled": self.compiled,
            "refused": self.refused,
            "drawn": self.drawn,
            "motions": self.motions,
            "microseconds": self.microseconds,
            "worst": {name: [one.share, one.seed] for name, one in self.worst.items()},
            "finds": [[one.seed, one.robot, list(one.faults)] for one in self.finds],
            "found": self.found,
            "seconds": self.seconds,
        }


def lost_piece(seed: int, robot: str, reason: str) -> Piece:
    """Return the result for a program whose check couldn't be finished: all processes that ran it were
    killed.
    """
    return Piece(seed, 1, finds=[Find(seed, robot, (reason,))], found=1)


def piece_of(data: Mapping[str, Any]) -> Piece:
    """Return the sum of results that JSON data describe.

    Raises:
        KeyError, TypeError, ValueError: the data don't describe a piece.
    """
    return Piece(
        first=int(data["first"]),
        count=int(data["count"]),
        compiled=int(data["compiled"]),
        refused=_numbers(data["refused"]),
        drawn=_numbers(data["drawn"]),
        motions=_numbers(data["motions"]),
        microseconds=int(data["microseconds"]),
        worst={str(name): Worst(float(share), int(seed)) for name, (share, seed) in data["worst"].items()},
        finds=[Find(int(seed), str(robot), tuple(map(str, faults))) for seed, robot, faults in data["finds"]],
        found=int(data["found"]),
        seconds=float(data["seconds"]),
    )


def _add(counts: dict[str, int], names: Iterable[str]) -> None:
    for name in names:
        counts[name] = counts.get(name, 0) + 1


def _numbers(data: Mapping[str, Any]) -> dict[str, int]:
    return {str(name): int(number) for name, number in data.items()}
