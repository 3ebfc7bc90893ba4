"""What a motion that may not go where it goes could be instead."""

from __future__ import annotations

import shlex

from yarclang import hir
from yarclang.diagnostics import Edit, Fix

_PROGRAM = ".yarc"


def remedy(motion: hir.Motion, otherwise: str) -> tuple[str, Fix | None]:
    """What to do about a motion that comes too near to something: a way round, where it may take one, else `otherwise`; and where to look at it."""
    fix = round_it(motion)
    text = f"{fix.title}, which finds a way round by itself; or {otherwise}" if fix else otherwise
    name = motion.origin.source.name
    if name.endswith(_PROGRAM):
        text += f"; `yarc view {shlex.quote(name)}` shows it"
    return text, fix


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
