"""Specification of the word TABLE."""

from yarclang.words.spec import WordSpec

WORD = WordSpec(
    name="TABLE",
    summary="a name for several numbers, poses (POSE) or joint positions (JOINTS), each with its index from 0",  # noqa: E501
    example="TABLE HEIGHTS 10 25 60 (mm)",
    declares="name",
    proposes="values",
)
