"""Specification of the word LET."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="LET",
    summary="a name for a number",
    example="LET PITCH = 60 (mm)",
    in_blocks=True,
    declares="name",
)
