"""Specification of the word UNTIL."""

from yarclang.words.spec import Slot, WordSpec

WORD = WordSpec(
    name="UNTIL",
    summary="the end of a LOOP that is left if a condition holds, decided after each pass when run",
    example="UNTIL DOOR ON",
    ends_block=True,
    slots=(Slot.INPUT, Slot.STATE),
    wants="an input and its value",
)
