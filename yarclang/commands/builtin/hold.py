"""Specification of the command HOLD."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Hold
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    text, register = (*map(str, arguments.values), "", "")[:2]
    return (Hold(arguments.origin, text, register),)


COMMAND = ActionSpec(
    name="HOLD",
    title="Hold",
    summary="waits for the operator, and for the operator's answer if a register is to have it",
    wants="a text in quotes, a text and the register that gets the answer, or nothing",
    build=_build,
    forms=(ActionForm(), ActionForm((Slot.TEXT,)), ActionForm((Slot.TEXT, Slot.REGISTER))),
    examples=('HOLD "put in the next part"',),
)
