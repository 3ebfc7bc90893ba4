"""KEEP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="KEEP",
    summary="keeps a carried frame upright, above a plane or in sight of a place on all motions up to END",
    example="KEEP {TCP} UPRIGHT 10 (deg) {B}",
    opens_block=True,
    proposes="frames",
    wants="UPRIGHT, FACING or SEEN and an angle, or ABOVE and a distance",
)
