"""How a robot hangs on a Turbo PMAC, as its robot.toml says."""

from __future__ import annotations

from typing import TYPE_CHECKING

from yarclang.frozen import frozen
from yarclang.pmac.variables import signal_variable
from yarclang.robot.controller import SignalVariable

if TYPE_CHECKING:
    from yarclang.robot.model import Robot

NAME = "turbo-pmac"


@frozen
class TurboPmac:
    """How the robot hangs on its controller, and the controller's own settings.

    `axes`, `motors` and `feedback` have one entry a joint (motor k is row k of the
    actuation matrix). Times are in s, `ixx08` is the position scale factor, `rotary_words`
    the least size of the rotary buffer, `i8` and `i10` the controller's I-variables.
    """

    kind: str
    coordinate_system: int
    axes: tuple[str, ...]
    motors: tuple[int, ...]
    feedback: tuple[str, ...]
    largest_segment: float
    ixx08: int
    rotary_words: int
    hold_time: float
    rapid_share: float
    i8: int
    i10: int

    @property
    def servo_period(self) -> float:
        """The time between two servo interrupts [s]: I10 is in 1/8,388,608 ms (TSRM 43)."""
        return self.i10 / 8_388_608.0 * 1e-3

    @property
    def smallest_segment(self) -> float:
        """The shortest segment that the controller calculates in time [s]: three real-time
        interrupts, one each I8 + 1 servo periods.
        """
        return 3.0 * (self.i8 + 1) * self.servo_period

    @property
    def text(self) -> str:
        """The coordinate system, for people."""
        return f"coordinate system {self.coordinate_system}"

    @property
    def timing(self) -> str:
        """The variables that the shortest segment follows from."""
        return f"I8={self.i8} and I10={self.i10}"

    def signal(self, text: str) -> SignalVariable:
        """Return what a text in upper case names as the variable of an input or output."""
        return signal_variable(text, self.feedback)


def turbo_pmac(robot: Robot) -> TurboPmac:
    """Return the controller of a robot that hangs on a Turbo PMAC."""
    controller = robot.controller
    assert isinstance(controller, TurboPmac)
    return controller
