"""Decide which motions flow into each other, and the allowed distance of the blended curve from each
corner.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from yarclang.diagnostics import Collector, Diagnostic
from yarclang.hir import (
    ArcMove,
    Array,
    AvoidMove,
    Gap,
    JointMove,
    LineMove,
    Motion,
    PoseSplineMove,
    Reading,
    SetOutput,
    SplineMove,
    Step,
    TimedMove,
)
from yarclang.motion.cartesian import CartesianPath, extent_of
from yarclang.motion.chains import messages
from yarclang.motion.chains.blend import Corner, way_length
from yarclang.motion.chains.links import Link
from yarclang.motion.leading.frame_motions import moving_frame
from yarclang.motion.leading.led import FrameWay
from yarclang.motion.path import Path
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Robot

_TANGENT = 1e-3
"""Difference up to which directions [rad], and rotations per length [rad/m], count as equal."""

_ROUNDING = 1e-9
"""Relative amount by which a blend may exceed half of a path: a rounding error."""

_NO_WAY = 1e-9
"""Length below which a path counts as a point [m or rad]. No motion can flow into or out of such a path."""


def chained(
    robot: Robot,
    steps: Sequence[Step],
    links: Mapping[int, Link],
    ways: Mapping[int, Path | FrameWay],
    found: list[list[Diagnostic]],
) -> Iterator[tuple[list[int], list[Link]]]:
    """Group the motions of a program into chains that flow without a stop. Most chains are a single motion.

    Args:
        robot: the robot.
        steps: the steps of the program.
        links: each motion that can be executed by itself, by the index of its step.
        ways: all known paths of motions, by the index of the step. Faulty motions are included, so that
            faults of their blends are reported at once.
        found: the findings of each step; those about blends are added.

    Yields:
        For each chain, the indices of the steps of its motions, and the motions with their corners.
    """
    numbers: list[int] = []
    chain: list[Link] = []
    for number, step in enumerate(steps):
        if not isinstance(step, Motion):
            continue
        corner = None
        if step.blend is not None:
            findings = Collector(step.origin.source)
            findings.place = step.origin.place
            corner = _corner(robot, steps, links, ways, number, findings)
            found[number] += findings.found
        link = links.get(number)
        if link is None:
            continue
        numbers.append(number)
        chain.append(link if corner is link.corner else replace(link, corner=corner))
        if corner is None:
            yield numbers, chain
            numbers, chain = [], []


MANY = 40
"""Number of motions up to which the motions of a chain are also planned one by one. A longer chain is planned
only as one path, if possible.
"""


def long_chains(steps: Sequence[Step]) -> frozenset[int]:
    """Return the step indices of all motions in chains of more than `MANY` motions. Chains are recognized
    only by the BLENDs that connect motions.
    """
    numbers: list[int] = []
    chain: list[int] = []
    for number, step in enumerate(steps):
        if isinstance(step, SetOutput):
            continue
        if isinstance(step, Motion):
            chain.append(number)
        if not isinstance(step, Motion) or step.blend is None:
            numbers += chain if len(chain) > MANY else ()
            chain = []
    return frozenset(numbers)


class _Room(NamedTuple):
    """The largest allowed distance of the blended curve from a corner; the fields are those of `Corner`."""

    radius: float
    flange_from_moving: Array | None
    reach: Array | None = None


def _corner(
    robot: Robot,
    steps: Sequence[Step],
    links: Mapping[int, Link],
    ways: Mapping[int, Path | FrameWay],
    number: int,
    findings: Collector,
) -> Corner | None:
    """Return the corner between a motion and the next; None if the two don't flow into each other.

    If the BLEND is at fault for this, a finding is added.
    """
    step = steps[number]
    assert isinstance(step, Motion)
    assert step.blend is not None
    # Outputs between two motions don't interrupt a blend.
    after = number + 1
    while after < len(steps) and isinstance(steps[after], SetOutput):
        after += 1
    following = steps[after] if after < len(steps) else None
    if not isinstance(following, Motion | Gap) or isinstance(following, TimedMove):
        if number in links:
            findings.add(*messages.nothing_to_flow_into(following, step.origin))
        return None
    first, second = ways.get(number), ways.get(after)
    if any(way is not None and way_length(way) < _NO_WAY for way in (first, second)):
        if number in links and after in links:
            findings.add(*messages.nothing_to_flow_into(following, step.origin))
        return None
    if not isinstance(step, _IN_JOINTS) or not isinstance(following, (*_IN_JOINTS, Gap)):
        is_long = number in links and links[number].by_itself is None
        room = _of_frame(robot, step, following, (first, second), step.blend, findings, is_long=is_long)
    elif isinstance(following, Gap):  # the gap may stand for a joint motion or another one
        return None
    else:
        room = _between_joints(robot, step, (first, second), step.blend, findings)
    if room is None or number not in links or after not in links:
        return None
    return Corner(links[number].path.end, *room)


_IN_JOINTS = (JointMove, AvoidMove, SplineMove)

_Ways = tuple[Path | FrameWay | None, Path | FrameWay | None]
"""The paths before and after a corner; None if one isn't known."""


def _between_joints(
    robot: Robot, step: Motion, ways: _Ways, blend: Reading, findings: Collector
) -> _Room | None:
    """Return the allowed distance of each joint from a corner between joint motions. If the BLEND doesn't
    fit, return None and add a finding.

    Each revolute joint stays within an angle of the corner, each prismatic joint within a length.
    """
    if blend.angle is None:
        findings.add(*messages.blend_without_unit("angle", "between two motions of joints", step.origin))
        return None
    reach = np.where(robot.chain.is_prismatic, blend.length or 0.0, blend.angle)
    if robot.chain.is_prismatic.any() and blend.length is None:
        findings.add(*messages.blend_without_unit("length", "of a sliding joint", step.origin))
        return None
    if not reach.any():
        return _tangent(step, ways, None, findings)
    # The joint that moves farthest, relative to its allowed distance, decides if the BLEND fits.
    halves = [
        math.inf
        if way is None or isinstance(way, FrameWay)
        else float(
            (np.ptp(way.joints(np.linspace(0.0, 1.0, 129)), axis=0) / 2.0 / np.maximum(reach, 1e-300)).max()
        )
        for way in ways
    ]
    if min(halves) < 1.0 - _ROUNDING:
        if blend.or_less:
            return _Room(0.0, None, reach * min(halves))
        findings.add(
            *messages.blend_too_large(min(halves) * blend.angle, "angle", halves[0] > halves[1], step)
        )
        return None
    return _Room(0.0, None, reach)


def _of_frame(
    robot: Robot,
    step: Motion,
    following: Motion | Gap,
    ways: _Ways,
    blend: Reading,
    findings: Collector,
    *,
    is_long: bool,
) -> _Room | None:
    """Return the allowed distance of the moving frame from a corner. If the BLEND doesn't fit, return None
    and add a finding.

    In a long chain, or if the blend may be smaller (`or_less`), the distance is limited to half of the
    shorter path.
    """
    if blend.length is None:
        findings.add(*messages.blend_without_unit("length", "of a moving frame", step.origin))
        return None
    frame = next(
        moving_frame(one) for one in (step, following) if isinstance(one, LineMove | ArcMove | PoseSplineMove)
    )
    if blend.length == 0.0:
        return _tangent(step, ways, frame, findings)
    halves = [math.inf if way is None else _frame_way(robot, way, frame) / 2.0 for way in ways]
    far = [half for half in halves if half > _NO_WAY]
    if far and (is_long or blend.or_less):
        return _Room(min(blend.length, *far), frame)
    if far and min(far) < blend.length * (1.0 - _ROUNDING):
        findings.add(*messages.blend_too_large(min(far), "length", halves[0] > halves[1], step))
        return None
    return _Room(blend.length, frame)


def _frame_way(robot: Robot, path: Path | FrameWay, frame: Array) -> float:
    """Return the distance that a frame on the flange travels along a path [m]."""
    if isinstance(path, CartesianPath | FrameWay):
        length, turns = extent_of(path.frame)
        return 0.0 if turns else length
    places = tool_poses(robot.chain, path.joints(np.linspace(0.0, 1.0, 129)), frame)[:, :3, 3]
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())


def _tangent(step: Motion, ways: _Ways, frame: Array | None, findings: Collector) -> _Room | None:
    """Return a distance of 0 for a corner with BLEND 0. If the corner is sharp, return None and add a
    finding.

    At any corner with BLEND 0, both paths must have one direction, unless the command of a Cartesian motion
    sets a tolerance.
    """
    first, second = ways
    if first is None or second is None:
        return None
    if isinstance(first, CartesianPath | FrameWay) != isinstance(second, CartesianPath | FrameWay):
        findings.add(*messages.not_tangent(None, False, step.origin))
        return None
    ahead, behind = _direction(first, 1.0), _direction(second, 0.0)
    # Compare the directions, and the rotations per distance.
    bend = float(np.arccos(np.clip(ahead[0] @ behind[0], -1.0, 1.0)))
    twist = float(np.linalg.norm(ahead[1] - behind[1]))
    is_within = frame is not None and step.tolerance is not None
    if (bend > _TANGENT or twist > _TANGENT) and not is_within:
        findings.add(*messages.not_tangent((bend, twist), frame is not None, step.origin))
        return None
    return _Room(0.0, frame)


def _direction(path: Path | FrameWay, s: float) -> tuple[Array, Array]:
    """Return the direction of a path at one of its ends as a unit vector, and the frame's rotation per
    distance there [rad/m].
    """
    if isinstance(path, CartesianPath | FrameWay):
        tangent = path.frame.tangents(np.array([s]))[0]
        ways = tangent[:3] if np.linalg.norm(tangent[:3]) > _NO_WAY else tangent[3:]
        size = float(np.linalg.norm(ways))
        turns = tangent[3:] / size if ways is not tangent[3:] else np.zeros(3)
        return ways / size, turns
    step = 1e-6
    pair = path.joints(np.array([0.0, step]) if s == 0.0 else np.array([1.0 - step, 1.0]))
    # One-sided difference quotient at the end of the path.
    slope = (pair[1] - pair[0]) / step
    return slope / np.linalg.norm(slope), np.zeros(3)
