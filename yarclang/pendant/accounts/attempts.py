"""Wrong passwords: after five of them each further attempt has to wait. No I/O; times come in as arguments.

An attempt is counted for the user that it names *and* the place that it comes from: the device, if that person has logged in there before, else the address. So whoever
guesses slows down only himself, and can't lock anybody out of the device that they use every day.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

FREE = 5
"""Wrong attempts before the first wait."""

FREE_FROM_ADDRESS = 30
"""The same for all users together that one address names."""

FIRST_WAIT, LONGEST_WAIT = 2.0, 300.0
"""The first wait, which doubles with each further wrong attempt up to the longest [s]."""

FORGOTTEN = 3600.0
"""Time after which wrong attempts are forgotten [s]."""

_MOST = 4096
"""Places that are remembered; the one that was quiet for longest is forgotten first."""

Place = tuple[str, str]
"""The user that is named, in lower case, and the device or address."""


@dataclass(slots=True)
class _Failures:
    count: int
    last: float


class Attempts:
    """Counts wrong attempts by their places."""

    def __init__(self) -> None:
        self._failures: OrderedDict[Place, _Failures] = OrderedDict()

    def wait(self, place: Place, now: float, free: int = FREE) -> float:
        """Return how long a place has to wait until its next attempt is looked at [s]; 0: it hasn't.

        Args:
            place: that the attempt comes from.
            now: a clock that never goes back [s].
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
        """Count a wrong attempt, and return how many there are now."""
        found = self._failures.pop(place, None)
        if found is None or now - found.last > FORGOTTEN:
            found = _Failures(0, now)
        found.count, found.last = found.count + 1, now
        self._failures[place] = found
        while len(self._failures) > _MOST:
            self._failures.popitem(last=False)
        return found.count

    def forgive(self, place: Place) -> None:
        """Take back the last wrong attempt of a place: it wasn't looked at."""
        if (found := self._failures.get(place)) is not None:
            found.count -= 1

    def passed(self, place: Place) -> None:
        """Forget the wrong attempts of a place: the right password was given."""
        self._failures.pop(place, None)
