"""Specification of the word SUB."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="SUB",
    summary="commands that CALL carries out, with parameters, up to END",
    example="SUB DRILL {AT} DEPTH (mm) T (s)",
    opens_block=True,
    declares="name",
)
