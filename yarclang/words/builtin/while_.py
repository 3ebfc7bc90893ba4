"""Specification of the word WHILE."""

from yarclang.words.spec import Slot, WordSpec

WORD = WordSpec(
    name="WHILE",
    summary="repeats the lines up to END while a condition is true, decided before each pass when run",
    example="WHILE DOOR OFF",
    opens_block=True,
    slots=(Slot.INPUT, Slot.STATE),
    wants="an input and its value",
)
