"""Find the running robot to show. If no coordinator serves it for some time, find it again afterwards."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from yarclang.cell.model import Cell
from yarclang.coordinator.messages.replies import Surroundings, Welcome
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.transports.private import ControlError
from yarclang.runtime.transports.runs import Run, find_runs, run_on, the_run

_SERVE = "serve one: `yarc serve --robot NAME`, or run a program: `yarc run`"


@dataclass(frozen=True, slots=True)
class Whose:
    """The running robot to show. Without a name and a host, it is the only robot that runs.

    Attributes:
        name: name of the run; None for any.
        host: host of the robot's controller; None for any.
        port: port of the robot's controller.
    """

    name: str | None = None
    host: str | None = None
    port: int = 0

    def first(self) -> Run:
        """Return the wanted run.

        Raises:
            ControlError: there is none, or there are several.
        """
        if self.host is not None:
            found = run_on(self.host, self.port)
            if found is None:
                what = f"no process of this user on this computer drives {self.host}:{self.port}"
                raise ControlError(
                    what, f"serve it: `yarc serve --robot NAME --to tcp://{self.host}:{self.port}`"
                )
            return found
        if not find_runs():
            raise ControlError("no robot runs on this computer", _SERVE)
        return the_run(self.name)

    def again(self, before: Run) -> Run:
        """Return the run that follows a run that has ended. The following run must have the same controller
        if `host` is given, otherwise the same robot.

        Raises:
            ControlError: there is none, or there are several.
        """
        if self.host is not None:
            return self.first()
        found = [one for one in find_runs() if one.robot == before.robot]
        if not found:
            raise ControlError(f"{before.name} has ended; {before.robot} isn't served again yet")
        if len(found) > 1:
            names = ", ".join(one.name for one in found)
            raise ControlError(f"{before.name} has ended, and several serve {before.robot} now: {names}")
        return found[0]


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A robot and its cell, as read from their files.

    Attributes:
        robot: the robot.
        cell: the cell; None without one.
        notes: parts of the cell that can't be read, with reasons.
    """

    robot: Robot
    cell: Cell | None
    notes: tuple[str, ...] = ()

    def is_as(self, other: Place) -> bool:
        """Return True if another robot and its cell look the same in the picture."""
        texts = [None if one.cell is None else one.cell.source for one in (self, other)]
        return (
            self.robot.fingerprint == other.robot.fingerprint
            and texts[0] == texts[1]
            and self.notes == other.notes
        )


def read_place(welcome: Welcome, around: Surroundings) -> Place:
    """Read the files of a robot and its cell. The coordinator has sent their paths.

    Raises:
        Trouble: the robot's files can't be read, or have changed since the coordinator was started.
    """
    loaded = load_robot(around.robot)
    robot = loaded.value
    if robot is None:
        first = loaded.diagnostics[0].message
        raise Trouble(f"the robot in {around.robot} can't be read: {first}", "check whether it was moved")
    if robot.fingerprint != welcome.fingerprint:
        what = f"the robot in {around.robot} has changed since it is served"
        raise Trouble(what, "end its process, and serve the robot again")
    if around.cell is None:
        return Place(robot, None)
    path = Path(around.cell)
    read = cell_loader(path.parent, robot).at(path)
    if read.value is None:
        first = read.diagnostics[0].message if read.diagnostics else "it can't be read"
        return Place(robot, None, (f"without the cell {path}: {first}",))
    return Place(robot, read.value)
