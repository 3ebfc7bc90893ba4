"""The history of a session's actions, which is needed to drive motions back and to save the session as a
program. No I/O.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from yarclang.coordinator.backwards import Passed, last_group, passed
from yarclang.coordinator.lines import Lines, relative, seen_from
from yarclang.coordinator.offers import Offer
from yarclang.hir import Array, Program
from yarclang.robot.actuation import to_counts
from yarclang.robot.library import list_robots
from yarclang.robot.model import Robot
from yarclang.runtime.outcome import Ended
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_module
from yarclang.syntax.renumber import renumbered

_COUNT = 1.0
"""Largest difference of two positions that count as equal [counts]."""

_FIRST, _STEP = 10, 10
"""First index in a saved program, and the step from one index to the next."""

_BRIDGE = "[10%]"
"""Speed of the motions that are inserted into a saved program. Such a motion is needed where the robot was
moved by something other than the session's commands.
"""


def stands_there(robot: Robot, position: Array, other: Array) -> bool:
    """Return True if two joint positions differ by at most one count per motor.

    Args:
        robot: the robot.
        position: (n,) one position [rad or m].
        other: (n,) the other position [rad or m].
    """
    return bool((np.abs(to_counts(robot, position) - to_counts(robot, other)) <= _COUNT).all())


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """An action that was carried out.

    `commands` are its commands as written, `motions` its motions, and `program` the program that contains the
    motions. The robot moved from `start` to `end` (n,) [rad or m]. `whole` is True if a user entered the
    action and it reached its end: only then are its commands saved with the session.
    """

    commands: tuple[str, ...]
    motions: tuple[Passed, ...]
    program: Program | None
    start: Array
    end: Array
    whole: bool


_ROUNDED = 1e-3
"""Largest error of an end position due to the rounded numbers in a controller text [deg or mm]."""


class History:
    """The actions that were carried out and not driven back again, oldest first.

    Args:
        robot: the robot.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._entries: list[Entry] = []

    def add(self, offer: Offer, ended: Ended) -> None:
        """Add an offer that was carried out completely or in part."""
        assert offer.compiled is not None
        if offer.takes_back:
            self._take_back(offer, ended)
            return
        plan = offer.compiled.plan
        if ended.well:
            # Use the planned end. The reported end is that of the controller text, whose numbers are rounded.
            end = plan.motions[-1].waypoints[-1] if plan.motions else offer.start
            if (
                ended.joints is not None
                and (np.abs(ended.joints - end) > _ROUNDED * self._robot.axis_units).any()
            ):
                # The program has ended in a branch other than that of the plan's last motion.
                end = ended.joints
            # A text that the user hasn't typed, such as the motion to a program's start, isn't a command of
            # the session.
            whole = bool(offer.parts.commands)
            entry = Entry(offer.parts.commands, passed(plan), offer.compiled.program, offer.start, end, whole)
        elif ended.joints is None or not ended.command:
            return  # nothing has moved, or the position is unknown
        else:
            motions = passed(plan, ended.joints, ended.done) if plan.motions else ()
            entry = Entry((), motions, offer.compiled.program, offer.start, ended.joints, False)
        self._entries.append(entry)

    def ran(self, motions: tuple[Passed, ...], program: Program) -> None:
        """Add motions of a program from a file. They aren't commands of the session, and are stored only so
        that the robot can drive them back.
        """
        self._entries.append(Entry((), motions, program, motions[0].start, motions[-1].end, False))

    def forget(self) -> None:
        """Clear the history after the motors were homed: the same motor counts mean other joint positions
        now.
        """
        self._entries.clear()

    def _take_back(self, offer: Offer, ended: Ended) -> None:
        """Shorten the last entry after its last motions were driven back. The entry keeps its earlier
        motions, but its commands are no longer saved with the session.
        """
        if not ended.well and (ended.joints is None or not ended.command):
            return
        last = self._entries.pop()
        left = last.motions[: len(last.motions) - offer.takes_back] if ended.well else last.motions[:-1]
        if left and ended.joints is not None:
            end = ended.joints
            self._entries.append(Entry((), left, last.program, last.start, end, False))

    @property
    def end(self) -> Array | None:
        """Return the position of the robot after the last action (n,) [rad or m]."""
        return self._entries[-1].end if self._entries else None

    def last(self) -> tuple[tuple[Passed, ...], Program] | None:
        """Return the last motions between which the robot didn't stop, and the program that contains them;
        None if there are none.
        """
        while self._entries and not self._entries[-1].motions and not self._entries[-1].whole:
            self._entries.pop()
        entry = next((one for one in reversed(self._entries) if one.motions), None)
        if entry is None or entry is not self._entries[-1] or entry.program is None:
            return None
        return last_group(entry.motions), entry.program

    def saved(self, lines: Lines, home: Path, folder: Path | None = None) -> str:
        """Return the session as a program: its declarations, and all completed commands.

        If something else has moved the robot between two commands, a slow joint motion to the start of the
        second command is inserted.

        Args:
            lines: lines of the session.
            home: folder of the session, to which file names in the lines are relative.
            folder: folder for which the program is written: file names become relative to this folder. None:
                `home`.
        """
        robot = self._robot
        target_folder = (home if folder is None else folder).absolute()
        text = [f"ROBOT {_robot_name(robot, target_folder)}"]
        whole = [one for one in self._entries if one.whole]
        if whole:
            text.append(f"START {_values(robot, whole[0].start)} {_units(robot, '')}")
        text += (seen_from(one, home.absolute(), target_folder) for one in lines.declarations)
        stands = whole[0].start if whole else robot.home
        for one in whole:
            if not stands_there(robot, one.start, stands):
                values = _values(robot, one.start)
                text.append(
                    f"MOVEJ {values} {_BRIDGE} {_units(robot, ',s')} ! to the position to which "
                    "the robot was moved"
                )
            text += (seen_from(command, home.absolute(), target_folder) for command in one.commands)
            stands = one.end
        # Number the commands in the order of the file, because typed lines may have the same index.
        module = parse(SourceFile("<session>", "\n".join(text) + "\n")).value
        assert module is not None  # parsing always gives a tree
        return print_module(renumbered(module, _FIRST, _STEP))


def _robot_name(robot: Robot, folder: Path) -> str:
    """Return the robot's name if it is in yarclang's robot library; otherwise, the path of its robot.toml
    relative to a folder.
    """
    known = any(one.folder == robot.folder for one in list_robots())
    return robot.name if known else f'"{relative(robot.file, folder)}"'


def _values(robot: Robot, q: Array) -> str:
    return " ".join(f"{value + 0.0:.12g}" for value in np.round(q / robot.axis_units, 9))


def _units(robot: Robot, more: str) -> str:
    return f"({','.join(dict.fromkeys(robot.axis_unit_names))}{more})"
