"""Specification of the command MOVEJ."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import AvoidMove, JointMove, Step


def _build(arguments: Arguments) -> Step:
    (goal,) = arguments.goals
    said = (arguments.origin, goal, arguments.profile, arguments.timing, arguments.tolerance, arguments.blend)
    return AvoidMove(*said) if arguments.avoids else JointMove(*said, arguments.search)


COMMAND = CommandSpec(
    name="MOVEJ",
    old_name="MOVJ",
    summary="straight in joint space, all joints together",
    doc="""\
Moves all joints together from where the robot stands to the target, each by the same share of
its way at any time. The target is a joint position (values, or a joint position's name) or, with `_RPY` or
`_QUAT`, a pose of the moving frame in the base frame. A pose has several inverse-kinematics solutions: of
those within the joint limits, counted with their full turns, the one nearest to where the robot stands is taken.
With `_AVOID` the straight way may be left to get round obstacles, and round the robot itself.
""",  # noqa: E501
    build=_build,
    examples=(
        "P0010 MOVEJ 10 -5 20 0 30 0 [5] (deg,s)",
        "P0010 MOVEJ HOME [MIN]",
        "P0010 MOVEJ_AVOID 10 -5 20 0 30 0 [MIN] (deg)",
        "P0010 MOVEJ_POLY5 10 -5 20 0 30 0 [MIN] (deg)",
    ),
    targets={"": Values.JOINTS, "RPY": Values.POSE_RPY, "QUAT": Values.POSE_QUAT},
    may_avoid=True,
    may_search=True,
)
