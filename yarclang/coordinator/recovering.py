"""Recovery of a program from any position of the robot: a motion to the program's start is planned and proved
or, if there is none, a motion to the nearest position at which the program can begin. The motion is only
offered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from yarclang.cell.model import Cell
from yarclang.coordinator.describing import offer_described
from yarclang.coordinator.kept_parts import check_sure
from yarclang.coordinator.messages import replies
from yarclang.coordinator.messages.findings import finding_messages
from yarclang.coordinator.offers import Offer
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.shared import SharedRobot
from yarclang.diagnostics import Diagnostic, Result
from yarclang.hir import Array
from yarclang.pipeline.recovering import Place, Recovery, around_place, parts_at, recovery, start_of
from yarclang.robot.model import Robot

Now = Callable[[Cell, Array], Cell | None]
"""Type of a function that returns a cell with its parts at their present places. It returns None if the parts
are in the places that the cell's file gives.
"""


def find_recovery(robot: Robot, loaded: Loaded, position: Array, now: Now) -> Result[Recovery]:
    """Find a command of a program to whose start the robot can move from its position.

    Args:
        robot: the robot.
        loaded: the program. If it begins at a given command, only this command is tried.
        position: position of the robot (n,) [rad or m].
        now: returns a cell with its parts at their present places.

    Returns:
        The command, with the motion to its start; findings instead if no motion is proved.
    """
    plan, around = loaded.plan, None if loaded.around is None else replace(loaded.around, present=None)
    is_named = loaded.first_step is not None and bool(loaded.spans)
    number = loaded.spans[0][0] if is_named else 0
    start = start_of(plan, loaded.rest.start, loaded.first_step, number)
    first = loaded.assumed

    def around_at(place: Place) -> tuple[Cell | None, bool]:
        if around is None or not around.parts:
            return around, True
        known = now(around, position)
        if known is not None:
            return known, True
        return around_place(around, first if place is start else parts_at(plan, place, first)), False

    def is_there(there: Array) -> bool:
        return bool((np.abs(position - there) <= loaded.program.slack).all())

    return recovery(robot, start, position, plan, around_at, is_there=is_there, nearest=not is_named)


@dataclass(frozen=True, slots=True, eq=False)
class Recovered:
    """The result of a search for a motion to a position at which a program can begin.

    Attributes:
        found: the command with which the program can begin, and the motion to the start of this command;
            None if no such motion is proved.
        offer: the offer of this motion; None if there is no such motion, or if the robot is already there.
        findings: findings about the motion; if no motion is proved, they give the reasons.
    """

    found: Recovery | None
    offer: Offer | None
    findings: tuple[Diagnostic, ...]


async def recovered(coordinator: SharedRobot, loaded: Loaded) -> Recovered:
    """Plan and certify a motion from the robot's position to a position at which a program can begin. Nothing
    moves.

    Raises:
        Trouble: the robot is moving, there is no connection, or the places of the cell's parts are unknown.
    """
    robot, kept_parts = coordinator.robot, coordinator.carrying.kept
    if loaded.around is not None and (known := kept_parts.known(loaded.around)) is not None:
        check_sure(known)
    position = await coordinator.stands()
    await coordinator.look_around()
    revision, number = coordinator.lines.revision, next(coordinator.numbers)

    def work() -> Recovered:
        result = find_recovery(robot, loaded, position, kept_parts.now)
        recovery = result.value
        if recovery is None or recovery.made is None:
            return Recovered(recovery, None, result.diagnostics)
        text = f"recover {loaded.name}: to {recovery.place.title}"
        offered = coordinator.planner.offered(
            number, text, position, Result(recovery.made, result.diagnostics), revision
        )
        assert offered.value is not None  # it was certified without an error
        return Recovered(recovery, replace(offered.value, proved_in=recovery.cell), offered.diagnostics)

    answer: Recovered = await coordinator.plan(work)
    return answer


def recovery_described(recovered: Recovered, robot: Robot) -> replies.Recovery:
    """Return the result of `recovered` as a message."""
    recovery = recovered.found
    return replies.Recovery(
        place=None if recovery is None else recovery.place.index,
        title="" if recovery is None else recovery.place.title,
        line=0 if recovery is None else recovery.place.line,
        offer=None if recovered.offer is None else offer_described(recovered.offer, robot),
        share=robot.controller.rapid_share,
        assumed=() if recovery is None else recovery.assumed,
        refused=finding_messages(() if recovery is None else recovery.refused),
        findings=finding_messages(recovered.findings),
    )
