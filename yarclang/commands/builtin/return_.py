"""Specification of the command RETURN."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Exit


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Exit(arguments.origin),)


COMMAND = ActionSpec(
    name="RETURN",
    title="Leave the SUB",
    summary="leaves the SUB; the program goes on after its CALL",
    wants="nothing after it",
    build=_build,
    forms=(ActionForm(()),),
    examples=("RETURN",),
)
