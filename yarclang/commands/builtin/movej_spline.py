"""Specification of the command MOVEJ_SPLINE."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import SplineMove, Step


def _build(arguments: Arguments) -> Step:
    return SplineMove(
        arguments.origin,
        arguments.goals,
        arguments.profile,
        arguments.timing,
        arguments.tolerance,
        arguments.blend,
    )


COMMAND = CommandSpec(
    name="MOVEJ_SPLINE",
    old_name="MOVJ_SPLINE",
    summary="one smooth curve in joint space through all waypoints",
    doc="""\
One curve with continuous acceleration in joint space, from where the robot stands through all
waypoints, without a stop: a natural cubic spline over the chord length. Equal neighbours count once. Between
waypoints the curve may swing beyond them.
""",
    build=_build,
    examples=("P0010 MOVEJ_SPLINE 10 0 5 0 10 0; 20 5 10 0 20 5; 10 0 0 0 30 0 [10] (deg,s)",),
    targets={"": Values.JOINTS, "RPY": Values.POSE_RPY, "QUAT": Values.POSE_QUAT},
    waypoints=(2, None),
)
