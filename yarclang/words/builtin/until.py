"""Specification of the word UNTIL."""

from yarclang.words.spec import Slot, WordSpec

WORD = WordSpec(
    name="UNTIL",
    summary="the end of a LOOP that ends if a condition is true, decided after each pass when run",
    example="UNTIL DOOR ON",
    ends_block=True,
    slots=(Slot.INPUT, Slot.STATE),
    wants="an input and its value",
)
