"""Specification of the command STOP."""

from yarclang.commands.spec import Arguments, CommandSpec
from yarclang.hir import Step, Stop


def _build(arguments: Arguments) -> Step:
    return Stop(arguments.origin)


COMMAND = CommandSpec(
    name="STOP",
    summary="ends the program; live, stops the motion under way",
    doc="""\
In a file: the end of the program; what follows is never reached (a warning). Live: stops the motion
under way, on its path, at once.
""",
    build=_build,
    examples=("P0010 STOP",),
    is_motion=False,
    waypoints=(0, 0),
)
