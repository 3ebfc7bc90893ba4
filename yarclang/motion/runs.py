"""Decide how many consecutive motions are computed together. The number grows with the number of motions that
have been requested one after the other.
"""

from __future__ import annotations

from dataclasses import dataclass

MOST = 64
"""Largest number of motions computed together. A larger number would take more memory, and save no time."""


@dataclass(slots=True)
class Growing:
    """The number of consecutive motions that are computed together.

    The number is 1 if a single motion is requested, as after an edit. It doubles each time the next motions
    are requested, up to `most` (None: `MOST`).
    """

    most: int | None = None
    _size: int = 1
    _next: int = -1

    def size(self, number: int) -> int:
        """Return the number of motions to compute together, from step `number` on."""
        self._size = min(2 * self._size, self.most or MOST) if number == self._next else 1
        self._next = number + 1
        return self._size

    def done(self, number: int) -> None:
        """Record that `number` is the last step that was computed."""
        self._next = number + 1
