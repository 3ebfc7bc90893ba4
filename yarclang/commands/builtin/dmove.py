"""Specification of the command DMOVE."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import LineMove, Step


def _build(arguments: Arguments) -> Step:
    (goal,) = arguments.goals
    return LineMove(
        arguments.origin, goal, arguments.profile, arguments.timing, arguments.tolerance, arguments.blend
    )


COMMAND = CommandSpec(
    name="DMOVE",
    old_name="DMOV",
    summary="shifts and turns the moving frame by increments, in a straight line",
    doc="""\
Moves as MOVEL does, from the pose p, Q of the moving frame to p + R d, R D R^T Q: d and D are the
increments and R are the axes of the base frame, both as they stand at the start. So base `{B}` means the
robot's axes and base `{TCP}` the tool's. Half a turn or more is an error.
""",
    build=_build,
    examples=(
        "P0010 DMOVE {TCP} 0 0 -20 0 0 5 [2] (mm,deg,s) {B}",
        "P0010 DMOVE {TCP} 0 -20 0 0 0 0 [MIN] (mm,deg) {TCP}",
    ),
    targets={"": Values.DELTA_RPY, "RPY": Values.DELTA_RPY, "QUAT": Values.DELTA_QUAT},
    frames_may_move=True,
    moves_frame=True,
)
