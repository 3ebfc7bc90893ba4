"""Specification of the command MOVEL."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import LineMove, Step


def _build(arguments: Arguments) -> Step:
    (goal,) = arguments.goals
    return LineMove(
        arguments.origin,
        goal,
        arguments.profile,
        arguments.timing,
        arguments.tolerance,
        arguments.blend,
        arguments.search,
        avoids=arguments.avoids,
    )


COMMAND = CommandSpec(
    name="MOVEL",
    old_name="MOVL",
    summary="the moving frame goes straight, turning about one fixed axis, the short way",
    doc="""\
Moves the origin of the moving frame on a straight line and turns it about one fixed axis (slerp),
the short way, in step with the line. Half a turn has no short way and is an error. The arm keeps its
configuration: a line that would need another one half way is an error that says where.
With `_AVOID` the straight line may be left to get round obstacles, on several straight lines in a row.
""",
    build=_build,
    examples=(
        "P0010 MOVEL_RPY {TCP} 200 1074.4 1326 10 -5 20 [4] (mm,deg,s) {B}",
        "P0010 MOVEL_AVOID {TCP} 200 1074.4 1326 10 -5 20 [MIN] (mm,deg) {B}",
        "P0010 MOVEL_POLY5 {TCP} 0 1174.4 1000 0 0 0 [MIN] (mm,deg) {B}",
    ),
    targets={"": Values.POSE_RPY, "RPY": Values.POSE_RPY, "QUAT": Values.POSE_QUAT},
    moves_frame=True,
    may_avoid=True,
    may_search=True,
)
