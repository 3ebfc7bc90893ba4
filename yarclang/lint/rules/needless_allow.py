"""Find bodies that may touch and never come near each other."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.certify.certificate import Certificate
from yarclang.findings import Finding
from yarclang.hir import Allowed, Motion
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
    for step, motion in enumerate(around.steps):
        if not isinstance(motion, Motion):
            continue
        for one in motion.allowed:
            place = motion.origin.source, one.span(motion.origin)
            _, before = places.get(place, (one, False))
            places[place] = one, before or (step, one.first, one.second) in needed
    for (source, span), (one, is_needed) in places.items():
        if not is_needed:
            message = f"{one.first} and {one.second} keep apart on this motion: they need no ALLOW"
            help_ = "take it away: what isn't allowed is proved"
            yield Remark(message, span, help_, source=source)


RULE = Rule(
    Finding(
        "Y0936",
        "needless-allow",
        "note",
        "ALLOW names bodies that never touch",
        "Bodies that may touch on a motion aren't checked against each other. Where they keep their distance anyway, the ALLOW does nothing today, and hides a collision when somebody "
        "changes the motion or the cell.",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_6",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
    ),
    Certificate,
    _look,
    valid=(
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",
        "P0010 MOVEJ 0 -20 -94 0 0 0 [9] (deg,s) ALLOW LINK_2 LINK_5",
    ),
    invalid=(
        "P0010 MOVEJ 0 -20 -94 0 0 0 [9] (deg,s) ALLOW LINK_2 LINK_5 ALLOW LINK_2 LINK_4",
        "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) ALLOW LINK_1 LINK_6",
    ),
)
