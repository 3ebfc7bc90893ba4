"""Paths around obstacles that the compiler has found, read from a controller text without the compiler's
code.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from yarclang.independent.arm import Arm, Array
from yarclang.independent.paths import Said


def unfolded(
    arm: Arm, said: Mapping[int, Said], text: str, chosen: Mapping[int, Array]
) -> tuple[dict[int, Said], list[tuple[list[int], float]]]:
    """Return the requirements on the motions of a text, after the compiler has found paths around obstacles.

    A line that avoids an obstacle becomes several lines, one per step of the text; a joint motion that avoids
    one becomes a joint spline through waypoints. The program fixes only where such a path ends, so its
    intermediate poses and waypoints are taken from `chosen`.

    Args:
        arm: the arm.
        said: requirements of the program on its motions, in order.
        text: the emitted text, whose map has a line for each step.
        chosen: for each step of the text, its chosen joint positions (k, n) [rad, m].

    Returns:
        The requirements by step of the text; and for each line that was divided and has a programmed
        duration, its steps and this duration [s].
    """
    found = re.findall(r"^; command (\d+) (\S+) (\S+) ", text, re.MULTILINE)
    groups: list[tuple[str, list[int]]] = []
    for step, index, name in found:
        if groups and groups[-1][0] == index and "_AVOID" in name:
            groups[-1][1].append(int(step))
        else:
            groups.append((index, [int(step)]))
    if len(groups) != len(said):
        raise ValueError(f"{len(said)} commands are programmed, and the map has {len(groups)}")
    new: dict[int, Said] = {}
    lasting: list[tuple[list[int], float]] = []
    for (_, one), (_, steps) in zip(sorted(said.items()), groups, strict=True):
        *before, last = steps
        new[last] = one
        if one.kind == "line" and before:
            leg = one
            if one.seconds is not None:
                lasting.append((steps, one.seconds))
                leg = replace(one, time="[MIN]")
            for step in before:
                points, turns = arm.poses(chosen[step] / arm.si)
                new[step] = replace(leg, goals=[(points[-1], turns[-1])])
            new[last] = leg
        elif one.avoids and one.kind == "joints" and len(chosen[last]) > 1:
            way = [*(chosen[last][:-1] / arm.si), *one.goals]
            new[last] = replace(one, kind="joint_spline", goals=way)
    return new, lasting
