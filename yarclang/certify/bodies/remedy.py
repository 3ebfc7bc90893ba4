"""Remedies proposed in findings about a motion that comes too close to something."""

from __future__ import annotations

import shlex

from yarclang import hir
from yarclang.diagnostics import Edit, Fix

_PROGRAM = ".yarc"

_EDGE = 1e-6
"""Largest difference of two times that count as equal [s]."""


def remedy(
    motion: hir.Motion, otherwise: str, when: tuple[float, float], lasts: float
) -> tuple[str, Fix | None]:
    """Return a remedy for a motion that comes too close to something, and an edit (fix) if there is one.

    A path around the obstacle helps only if the motion is clear at its start and at its end.

    Args:
        motion: the motion.
        otherwise: a remedy that is not a path around the obstacle.
        when: start and end of the interval in which the motion is too close, after the motion's start [s].
        lasts: duration of the motion [s].
    """
    origin = motion.origin
    fix = None
    if when[1] >= lasts - _EDGE:
        chooses = isinstance(motion, hir.JointMove) and isinstance(motion.goal, hir.PoseGoal)
        other = ", take another configuration (NEAR)" if chooses else ""
        text = (
            f"the target itself is there, so no detour helps: move the target away{other}, or "
            f"{_correction(otherwise)}"
        )
    elif when[0] <= _EDGE:
        text = (
            "the motion begins there, so no detour helps: begin elsewhere (at START, or where the motion "
            f"before it ends), or {_correction(otherwise)}"
        )
    else:
        fix = round_it(motion)
        text = f"{fix.title}, which plans a detour; or {otherwise}" if fix else otherwise
    source = origin.source
    if source.name.endswith(_PROGRAM) and not source.module:
        text += f"; `yarc view {shlex.quote(source.name)}` shows it"
    return text, fix


def _correction(otherwise: str) -> str:
    """Return the part of a remedy that doesn't change the motion's path: the text after its last semicolon,
    or the whole text if it has no semicolon.
    """
    return otherwise.rpartition("; ")[2].removeprefix("or ")


def round_it(motion: hir.Motion) -> Fix | None:
    """Return a fix that adds _AVOID to a motion's name, so that the planner finds a path around obstacles.

    Return None for any motion but a MOVEJ or MOVEL to an absolute goal without UNTIL: only these have a form
    with _AVOID.
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
