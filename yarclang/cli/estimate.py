"""Estimate the progress and the remaining time of a compilation.

The estimate covers all stages of a compilation, although most of them can't count their work. Functions get
the current time as an argument.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

_STAGES = (
    ("reading", 6.0, 1.0),
    ("checking", 8.0, 1.0),
    ("planning", 45.0, 0.5),
    ("writing the controller text", 6.0, 1.0),
    ("certifying", 33.0, 1.0),
    ("looking for warnings and notes", 2.0, 1.0),
)
"""Stages of a compilation in their order. Each has three values: the text with which its reports begin, its
relative duration, and the share of the stage that is done when its count is complete. The durations were
measured with long chains of lines. For planning the share is 0.5, because the count is complete before the
motions are joined to chains.
"""

_WHOLE = sum(weight for _, weight, _ in _STAGES)
_BEFORE = tuple(sum(weight for _, weight, _ in _STAGES[:number]) for number in range(len(_STAGES)))

_SURE = 0.05
"""Share of the work that must be done before a remaining time is shown."""
_SLOWLY = 4.0
"""Time constant with which the remaining time approaches a new estimate [s], so that the display doesn't
jump.
"""


@lru_cache(maxsize=256)
def stage_of(what: str) -> int | None:
    """Return the number of the stage that a report of progress is about; None if it isn't about a stage of a
    compilation.

    The report may begin with the name of a file: `a.yarc: planning`.
    """
    found = [
        number for number, (name, *_) in enumerate(_STAGES) if what.startswith(name) or f": {name}" in what
    ]
    return max(found, key=lambda number: len(_STAGES[number][0]), default=None)


@dataclass(slots=True)
class Estimate:
    """Estimated progress of one compilation, or of several files in turn. The share that is done never
    decreases, except when a file is attempted again.

    Attributes:
        file: number of finished files.
        files: number of all files.
    """

    file: int = 0
    files: int = 1
    _stage: int = -1
    _share: float = 0.0
    _begun: float = 0.0
    _entered: float = 0.0
    _counted: float | None = None
    _left: float | None = None
    _looked: float = 0.0

    def tell(self, stage: int, done: int, total: int, now: float) -> None:
        """Take into account a stage's report of progress at the time `now` [s]."""
        if stage < self._stage or self._stage < 0:
            # a new file or a new attempt begins: the remaining time is unknown again
            self._share, self._begun, self._entered, self._left = 0.0, now, now, None
            self._counted = None
        elif stage > self._stage:
            self._entered, self._counted = now, None
        self._stage = stage
        if 0 < total <= done + 1 and self._counted is None:
            self._counted = now
        inside = min(done / total, 1.0) * _STAGES[stage][2] if total > 0 else 0.0
        self._reach(stage, max(inside, self._passed(stage, now)))

    def share(self, now: float) -> float:
        """Return the share of the work on all files that is done, 0 to 1."""
        if self._stage >= 0:
            self._reach(self._stage, self._passed(self._stage, now))
        return (self.file + self._share) / max(self.files, 1)

    def left(self, now: float) -> float | None:
        """Return the remaining time [s]; None before it is known."""
        share = self.share(now)
        if self._stage < 0 or self._share < _SURE or (self.file and share <= 0.0):
            return None
        found = (now - self._begun) * (self.files - self.file - self._share) / self._share
        if self._left is None:
            self._left = found
        else:
            passed = now - self._looked
            expected = max(self._left - passed, 0.0)
            self._left = expected + (found - expected) * (1.0 - math.exp(-passed / _SLOWLY))
        self._looked = now
        return self._left

    def _reach(self, stage: int, inside: float) -> None:
        self._share = max(self._share, (_BEFORE[stage] + _STAGES[stage][1] * inside) / _WHOLE)

    def _passed(self, stage: int, now: float) -> float:
        """Return the share of a stage that is done according to the elapsed time; always less than 1. It is 0
        if the expected time of the stage is unknown.
        """
        before, (_, weight, counted) = _BEFORE[stage], _STAGES[stage]
        if self._counted is not None and counted < 1.0:
            # assume that the rest of the stage is as fast as the counted work
            took = max(self._counted - self._entered, 1e-3)
            return counted + (1.0 - counted) * _eased(
                (now - self._counted) / took * counted / (1.0 - counted)
            )
        if before <= 0.0 or self._entered <= self._begun:
            return 0.0
        expected = (self._entered - self._begun) / before * weight
        return _eased((now - self._entered) / max(expected, 1e-3)) * counted


_EVEN = 0.7
"""Share of a stage's expected time up to which the displayed progress is linear. After that time the
displayed progress slows down.
"""


def _eased(share: float) -> float:
    """Return the share of a stage that is displayed as done, after the share `share` of the stage's expected
    time has passed. The result is always less than 1.
    """
    if share < _EVEN:
        return share
    return 1.0 - (1.0 - _EVEN) * math.exp((_EVEN - share) / (1.0 - _EVEN))


def left_text(seconds: float | None) -> str:
    """Format the remaining time. It is rounded, since it is only an estimate."""
    if seconds is None:
        return ""
    if seconds < 5.0:
        return "a few seconds left"
    if seconds < 55.0:
        return f"about {round(seconds / 5.0) * 5} s left"
    if seconds < 90.0:
        return "about a minute left"
    return f"about {round(seconds / 60.0)} min left"
