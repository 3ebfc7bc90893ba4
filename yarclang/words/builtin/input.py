"""Specification of the word INPUT."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="INPUT",
    summary="a name for a variable of the controller that is read, or for a number of several bits",
    example="INPUT DOOR M11",
    declares="name",
)
