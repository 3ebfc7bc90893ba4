"""Specification of the command PULSE."""

from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec
from yarclang.hir import Action, Dwell, SetOutput, Signal
from yarclang.words.spec import Slot


def _build(arguments: ActionArguments) -> tuple[Action, ...]:
    (output,) = arguments.values
    assert isinstance(output, Signal)
    assert arguments.seconds is not None
    origin = arguments.origin
    return SetOutput(origin, output, 1.0), Dwell(origin, arguments.seconds), SetOutput(origin, output, 0.0)


COMMAND = ActionSpec(
    name="PULSE",
    title="Pulse of an output",
    summary="sets an output ON for a time while the robot stands, then OFF",
    wants="an output and a time",
    build=_build,
    forms=(ActionForm((Slot.OUTPUT,), time="must"),),
    examples=("PULSE GRIP [0.5] (s)",),
)
