"""Specification of the word ELSE."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="ELSE",
    summary="lines to carry out if the condition of IF or WHEN isn't true, or no OF has the value",
    example="ELSE",
)
