"""Specification of the word WHILE."""

from yarclang.words.spec import Slot, WordSpec

WORD = WordSpec(
    name="WHILE",
    summary="carries out the lines up to END as long as a condition holds, decided before each pass when run",
    example="WHILE DOOR OFF",
    opens_block=True,
    slots=(Slot.INPUT, Slot.STATE),
    wants="an input and its value",
)
