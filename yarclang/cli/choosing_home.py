"""Choose HOME for a new robot: a position in which its links don't touch and its motors can hold it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from yarclang.collision.homes import first_free
from yarclang.robot.checklist.item import listed
from yarclang.robot.new.home import STANDS, standing

if TYPE_CHECKING:
    from yarclang.robot.model import Robot
    from yarclang.robot.new.folder import NewRobot


def with_home(made: NewRobot, robot: Robot) -> tuple[NewRobot, Robot, tuple[str, ...]]:
    """Choose HOME for a new robot: the first candidate at which the robot doesn't collide with itself and its
    motors can hold it. If there is none, choose the first candidate without a collision.

    Args:
        made: new robot with candidates for HOME, best first.
        robot: the same robot, loaded with the first candidate.

    Returns:
        The new robot and the loaded robot, both with the chosen HOME, and notes about the faults of this
        HOME, if it has any.
    """
    proposed = np.array([home.value for home in made.homes]) * robot.axis_units
    stands = np.flatnonzero(standing(robot, proposed).max(axis=1) <= STANDS)
    chosen, notes = 0, []
    for places in (stands, np.arange(len(proposed))):
        free, touching = first_free(robot, proposed[places]) if len(places) else (None, ())
        if free is not None:
            chosen = int(places[free])
            break
    else:
        pairs = listed([" and ".join(pair) for pair in touching], 3)
        tried = f", as in all {len(proposed)} positions that were tried" if len(proposed) > 1 else ""
        notes.append(f"in HOME {pairs} touch{tried}: choose another with --home")
    if chosen:
        robot = replace(robot, positions={**robot.positions, "HOME": proposed[chosen]})
        home = made.homes[chosen]
        made = made.with_home(replace(home, note=f"{home.note}; no links touch there"))
    share = standing(robot, proposed[chosen : chosen + 1])[0]
    if share.max() > 1.0:
        most = int(np.argmax(share))
        notes.append(
            f"in HOME {robot.joint_names[most]} needs {share[most]:.0%} of its effort to stand, so that "
            "motions are refused: the URDF's masses and efforts aren't all that holds it; give effort in "
            "[joints.NAME], another HOME with --home, or checked = false in [dynamics]"
        )
    return made, robot, tuple(notes)
