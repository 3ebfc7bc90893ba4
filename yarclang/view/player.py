"""The instant that the picture shows. It is constant, or it runs to the end at a chosen speed. This module
reads no clock.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Player:
    """The instant that the picture shows.

    Attributes:
        duration: the end of the time [s].
        time: the instant that is shown [s].
        factor: speed of the shown time relative to real time.
        plays: True while the time runs.
    """

    duration: float
    time: float = 0.0
    factor: float = 1.0
    plays: bool = False

    def pass_by(self, seconds: float) -> bool:
        """Advance the shown instant if the time runs; stop at the end.

        Args:
            seconds: real time that has passed [s].

        Returns:
            True if the shown instant has changed.
        """
        if not self.plays or seconds <= 0.0:
            return False
        self.time = min(self.time + seconds * self.factor, self.duration)
        if self.time >= self.duration:
            self.plays = False
        return True

    def press(self) -> None:
        """Start or stop. At the end, start again from the beginning."""
        self.plays = not self.plays and self.duration > 0.0
        if self.plays and self.time >= self.duration:
            self.time = 0.0

    def jump(self, time: float) -> None:
        """Go to a time [s]. Times outside of the range are limited to it."""
        self.time = min(max(time, 0.0), self.duration)
