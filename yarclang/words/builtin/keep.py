"""KEEP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="KEEP",
    summary="keeps a carried frame upright or above a plane on all motions up to END",
    example="KEEP {TCP} UPRIGHT 10 (deg) {B}",
    opens_block=True,
    proposes="frames",
    wants="UPRIGHT and an angle, or ABOVE and a distance",
)
