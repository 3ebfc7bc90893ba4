"""Ways around obstacles that a text takes, read anew."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from yarclang.independent.arm import Arm, Array
from yarclang.independent.paths import Said


def unfolded(
    arm: Arm, said: Mapping[int, Said], text: str, chosen: Mapping[int, Array]
) -> tuple[dict[int, Said], list[tuple[list[int], float]]]:
    """Return what the steps of a text say, with the ways that were found: for a line its legs, for joints the
    way-points. Where a way leads in between is free, where it ends isn't.

    Args:
        arm: the arm.
        said: what the motions of the program say, in order.
        text: the emitted text, whose map has a line for each step.
        chosen: for each step of the text its joint positions (k, n) [rad, m].

    Returns:
        What each step says; and for lines with a time of their own their steps and this time [s].
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
