"""OF."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="OF",
    summary="what is done if the value of the CASE is one of those that follow",
    example="OF 2..5",
    in_blocks=True,
)
