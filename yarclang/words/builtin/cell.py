"""Specification of the word CELL."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="CELL",
    summary="the cell's file: frames, joint positions, inputs, outputs, obstacles",
    example='CELL "cell.toml"',
    at_the_top=True,
    once=True,
)
