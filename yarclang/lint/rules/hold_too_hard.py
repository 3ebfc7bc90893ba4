"""Find motions in which a feed hold needs more than the acceleration of an emergency stop."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.certify.certificate import Certificate
from yarclang.certify.outward import percent
from yarclang.findings import Finding
from yarclang.hir import Motion
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at

MUCH = 1.9
"""A motion gets a remark if a hold needs more than this multiple of the stop acceleration. Motions at full
acceleration come close to it.
"""


def _look(certificate: Certificate, around: Surroundings) -> Iterator[Remark]:
    for one in certificate.commands:
        step = around.steps[one.step]
        if one.hold.share <= MUCH or not isinstance(step, Motion):
            continue
        message = (
            f"a hold at the worst moment of this motion needs {percent(one.hold.share)} % of the stop "
            f"acceleration of {one.hold.name}"
        )
        help_ = (
            "make the motion slower (ACC 50%, or a longer time), or increase controller.hold_time in "
            "robot.toml"
        )
        yield remark_at(step.origin, message, help_)


RULE = Rule(
    Finding(
        "Y1168",
        "hard-hold",
        "note",
        "a hold during this motion may need far more than the stop acceleration",
        "A feed hold slows the program down to a stop. Its deceleration adds to the acceleration of the "
        "motion itself. The certificate gives the sum as a percentage of each joint's emergency-stop "
        "acceleration. If it is far above 100 %, the drive may trip or the arm may leave its path during "
        "the hold.",
        "P0010 MOVEJ_TOPP 120 60 0 0 0 0 [MIN] (deg)",
        "P0010 MOVEJ 120 60 0 0 0 0 [50%] (deg)",
    ),
    Certificate,
    _look,
    valid=("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)",),
    invalid=("P0010 MOVEJ_TOPP 120 60 0 0 0 0 [MIN] (deg)",),
)
