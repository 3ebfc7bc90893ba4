"""Specification of the word USE."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="USE",
    summary="a module: a file beside the program, or one of the standard library",
    example="USE PALLET",
    at_the_top=True,
    declares="name",
    proposes="modules",
)
