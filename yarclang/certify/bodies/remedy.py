"""Remedies proposed in findings about a motion that comes too close to something."""

from __future__ import annotations

import shlex

from yarclang import hir
from yarclang.diagnostics import Edit, Fix

_PROGRAM = ".yarc"

_EDGE = 1e-6
"""Difference of times that count as equal [s]."""


def remedy(
    motion: hir.Motion, otherwise: str, when: tuple[float, float], lasts: float
) -> tuple[str, Fix | None]:
    """Return a remedy for a motion that comes too close to something, and a fix if there is one.

    A way round helps only if the motion is clear at its start and at its end.

    Args:
        motion: the motion.
        otherwise: the remedy other than going round.
        when: range of the time after its start in which it is too close [s].
        lasts: duration of the motion [s].
    """
    origin = motion.origin
    fix = None
    if when[1] >= lasts - _EDGE:
        chooses = isinstance(motion, hir.JointMove) and isinstance(motion.goal, hir.PoseGoal)
        other = ", take another configuration (NEAR)" if chooses else ""
        text = (
            f"its target is there, so that no way round helps: move the target away{other}, or "
            f"{_correction(otherwise)}"
        )
    elif when[0] <= _EDGE:
        text = (
            "it begins there, so that no way round helps: end the motion before it elsewhere, or "
            f"{_correction(otherwise)}"
        )
    else:
        fix = round_it(motion)
        text = f"{fix.title}, which finds a way round by itself; or {otherwise}" if fix else otherwise
    source = origin.source
    if source.name.endswith(_PROGRAM) and not source.module:
        text += f"; `yarc view {shlex.quote(source.name)}` shows it"
    return text, fix


def _correction(otherwise: str) -> str:
    """Return the remedy that doesn't move the motion: the part after the last semicolon, or the whole
    text.
    """
    return otherwise.rpartition("; ")[2].removeprefix("or ")


def round_it(motion: hir.Motion) -> Fix | None:
    """Return a fix that adds _AVOID to a motion that is straight in joint space or on a line to a pose; None
    for other motions.
    """
    origin = motion.origin
    if not isinstance(motion, hir.JointMove | hir.LineMove) or motion.search is not None:
        return None
    if isinstance(motion.goal, hir.JointDelta | hir.PoseDelta) or "AVOID" in origin.name.split("_"):
        return None
    if origin.name_span is None or origin.source.is_installed:
        return None
    words = origin.name.split("_")
    target = 2 if words[1:2] in (["RPY"], ["QUAT"]) else 1
    name = "_".join((*words[:target], "AVOID", *words[target:]))
    return Fix(f"write {name}", (Edit(origin.name_span, name),))
