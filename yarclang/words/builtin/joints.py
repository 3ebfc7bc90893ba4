"""Specification of the word JOINTS."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="JOINTS",
    summary="a named joint position",
    example="JOINTS READY 0 -10 -20 0 -60 0 (deg)",
    in_blocks=True,
    declares="name",
)
