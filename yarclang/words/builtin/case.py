"""Specification of the word CASE."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="CASE",
    summary="carries out the lines after one OF, chosen by a register or an input when run",
    example="CASE COUNT",
    opens_block=True,
    takes_else=True,
    proposes="values",
)
