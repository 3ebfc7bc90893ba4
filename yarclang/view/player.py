"""The time that is shown: it stands, or runs at some speed from its beginning to its end. It knows no clock."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Player:
    """`time` [s] of `duration`; while `plays`, `factor` seconds of it pass in a second."""

    duration: float
    time: float = 0.0
    factor: float = 1.0
    plays: bool = False

    def pass_by(self, seconds: float) -> bool:
        """Let time pass.

        Returns:
            Whether the time that is shown is another one now. At the end it stops.
        """
        if not self.plays or seconds <= 0.0:
            return False
        self.time = min(self.time + seconds * self.factor, self.duration)
        if self.time >= self.duration:
            self.plays = False
        return True

    def press(self) -> None:
        """Begin or stop to play; from the end it begins anew."""
        self.plays = not self.plays and self.duration > 0.0
        if self.plays and self.time >= self.duration:
            self.time = 0.0

    def jump(self, time: float) -> None:
        """Go to a time, or to the end that is nearest to it."""
        self.time = min(max(time, 0.0), self.duration)
