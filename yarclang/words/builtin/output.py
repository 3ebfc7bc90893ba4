"""Specification of the word OUTPUT."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="OUTPUT",
    summary="a name for a variable of the controller, or several bits, that is set; OFF: at any stop",
    example="OUTPUT GLUE M1 OFF",
    declares="name",
)
