"""Counts of wrong passwords: after five of them, each further attempt has to wait. No I/O; times are
arguments.

An attempt is counted for the user that it names *and* the place that it comes from: the device, if that user
has logged in there before, otherwise the address. Guessing therefore slows down only the guesser, and can't
lock users out of the devices that they use every day.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

FREE = 5
"""Wrong attempts before the first wait."""

FREE_FROM_ADDRESS = 30
"""Wrong attempts before the first wait, for all users together that one address names."""

FIRST_WAIT, LONGEST_WAIT = 2.0, 300.0
"""First wait [s], and the longest: the wait doubles with each further wrong attempt."""

FORGOTTEN = 3600.0
"""Time after which wrong attempts are forgotten [s]."""

_MOST = 4096
"""Places that are remembered. The one that has been quiet for longest is forgotten first."""

Place = tuple[str, str]
"""User name of the attempt in lower case, and its device or address."""


@dataclass(slots=True)
class _Failures:
    count: int
    last: float


class Attempts:
    """Counter of wrong attempts for each place."""

    def __init__(self) -> None:
        self._failures: OrderedDict[Place, _Failures] = OrderedDict()

    def wait(self, place: Place, now: float, free: int = FREE) -> float:
        """Return the time until a place's next attempt is checked [s]; 0 if it is checked at once.

        Args:
            place: from which the attempt comes.
            now: a monotonic clock [s].
            free: wrong attempts before the first wait.
        """
        found = self._failures.get(place)
        if found is None or now - found.last > FORGOTTEN:
            return 0.0
        if found.count < free:
            return 0.0
        wanted = min(FIRST_WAIT * 2.0 ** min(found.count - free, 30), LONGEST_WAIT)
        return max(0.0, wanted - (now - found.last))

    def failed(self, place: Place, now: float) -> int:
        """Count a wrong attempt and return the place's number of them."""
        found = self._failures.pop(place, None)
        if found is None or now - found.last > FORGOTTEN:
            found = _Failures(0, now)
        found.count, found.last = found.count + 1, now
        self._failures[place] = found
        while len(self._failures) > _MOST:
            self._failures.popitem(last=False)
        return found.count

    def forgive(self, place: Place) -> None:
        """Remove the last wrong attempt of a place, because its password wasn't checked."""
        if (found := self._failures.get(place)) is not None:
            found.count -= 1

    def passed(self, place: Place) -> None:
        """Forget the wrong attempts of a place after a right password."""
        self._failures.pop(place, None)
