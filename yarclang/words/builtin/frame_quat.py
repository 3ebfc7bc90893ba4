"""Specification of the word FRAME_QUAT."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="FRAME_QUAT",
    summary="a frame, given by x y z qx qy qz qw in a base frame",
    example="FRAME_QUAT {TABLE} 800 200 300 0 0 0 1 (mm) {B}",
    in_blocks=True,
    declares="frame",
    proposes="frames",
)
