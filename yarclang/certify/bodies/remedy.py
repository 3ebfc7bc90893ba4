"""What a motion that may not go where it goes could be instead."""

from __future__ import annotations

import shlex

from yarclang import hir
from yarclang.diagnostics import Edit, Fix

_PROGRAM = ".yarc"

_EDGE = 1e-6
"""Times that are nearer to each other are one [s]."""


def remedy(
    motion: hir.Motion, otherwise: str, when: tuple[float, float], lasts: float
) -> tuple[str, Fix | None]:
    """Return what to do about a motion that comes too near to something, where to look at it, and a fix.

    A way round helps only if the motion neither begins nor ends there.

    Args:
        motion: the motion.
        otherwise: what to do instead of going round.
        when: from when to when after its start it is too near [s].
        lasts: how long it takes [s].
    """
    origin = motion.origin
    fix = None
    if when[1] >= lasts - _EDGE:
        chooses = isinstance(motion, hir.JointMove) and isinstance(motion.goal, hir.PoseGoal)
        other = ", take another configuration (NEAR)" if chooses else ""
        text = f"its target is there, so that no way round helps: move the target away{other}, or {_correction(otherwise)}"
    elif when[0] <= _EDGE:
        text = f"it begins there, so that no way round helps: end the motion before it elsewhere, or {_correction(otherwise)}"
    else:
        fix = round_it(motion)
        text = f"{fix.title}, which finds a way round by itself; or {otherwise}" if fix else otherwise
    source = origin.source
    if source.name.endswith(_PROGRAM) and not source.module:
        text += f"; `yarc view {shlex.quote(source.name)}` shows it"
    return text, fix


def _correction(otherwise: str) -> str:
    """Return what there is to do besides moving the motion: what stands behind the last semicolon, or all."""
    return otherwise.rpartition("; ")[2].removeprefix("or ")


def round_it(motion: hir.Motion) -> Fix | None:
    """A fix that lets a straight motion in joint space leave its way; None for others."""
    origin = motion.origin
    if not isinstance(motion, hir.JointMove) or isinstance(motion.goal, hir.JointDelta):
        return None
    if origin.name_span is None or origin.source.is_installed:
        return None
    words = origin.name.split("_")
    target = 2 if words[1:2] in (["RPY"], ["QUAT"]) else 1
    name = "_".join((*words[:target], "AVOID", *words[target:]))
    return Fix(f"write {name}", (Edit(origin.name_span, name),))
