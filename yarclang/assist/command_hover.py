"""What is said of a command: where it leads, how long it takes, what it comes near to."""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.assist.motions import MotionFacts, facts_of, first_motion, pace_in
from yarclang.assist.pose_lines import joints_text
from yarclang.assist.view import View
from yarclang.report.inspection.limits import Pace
from yarclang.report.pose_text import pose_text
from yarclang.units import MM


def command_lines(view: View, line: int) -> Iterator[str]:
    """What a view knows of the motion in a line, in Markdown; nothing for what is none. It may plan the motion once more."""
    known, there = view.planned_at(line) or (view, line)
    steps = known.steps_in(there)
    number = first_motion(known, steps)
    if number is None or (facts := facts_of(known, number)) is None:
        return
    yield from motion_lines(known, facts, pace_in(known, number))
    if len(steps) > 1:
        yield f"- the first of {len(steps):,} times: {facts.label}"
    if known is not view:
        yield "- as it was before the last edits"


def motion_lines(view: View, facts: MotionFacts, pace: Pace | None) -> Iterator[str]:
    """The lines for one motion."""
    robot = view.robot
    assert robot is not None
    if facts.in_base is not None:
        yield f"- ends with `{{{facts.frame}}}` in `{{{facts.base}}}` at {pose_text(facts.in_base)}"
    if facts.in_world is not None:
        yield f"- ends with `{{{facts.frame}}}` in `{{B}}` at {pose_text(facts.in_world)}"
    if facts.joints is not None:
        yield f"- joints {joints_text(robot, facts.joints)}"
    if facts.duration is None:
        yield "- not planned: the program has errors" if view.checked else "- being planned"
        return
    shortest = f", at least {pace.shortest:.3f} s" if pace is not None and pace.shortest is not None else ""
    yield f"- takes {facts.duration:.3f} s{shortest}, from {facts.begins:.3f} s on"
    if (load := facts.load) is not None:
        yield f"- nearest limit: {load[0]} of {load[1].name}, {load[1].share * 100:.0f} %"
    if facts.certificate is not None and facts.certificate.position.name:
        position = facts.certificate.position
        yield f"- farthest joint: {position.name}, {position.share * 100:.0f} % of the way to its limit"
    yield f"- smallest singular value {facts.smallest:.3f}"
    if (clear := facts.clearance) is not None:
        between = f" ({clear.first} and {clear.second})" if clear.first else ""
        yield f"- clearance at least {clear.distance / MM:.1f} mm{between}"
