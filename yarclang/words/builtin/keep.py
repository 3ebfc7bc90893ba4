"""Specification of the word KEEP."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="KEEP",
    summary="a rule for all motions up to END: a carried frame stays upright, above a plane or in sight of a "
    "place",
    example="KEEP {TCP} UPRIGHT 10 (deg) {B}",
    opens_block=True,
    proposes="frames",
    first=(
        ("UPRIGHT", "the angle between the z axes of the frame and of a fixed frame stays below a limit"),
        ("ABOVE", "the origin of the frame stays at least a distance above the xy plane of a fixed frame"),
        (
            "FACING",
            "the origin of a fixed frame stays in the cone around the z axis of the frame",
        ),
        ("SEEN", "the origin of the frame stays in the cone around the z axis of a fixed frame"),
    ),
    wants="UPRIGHT, FACING or SEEN and an angle, or ABOVE and a distance",
)
