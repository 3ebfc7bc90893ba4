"""Specification of the word IF."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="IF",
    summary="carries out the lines up to END if a condition is true, decided when compiled",
    example="IF PITCH > 50",
    opens_block=True,
    takes_else=True,
)
