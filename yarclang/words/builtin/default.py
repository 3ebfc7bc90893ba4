"""Specification of the word DEFAULT."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="DEFAULT",
    summary="parts that lines of this file may leave out",
    example="DEFAULT {TCP} [50%] (mm,deg,s) {B}",
    at_the_top=True,
    once=True,
    proposes="frames",
)
