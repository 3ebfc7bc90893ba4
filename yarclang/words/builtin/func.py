"""Specification of the word FUNC."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="FUNC",
    summary="a name for an expression of its parameters",
    example="FUNC MID(A, B) = (A + B) / 2",
    declares="name",
)
