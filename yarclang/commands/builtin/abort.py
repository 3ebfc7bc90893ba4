"""Specification of the command ABORT."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Finish
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Finish(arguments.origin, True, "".join(map(str, arguments.values))),)


COMMAND = ActionSpec(
    name="ABORT",
    title="Abort",
    summary="ends the program as a fault, with a reason",
    wants="a text in quotes that says why",
    build=_build,
    forms=(ActionForm((Slot.TEXT,)),),
    examples=('ABORT "no part in the gripper"',),
)
