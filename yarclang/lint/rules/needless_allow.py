"""Find bodies that may touch but never come near each other."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.certify.certificate import Certificate
from yarclang.findings import Finding
from yarclang.hir import Allowed, Else, JointMove, LineMove, Motion, When
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.source import SourceFile, Span


def _look(certificate: Certificate, around: Surroundings) -> Iterator[Remark]:
    needed = {
        (one.step, may.first, may.second)
        for one in certificate.commands
        for may in one.may_touch
        if may.needed
    }
    places: dict[tuple[SourceFile, Span], tuple[Allowed, bool]] = {}
    elsewhere = after_search = False  # True for motions that may follow other paths at run time
    for step, motion in enumerate(around.steps):
        if isinstance(motion, When | Else):
            elsewhere = isinstance(motion, When) and motion.offset is not None
        if not isinstance(motion, Motion):
            continue
        skipped = elsewhere or after_search
        after_search = isinstance(motion, JointMove | LineMove) and motion.search is not None
        if skipped:
            continue
        for one in motion.allowed:
            place = motion.origin.source, one.span(motion.origin)
            _, before = places.get(place, (one, False))
            places[place] = one, before or (step, one.first, one.second) in needed
    for (source, span), (one, is_needed) in places.items():
        if not is_needed:
            message = f"{one.first} and {one.second} stay apart during this motion: ALLOW isn't needed"
            help_ = "remove the ALLOW, so that the distance of this pair is proved"
            yield Remark(message, span, help_, source=source)


RULE = Rule(
    Finding(
        "Y0936",
        "needless-allow",
        "note",
        "ALLOW names bodies that don't touch",
        "Bodies that may touch on a motion aren't checked against each other. If they stay apart anyway, "
        "the ALLOW has no effect now, but may hide a collision after a change of the motion or the cell.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_6",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
    ),
    Certificate,
    _look,
    valid=(
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ 0 -20 -94 0 0 0 [9] (deg,s) ALLOW LINK_2 LINK_5",
        (
            "REGISTER DX -2000..2000 0 OUTSIDE\n"
            "FRAME {PART} 0 1174.4 1000 0 0 0 (mm,deg) {B}\n"
            "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
            "OFFSET {PART} X DX\n"
            "P0010 MOVEL 0 0 0 0 0 0 {PART} ALLOW LINK_1 LINK_6\n"
            "P0020 MOVEJ 0 0 0 0 30 0\n"
            "END"
        ),
    ),
    invalid=(
        "P0010 MOVEJ 0 -20 -94 0 0 0 [9] (deg,s) ALLOW LINK_2 LINK_5 ALLOW LINK_2 LINK_4",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_6",
    ),
)
