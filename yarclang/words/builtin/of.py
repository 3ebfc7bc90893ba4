"""Specification of the word OF."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="OF",
    summary="lines to carry out if the CASE has one of these values",
    example="OF 2..5",
    in_blocks=True,
)
