"""LOOP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="LOOP",
    summary="carries out the lines up to END or UNTIL again and again, till UNTIL holds or EXIT leaves them",
    example="LOOP",
    opens_block=True,
)
