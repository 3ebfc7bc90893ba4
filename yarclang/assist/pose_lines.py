"""Format poses and joint positions in Markdown."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.hir import Array, FrameLink
from yarclang.report.inspection.inspected import chain_of, chain_pose
from yarclang.report.pose_text import pose_text
from yarclang.robot.model import Robot


def joints_text(robot: Robot, q: Array) -> str:
    """Return joint positions as text, such as `J1 12.000, J2 -5.500 deg`. A common unit is given once, at
    the end.
    """
    units = robot.axis_unit_names
    values = np.round(q / robot.axis_units, 3) + 0.0  # avoid a minus sign before zero
    same = len(set(units)) == 1
    told = (
        f"{name} {value:.3f}" + ("" if same else f" {unit}")
        for name, value, unit in zip(robot.joint_names, values, units, strict=True)
    )
    return ", ".join(told) + (f" {units[0]}" if same else "")


def chain_lines(link: FrameLink) -> Iterator[str]:
    """Yield a line with the pose of a frame in its parent, then a line with the pose of each parent in its
    own parent, and a line with the frame's pose in the last parent.
    """
    chain = chain_of(link)
    for one in chain:
        if one.parent is not None:
            place = (
                f" ({one.source.name.rpartition('/')[2]}:{one.span.line})" if one.source and one.span else ""
            )
            yield f"- `{{{one.name}}}` in `{{{one.parent.name}}}`{place}: {pose_text(one.parent_from_frame)}"
    if len(chain) > 2:
        yield f"- `{{{link.name}}}` in `{{{chain[-1].name}}}`: {pose_text(chain_pose(link))}"
