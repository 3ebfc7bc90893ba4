"""Specification of the command MOVEJ_TIMED."""

from yarclang.commands.spec import Arguments, CommandSpec, Values
from yarclang.hir import Step, TimedMove


def _build(arguments: Arguments) -> Step:
    timed = arguments.timed
    assert timed is not None
    return TimedMove(
        arguments.origin, timed.table, timed.within, timed.stretch, arguments.timing, file=timed.file
    )


COMMAND = CommandSpec(
    name="MOVEJ_TIMED",
    summary="all joints along a timetable: waypoints, each with its time",
    doc="""\
Each waypoint has its time in square brackets, counted from the start of the motion. The robot begins where it stands, at
rest, and ends at rest. The time may be followed by `VEL` with the velocity of each joint there, and then by `ACC` with the accelerations: at all waypoints, or at none.
Between two waypoints each joint goes along the quintic polynomial with these positions, velocities and accelerations; the cubic one
where only velocities are given; else along one cubic spline in time through all waypoints, with continuous acceleration. `MOVEJ_TIMED "path.csv"` takes the
waypoints from a file beside the program. `STRETCH 1.5` makes all times one and a half times as long; `TOL` says how far a joint may be from the path (0.0001 rad, 0.1 mm).
""",  # noqa: E501
    build=_build,
    examples=(
        "P0010 MOVEJ_TIMED 0 0 5 0 5 0 [2]; 5 0 10 0 10 0 [4] (deg,s)",
        (
            "P0010 MOVEJ_TIMED 0 0 5 0 5 0 [2] VEL 0 0 3 0 3 0; 0 0 10 0 10 0 [4] VEL 0 0 0 0 0 0 (deg,s) "
            "STRETCH 1.5 TOL 0.01"
        ),
    ),
    targets={"": Values.JOINTS},
    waypoints=(1, None),
    is_timed=True,
)
