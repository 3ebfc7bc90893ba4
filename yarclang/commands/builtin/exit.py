"""Specification of the command EXIT."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Exit


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    return (Exit(arguments.origin),)


COMMAND = ActionSpec(
    name="EXIT",
    title="Leave the loop",
    summary="leaves the innermost LOOP or WHILE; the program goes on after its end",
    wants="nothing after it",
    build=_build,
    forms=(ActionForm(()),),
    examples=("EXIT",),
)
