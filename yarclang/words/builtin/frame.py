"""Specification of the word FRAME."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="FRAME",
    summary="a frame, given by x y z roll pitch yaw in a base frame",
    example="FRAME {TABLE} 800 200 300 0 0 90 (mm,deg) {B}",
    in_blocks=True,
    declares="frame",
    proposes="frames",
)
