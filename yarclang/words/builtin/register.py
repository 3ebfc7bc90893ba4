"""Specification of the word REGISTER."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="REGISTER",
    summary="a name for an integer that SET changes when the program runs",
    example="REGISTER COUNT 0..17",
    of_programs=True,
    declares="name",
)
