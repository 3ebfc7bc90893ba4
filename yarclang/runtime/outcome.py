"""How a run has ended."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.model import Array


@dataclass(frozen=True, slots=True, eq=False)
class Ended:
    """How a run has ended.

    `what` says why it didn't end well, `remedy` what to do; `joints` (n,) [rad or m] is where the robot is commanded to stand (None: not
    known), `command` what was executed, `done` how far the program was [s].
    """

    well: bool
    what: str = ""
    remedy: str = ""
    joints: Array | None = None
    command: str = ""
    command_index: str = ""
    done: float = 0.0
