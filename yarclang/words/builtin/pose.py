"""Specification of the word POSE."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="POSE",
    summary="a named pose, given by x y z roll pitch yaw in a fixed frame",
    example="POSE PICK 120 40 0 0 0 90 (mm,deg) {TABLE}",
    in_blocks=True,
    declares="name",
    proposes="frames",
)
