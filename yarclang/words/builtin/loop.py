"""Specification of the word LOOP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="LOOP",
    summary=(
        "carries out the lines up to END or UNTIL again and again when run: so many times, till UNTIL "
        "holds, or till EXIT"
    ),
    example="LOOP",
    opens_block=True,
)
