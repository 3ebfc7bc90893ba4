"""END."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="END",
    summary="the end of a SUB, REPEAT, IF, WHEN or CASE",
    example="END",
)
