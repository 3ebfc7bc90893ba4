"""Specification of the command JPOS."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Say
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Say(arguments.origin, "".join(map(str, arguments.values)), "joints"),)


COMMAND = ActionSpec(
    name="JPOS",
    title="Teach joints while it runs",
    summary="keeps the joints where the robot stands, under a name",
    wants="a name",
    build=_build,
    forms=(ActionForm((Slot.TAUGHT,)),),
    examples=("JPOS FOUND_AT",),
    may_be_a_name=True,
)
