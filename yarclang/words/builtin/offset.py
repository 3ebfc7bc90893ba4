"""Specification of the word OFFSET."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="OFFSET",
    summary="shifts a frame by registers for the lines up to END, which are planned and proved when run",
    example="OFFSET {PART} X DX Y DY RZ TURN",
    opens_block=True,
    takes_else=True,
    of_programs=True,
    proposes="frames",
    wants="X, Y, Z or RZ, each with a register",
)
