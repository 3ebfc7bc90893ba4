"""Specification of the word START."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="START",
    summary="joint position at which the program starts",
    example="START HOME",
    at_the_top=True,
    once=True,
    of_programs=True,
    proposes="joints",
)
