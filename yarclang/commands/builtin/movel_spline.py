"""Specification of the command MOVEL_SPLINE."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import PoseSplineMove, Step


def _build(arguments: Arguments) -> Step:
    return PoseSplineMove(
        arguments.origin,
        arguments.goals,
        arguments.profile,
        arguments.timing,
        arguments.tolerance,
        arguments.blend,
    )


COMMAND = CommandSpec(
    name="MOVEL_SPLINE",
    summary="one smooth curve of the moving frame through all waypoints, orientation too",
    doc="""\
One curve of the moving frame with continuous acceleration, from where it stands through all waypoints, without a
stop. Positions and unit quaternions are natural cubic splines over the distance from waypoint to waypoint (a turn of 1 rad counts
as 100 mm). Equal neighbours count once; half a turn between two neighbours is an error. The arm keeps its configuration.
""",  # noqa: E501
    build=_build,
    examples=(
        (
            "P0010 MOVEL_SPLINE {TCP} 60 1174.4 1286 0 0 0; 0 1174.4 1226 0 10 0; -60 1174.4 1286 0 0 0 [6] "
            "(mm,deg,s) {B}"
        ),
    ),
    targets={"": Values.POSE_RPY, "RPY": Values.POSE_RPY, "QUAT": Values.POSE_QUAT},
    waypoints=(2, None),
    moves_frame=True,
)
