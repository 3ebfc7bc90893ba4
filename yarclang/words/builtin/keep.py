"""Specification of the word KEEP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="KEEP",
    summary="keeps a carried frame upright, above a plane or in sight of a place on all motions up to END",
    example="KEEP {TCP} UPRIGHT 10 (deg) {B}",
    opens_block=True,
    proposes="frames",
    first=(
        ("UPRIGHT", "the z axis of the frame stays within an angle of that of a frame that stands still"),
        ("ABOVE", "the origin of the frame stays a distance above the plane of a frame that stands still"),
        (
            "FACING",
            "the origin of a frame that stands still stays in the cone around the z axis of the frame",
        ),
        ("SEEN", "the origin of the frame stays in the cone around the z axis of a frame that stands still"),
    ),
    wants="UPRIGHT, FACING or SEEN and an angle, or ABOVE and a distance",
)
