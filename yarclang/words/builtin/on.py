"""Specification of the word ON."""

from yarclang.words.spec import Slot, WordSpec

WORD = WordSpec(
    name="ON",
    summary="holds the motion on its path while an input is ON or OFF; with CALL, the robot then leaves",
    example="ON CURTAIN OFF HOLD",
    at_the_top=True,
    of_programs=True,
    slots=(Slot.INPUT, Slot.STATE, Slot.REACTION),
    wants="an input, the state in which nothing may move, and HOLD, or CALL and a SUB",
)
