"""Specification of the word CALL."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="CALL",
    summary="carries out a SUB",
    example="CALL DRILL {HOLE} 20 1.5",
    is_command=True,
    proposes="arguments",
)
