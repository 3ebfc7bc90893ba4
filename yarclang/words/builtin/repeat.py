"""Specification of the word REPEAT."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="REPEAT",
    summary="carries out the lines up to END several times, counted from 0",
    example="REPEAT I 4",
    opens_block=True,
)
