"""Counts of wrong passwords: after five of them, each further attempt has to wait. No I/O; times are
arguments.

An attempt is counted for a pair: the user name, and the place from which the attempt comes. The place is the
device if that user has logged in on it before, otherwise the address. So guessing slows down only the
guesser, and can't lock users out of the devices that they use every day.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

FREE = 5
"""Wrong attempts before the first wait."""

FREE_FROM_ADDRESS = 30
"""Wrong attempts from one address before the first wait, summed over all user names."""

FIRST_WAIT, LONGEST_WAIT = 2.0, 300.0
"""First wait and longest wait [s]. The wait doubles with each further wrong attempt."""

FORGOTTEN = 3600.0
"""Time after which wrong attempts are forgotten [s]."""

_MOST = 4096
"""Most places that are remembered. If there are more, the one without attempts for the longest time is
forgotten.
"""

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
            place: user name and place of the attempt.
            now: a monotonic clock [s].
            free: wrong attempts before the first wait.
        """
        failures = self._failures.get(place)
        if failures is None or now - failures.last > FORGOTTEN:
            return 0.0
        if failures.count < free:
            return 0.0
        wanted = min(FIRST_WAIT * 2.0 ** min(failures.count - free, 30), LONGEST_WAIT)
        return max(0.0, wanted - (now - failures.last))

    def failed(self, place: Place, now: float) -> int:
        """Count a wrong attempt. Return the number of wrong attempts of its place."""
        failures = self._failures.pop(place, None)
        if failures is None or now - failures.last > FORGOTTEN:
            failures = _Failures(0, now)
        failures.count, failures.last = failures.count + 1, now
        self._failures[place] = failures
        while len(self._failures) > _MOST:
            self._failures.popitem(last=False)
        return failures.count

    def forgive(self, place: Place) -> None:
        """Remove the last wrong attempt of a place. Called if the password couldn't be checked."""
        if (found := self._failures.get(place)) is not None:
            found.count -= 1

    def passed(self, place: Place) -> None:
        """Forget the wrong attempts of a place after a correct password."""
        self._failures.pop(place, None)
