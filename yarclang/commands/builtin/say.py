"""Specification of the command SAY."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Say
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Say(arguments.origin, "".join(map(str, arguments.values))),)


COMMAND = ActionSpec(
    name="SAY",
    title="Say",
    summary="shows a text to the operator, and goes on",
    wants="a text in quotes",
    build=_build,
    forms=(ActionForm((Slot.TEXT,)),),
    examples=('SAY "the tray is full"',),
)
