"""Counts of wrong passwords. After five of them, each further login attempt has to wait. No I/O: the
functions get the time as an argument.

Wrong attempts are counted for each pair of a user name and an origin, which is called a place. The origin is
the device if this user has logged in on it before, otherwise the network address. So only the guesser has to
wait, and can't lock users out of the devices that they use every day.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

FREE = 5
"""Number of wrong attempts of one place (user name and origin) that cause no wait."""

FREE_FROM_ADDRESS = 30
"""Number of wrong attempts from one network address, with any user names, that cause no wait."""

FIRST_WAIT, LONGEST_WAIT = 2.0, 300.0
"""First wait and longest wait before the next login attempt [s]. The wait doubles with each further wrong
attempt.
"""

FORGOTTEN = 3600.0
"""Time after which wrong attempts are forgotten [s]."""

_MOST = 4096
"""Largest number of places (user name and origin) whose wrong attempts are stored. If there are more, the
place whose last wrong attempt is the oldest is forgotten.
"""

Place = tuple[str, str]
"""Place of a login attempt: the user name in lower case, and the device or network address from which it
comes.
"""


@dataclass(slots=True)
class _Failures:
    count: int
    last: float


class Attempts:
    """Counter of wrong attempts for each place."""

    def __init__(self) -> None:
        self._failures: OrderedDict[Place, _Failures] = OrderedDict()

    def wait(self, place: Place, now: float, free: int = FREE) -> float:
        """Return the wait until the next login attempt of a place is accepted [s]; 0 if it is accepted at
        once.

        Args:
            place: user name and origin of the attempt.
            now: time of a monotonic clock [s].
            free: number of wrong attempts before the first wait.
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
        """Take back the last wrong attempt of a place. Used if the password wasn't checked, because too many
        other checks were waiting.
        """
        if (found := self._failures.get(place)) is not None:
            found.count -= 1

    def passed(self, place: Place) -> None:
        """Forget the wrong attempts of a place after a correct password."""
        self._failures.pop(place, None)
