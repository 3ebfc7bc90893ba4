"""How far a simulator in the process of its client may go ahead of what the client asked last.

Both share one computer: where it has too much else to do, neither gets on. With the wall clock the simulated controller would go on all the same as soon as it
gets a turn, run out of lines, and hold. On a leash it waits for its client, and the time for which it waited is left out: the simulation is slower, and otherwise the same.
The client leaves the same time out of its own clock (`runtime/session.py`).
"""

from __future__ import annotations

_AHEAD = 0.06
"""More than lies between two questions of any client that looks after a robot, whose longest pause is 0.05 s; less than the 0.1 s that the guard PLC allows a client to be late [s of the machine]."""

_TURNS = 0.005
"""What a few turns of two event loops take, without anything else on the computer [s of the wall clock]: at a great rate more of the machine's time passes in them."""


def leash(rate: float) -> float:
    """Return how far a machine may go ahead of what was asked last [s of its time].

    Args:
        rate: seconds of the machine a second.
    """
    return max(_AHEAD, _TURNS * rate)
