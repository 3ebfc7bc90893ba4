"""Specification of the command WAIT."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Dwell, Signal, WaitInput
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    match arguments.values:
        case (Signal() as signal, float(value)):
            if arguments.seconds is None:
                message = "this waits for ever if the input never gets this value"
                arguments.report("Y1003", message, "give a time: WAIT DOOR ON [5] (s)")
            return (WaitInput(arguments.origin, signal, value, arguments.seconds),)
    assert arguments.seconds is not None
    return (Dwell(arguments.origin, arguments.seconds),)


COMMAND = ActionSpec(
    name="WAIT",
    title="Wait",
    summary="stands still for a time, or until an input has a value",
    wants="a time, or an input and the value to wait for, ON or OFF",
    build=_build,
    forms=(ActionForm((Slot.INPUT, Slot.STATE), time="may"), ActionForm(time="must")),
    examples=("WAIT DOOR ON [5] (s)", "WAIT [2] (s)"),
)
