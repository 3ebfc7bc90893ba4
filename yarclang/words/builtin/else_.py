"""Specification of the word ELSE."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="ELSE",
    summary="lines for when the condition of IF or WHEN doesn't hold, or no OF has the value",
    example="ELSE",
)
