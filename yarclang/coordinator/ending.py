"""Messages about the outcome of an action: the reason for its end, the place on the path at which the robot
rests, the position of the command in the source file, and the command with which to continue.
"""

from __future__ import annotations

from dataclasses import replace

from yarclang.coordinator.describing import joints_by_name, place_described
from yarclang.coordinator.messages import replies
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.resting import Resting, motion_before, resting_place
from yarclang.coordinator.undertaking import Undertaking
from yarclang.diagnostics import Diagnostic
from yarclang.pipeline.callers import caller_of
from yarclang.pipeline.origins import Origins
from yarclang.pipeline.parts import beginning, can_begin_at, chain_place
from yarclang.pipeline.returning import can_go_on
from yarclang.robot.model import Robot
from yarclang.runtime.outcome import Concerned, Ended, Where
from yarclang.runtime.state import State

_ABORTED = "Y1635"
"""Code of the finding for a program that has executed an ABORT of its own. Such a program can't be continued.
"""


def ended_described(ended: Ended, robot: Robot, state: State) -> replies.Ended:
    """Return the outcome of an offer as a message."""
    return replies.Ended(
        well=ended.well,
        what=ended.what or None,
        help=ended.remedy or None,
        code=ended.code or None,
        command=ended.command or None,
        done_s=round(ended.reached, 4),
        joints=None if ended.joints is None else joints_by_name(robot, ended.joints),
        state=state,
        moved=ended.well or bool(ended.command),
        where=place_described(ended.where),
    )


def placed(ended: Ended, loaded: Loaded) -> tuple[Ended, Resting | None]:
    """Add the position of the faulty command in the source file to an outcome.

    Returns:
        The outcome, and the place on the path at which the robot rests (None if unknown). This place is found
        by searching the path for the robot's joint positions, because the robot may have moved on since it
        last reported its progress.
    """
    plan, program, concerned = loaded.plan, loaded.program, ended.concerns
    place: Resting | None = None
    executed = ended.command in {command.title for command in program.commands}
    if plan is not None and ended.joints is not None and executed:
        place = resting_place(plan, program, ended.joints, ended.done)
    if concerned is None:
        return ended, place
    if place is not None and concerned.index == ended.command_index:
        there = place.command
        concerned = Concerned(there.index, there.name, there.source_line)
    return replace(ended, concerns=concerned, where=where_of(loaded.origins(), concerned)), place


def run_described(
    ended: Ended, resting: Resting | None, loaded: Loaded, undertaking: Undertaking, state: State
) -> replies.Ended:
    """Return the outcome of a program as a message.

    Args:
        ended: outcome, as returned by `placed`.
        resting: place on the path at which the robot rests, as returned by `placed`.
        loaded: the program.
        undertaking: execution of the program.
        state: state of the robot.
    """
    robot = loaded.program.robot
    is_motion = ended.command in {command.title for command in loaded.program.commands}
    return ended_described(ended, robot, state).model_copy(
        update={
            "moved": undertaking.moved,
            "on_the_way": undertaking.on_the_way,
            "passes": max(undertaking.passes, 1),
            "resting": None
            if resting is None
            else replies.RestingPlace(
                title=resting.command.title,
                done_s=round(resting.done + resting.command.clock - resting.command.begins, 4),
            ),
            "is_motion": is_motion,
            "go_on": _possible(_go_on(ended, loaded, resting, is_motion=is_motion), ended, loaded),
        }
    )


def _go_on(ended: Ended, loaded: Loaded, resting: Resting | None, *, is_motion: bool) -> str | None:
    """Return the index of the command with which the program can continue. Empty: the first command. None:
    unknown.
    """
    plan = loaded.plan
    if plan is None or not ended.command or ended.code == _ABORTED:
        return None
    if not is_motion:
        if can_begin_at(plan, ended.command_index):
            return ended.command_index
        # The robot stands before a step that isn't a motion, and the program can't begin with this step. So
        # it continues with the motion before.
        before = motion_before(plan, ended.command_index)
        return chain_place(plan, before) if before else ""
    index = ended.command_index if resting is None else resting.command.index
    return chain_place(plan, index) if ended.joints is not None and index not in ("", "-") else None


def _possible(place: str | None, ended: Ended, loaded: Loaded) -> str | None:
    """Return `place`, the command with which to continue, if the robot can move to the beginning of this
    command; otherwise None.

    A robot that carries parts may rest at a position that it can leave only by the program's own motion.
    """
    plan, joints = loaded.plan, ended.joints
    if place is None or plan is None or joints is None:
        return place
    begins = beginning(plan, place) if place else (0, 0)
    if place and not isinstance(begins, Diagnostic) and not can_begin_at(plan, place):
        return None  # the command is inside a branch of a WHEN
    return place if isinstance(begins, Diagnostic) or can_go_on(plan, begins[0], joints) else None


def where_of(origins: Origins, concerned: Concerned) -> Where:
    """Return the position of a command in its source file. If the position isn't known, return a note with
    the reason. For a command in an imported module, return the position of the call in the program.
    """
    origin = origins.of(concerned.index, concerned.name, concerned.source_line)
    if origin is None:
        note = origins.missing or "the program has no such command"
        return Where(line=concerned.source_line, note=note)
    called = None if origins.program is None else caller_of(origin, origins.program.source)
    if called is not None and origins.program is not None:
        (span, within), source = called, origins.program.source
        return Where(
            source.name, span.line, span.column, span.end_column, source.line(span.line), within.text
        )
    span = origin.span
    end = span.end_column if span.end_line == span.line else len(origin.source.line(span.line)) + 1
    return Where(origin.source.name, span.line, span.column, end, origin.source.line(span.line))
