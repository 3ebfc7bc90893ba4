"""Specification of the command SET."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.decisions import is_group
from yarclang.hir import Action, SetOutput, Signal
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    output, value = arguments.values
    assert isinstance(output, Signal)
    assert isinstance(value, float)
    if not is_group(output.variable):
        return (SetOutput(arguments.origin, output, value),)
    return tuple(
        SetOutput(arguments.origin, bit, float(int(value) >> place & 1))
        for place, bit in enumerate(output.bits)
    )


COMMAND = ActionSpec(
    name="SET",
    title="Set an output",
    summary="sets an output when the motion before has ended",
    wants="an output and its value",
    build=_build,
    forms=(ActionForm((Slot.OUTPUT, Slot.STATE)),),
    examples=("SET GRIP ON",),
)
