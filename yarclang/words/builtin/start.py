"""START."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="START",
    summary="where the robot stands at first",
    example="START HOME",
    at_the_top=True,
    once=True,
    of_programs=True,
    proposes="joints",
)
