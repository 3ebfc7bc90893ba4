"""Specification of the word END."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="END",
    summary="the end of a SUB, REPEAT, IF, WHEN, CASE, LOOP or WHILE",
    example="END",
    ends_block=True,
)
