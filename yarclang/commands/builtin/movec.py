"""Specification of the command MOVEC."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import ArcMove, Step


def _build(arguments: Arguments) -> Step:
    via, goal = arguments.goals
    return ArcMove(
        arguments.origin, via, goal, arguments.profile, arguments.timing, arguments.tolerance, arguments.blend
    )


COMMAND = CommandSpec(
    name="MOVEC",
    summary="the moving frame goes along a circular arc through a via point",
    doc="""\
Moves the origin of the moving frame along the circle through where it stands, the via point x y z and the target, and turns
it about one fixed axis, the short way, in step with the arc. Points that coincide or lie on a line give no circle and
are an error; a full circle is two arcs. The arm keeps its configuration.
""",  # noqa: E501
    build=_build,
    examples=("P0010 MOVEC {TCP} 60 1174.4 1286; 0 1174.4 1226 0 0 0 [4] (mm,deg,s) {B}",),
    targets={"": Values.POSE_RPY, "RPY": Values.POSE_RPY, "QUAT": Values.POSE_QUAT},
    waypoints=(2, 2),
    leading=(Values.POSITION,),
    moves_frame=True,
)
