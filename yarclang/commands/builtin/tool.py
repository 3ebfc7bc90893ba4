"""Specification of the command TOOL."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec, ToolChange
from yarclang.hir import Action, SetOutput
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    (change,) = arguments.values
    assert isinstance(change, ToolChange)
    return (SetOutput(arguments.origin, change.lock, change.value, change.tool),)


COMMAND = ActionSpec(
    name="TOOL",
    title="Change the tool",
    summary="locks the tool in whose place the flange stands, or puts it back (NONE)",
    wants="a tool of the cell, or NONE",
    build=_build,
    forms=(ActionForm((Slot.TOOL,)),),
    examples=("TOOL GRIPPER",),
    may_be_a_name=True,
)
