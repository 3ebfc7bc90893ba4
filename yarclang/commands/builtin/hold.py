"""HOLD."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Hold
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Hold(arguments.origin, "".join(map(str, arguments.values))),)


COMMAND = ActionSpec(
    name="HOLD",
    title="Hold",
    summary="waits for the operator",
    wants="a text in quotes, or nothing",
    build=_build,
    forms=(ActionForm(), ActionForm((Slot.TEXT,))),
    examples=('HOLD "put in the next part"',),
)
