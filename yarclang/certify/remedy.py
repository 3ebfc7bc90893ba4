"""What a motion that may not go where it goes could be instead."""

from __future__ import annotations

from yarclang import hir
from yarclang.diagnostics import Edit, Fix


def round_it(motion: hir.Motion) -> Fix | None:
    """A fix that lets a straight motion in joint space leave its way; None for others."""
    origin = motion.origin
    if not isinstance(motion, hir.JointMove) or isinstance(motion.goal, hir.JointDelta):
        return None
    if origin.name_span is None:
        return None
    words = origin.name.split("_")
    target = 2 if words[1:2] in (["RPY"], ["QUAT"]) else 1
    name = "_".join((*words[:target], "AVOID", *words[target:]))
    return Fix(f"write {name}", (Edit(origin.name_span, name),))
