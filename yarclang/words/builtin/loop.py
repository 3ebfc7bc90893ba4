"""Specification of the word LOOP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="LOOP",
    summary=(
        "repeats the lines up to END or UNTIL when run: a number of times, until the condition of UNTIL is "
        "true, or until EXIT"
    ),
    example="LOOP",
    opens_block=True,
)
