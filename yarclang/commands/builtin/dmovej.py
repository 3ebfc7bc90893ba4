"""Specification of the command DMOVEJ."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import JointMove, Step


def _build(arguments: Arguments) -> Step:
    (goal,) = arguments.goals
    return JointMove(
        arguments.origin, goal, arguments.profile, arguments.timing, arguments.tolerance, arguments.blend
    )


COMMAND = CommandSpec(
    name="DMOVEJ",
    old_name="DMOVJ",
    summary="changes the joint position by increments",
    doc="""\
Moves as MOVEJ does, to the robot's present joint position plus the values.
""",
    build=_build,
    examples=("P0010 DMOVEJ 5 0 0 0 -10 0 [2] (deg,s)",),
    targets={"": Values.JOINT_DELTAS},
)
