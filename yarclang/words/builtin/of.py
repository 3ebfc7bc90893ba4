"""Specification of the word OF."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="OF",
    summary="lines that are carried out if the CASE has one of the following values",
    example="OF 2..5",
    in_blocks=True,
)
