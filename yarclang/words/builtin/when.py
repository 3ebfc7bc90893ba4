"""Specification of the word WHEN."""

from yarclang.words.spec import Slot, WordSpec

WORD = WordSpec(
    name="WHEN",
    summary="carries out the lines up to END if a condition is true, decided when run",
    example="WHEN DOOR OFF",
    opens_block=True,
    takes_else=True,
    slots=(Slot.INPUT, Slot.STATE),
    wants="an input and its value",
)
