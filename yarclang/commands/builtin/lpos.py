"""Specification of the command LPOS."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Say
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Say(arguments.origin, "".join(map(str, arguments.values)), "pose"),)


COMMAND = ActionSpec(
    name="LPOS",
    title="Teach a pose while it runs",
    summary="keeps the pose of {TCP} in {B} where the robot stands, under a name",
    wants="a name",
    build=_build,
    forms=(ActionForm((Slot.TAUGHT,)),),
    examples=("LPOS FOUND_AT",),
    may_be_a_name=True,
)
