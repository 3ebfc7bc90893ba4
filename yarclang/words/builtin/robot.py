"""Specification of the word ROBOT."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="ROBOT",
    summary="the robot that the program is for",
    example="ROBOT INDUSTRIAL6",
    at_the_top=True,
    once=True,
    of_programs=True,
    proposes="robots",
)
