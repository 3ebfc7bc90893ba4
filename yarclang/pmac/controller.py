"""Connection of a robot to its Turbo PMAC, as described in robot.toml."""

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
    """Connection of a robot to a Turbo PMAC: the axis, motor and feedback variable of each joint, and
    settings of the controller.

    `axes`, `motors` and `feedback` have one entry per joint (motor k is row k of the actuation matrix). Times
    are in s. `ixx08` is the position scale factor, `rotary_words` the minimum size of the rotary buffer, and
    `i8` and `i10` are the I-variables of the same name.
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
        """Return the time between two servo interrupts [s]. I10 is in units of 1/8,388,608 ms (TSRM 43)."""
        return self.i10 / 8_388_608.0 * 1e-3

    @property
    def smallest_segment(self) -> float:
        """Return the shortest segment that the controller can calculate fast enough [s].

        This is the duration of three real-time interrupts, which occur every I8 + 1 servo periods.
        """
        return 3.0 * (self.i8 + 1) * self.servo_period

    @property
    def text(self) -> str:
        """Return the name of the coordinate system, for people."""
        return f"coordinate system {self.coordinate_system}"

    @property
    def timing(self) -> str:
        """Return the variables that determine the shortest segment, as text."""
        return f"I8={self.i8} and I10={self.i10}"

    def signal(self, text: str) -> SignalVariable:
        """Return the variable of an input or output; `text` names it in upper case."""
        return signal_variable(text, self.feedback)


def turbo_pmac(robot: Robot) -> TurboPmac:
    """Return the controller description of a robot that is driven by a Turbo PMAC."""
    controller = robot.controller
    assert isinstance(controller, TurboPmac)
    return controller
