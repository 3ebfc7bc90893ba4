"""Measurement of how fast the controller's time passes: as fast as this computer's, except on a simulator at
another rate. No I/O.
"""

from __future__ import annotations

from yarclang.pmac.controller import TurboPmac
from yarclang.pmac.variables import watchdog
from yarclang.runtime.actions import Script, Wait
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.supervision import wound_up
from yarclang.units import MS

OTHER_PACE = 0.2
"""Largest relative difference between the rate of a real controller's time and the rate of this computer's
time.
"""

OTHER_PACE_REMEDY = (
    "run `yarc sim` without --rate, or let `yarc run` simulate the robot itself: without --to, with --rate"
)

_WOUND_UP = 60.0
"""Time to which the watchdog timer is set for the measurement [s of the controller]. It is so long that the
timer doesn't run down during the measurement, even in a fast simulator.
"""

_MEASURED = 0.2
"""Duration of the measurement [s]."""


def pace_of(operation: Operation, controller: TurboPmac) -> Script[float]:
    """Return the seconds of the controller's time per second of this computer, measured with the watchdog's
    timer. The watchdog must be off.
    """
    timer = watchdog(controller.coordinate_system)
    yield from operation.ask(wound_up(controller, _WOUND_UP))
    since = operation.now
    (first,) = yield from operation.numbers(timer, 1)
    yield Wait(since + _MEASURED)
    passed = operation.now - since
    (second,) = yield from operation.numbers(timer, 1)
    cycle = controller.i10 / 2**23 * MS
    return (first - second) * cycle / passed if passed > 0.0 else 1.0
