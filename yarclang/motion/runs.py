"""How many motions are worked out together: more, the longer what is asked for follows one upon the other."""

from __future__ import annotations

from dataclasses import dataclass

MOST = 64
"""Motions that are worked out together at most: more take no less time each, and more memory."""


@dataclass(slots=True)
class Growing:
    """The number of motions that are worked out together: 1 where a single one is asked for, as after an edit, and twice as many each time that the
    next ones are, up to `most` (None: `MOST`).
    """

    most: int | None = None
    _size: int = 1
    _next: int = -1

    def size(self, number: int) -> int:
        """Return how many motions to work out together from step `number` on."""
        self._size = min(2 * self._size, self.most or MOST) if number == self._next else 1
        self._next = number + 1
        return self._size

    def done(self, number: int) -> None:
        """Take it that `number` is the last step that was worked out."""
        self._next = number + 1
