"""Pairs of bodies that are allowed to touch, and that really come closer than their margins during a motion.

They show which of the program's allowances are needed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from yarclang.certify.bodies.handled import Handled
from yarclang.certify.bodies.sweep import Sweep
from yarclang.certify.certificate import MayTouch
from yarclang.certify.moments import span_text
from yarclang.collision.meeting import contact
from yarclang.collision.proof import Meeting, clearances
from yarclang.collision.scene import Scene, allowed_name
from yarclang.diagnostics import Diagnostic
from yarclang.units import MM


def find_touching(
    sweep: Sweep, scenes: Sequence[Scene]
) -> tuple[Mapping[int, frozenset[tuple[str, str]]], list[Diagnostic]]:
    """Find the pairs of bodies that are allowed to touch and come closer to each other than their margins.

    Args:
        sweep: the M commands.
        scenes: the bodies during each of the commands.

    Returns:
        For each command's index, the names of its pairs in the form of `allowed_name`; and a warning about
        each pair of two bodies of the robot.
    """
    touching: dict[int, set[tuple[str, str]]] = {}
    warnings: list[Diagnostic] = []
    for scene in dict.fromkeys(scenes):
        if scene.allowed is None or not len(scene.allowed.first):
            continue
        rows = [row for row, own in enumerate(scenes) if own is scene]
        alone = replace(scene, pairs=scene.allowed)
        reported: set[tuple[int, tuple[str, str]]] = set()
        for meeting in clearances(alone, sweep.course, sweep.spans[rows]).meetings:
            row, pair = (
                rows[meeting.motion],
                (int(alone.pairs.first[meeting.pair]), int(alone.pairs.second[meeting.pair])),
            )
            names = allowed_name(scene.bodies, pair)
            touching.setdefault(row, set()).add(names)
            if all(scene.bodies[body].of_robot for body in pair) and (row, names) not in reported:
                reported.add((row, names))
                warnings.append(_of_itself(alone, sweep, row, meeting))
    return {row: frozenset(pairs) for row, pairs in touching.items()}, warnings


def _of_itself(scene: Scene, sweep: Sweep, row: int, meeting: Meeting) -> Diagnostic:
    """Return the warning about two bodies of the robot that touch or overlap, which the program or cell
    allows.
    """
    moving, other = scene.names(meeting.pair)
    origin = sweep.places[row].motion.origin
    found = contact(scene, sweep.course, sweep.span(row), meeting)
    how = f"is {-found.distance / MM:.3g} mm deep in" if found.distance < 0.0 else "touches"
    when = span_text(found.begin, found.end, sweep.lasts(row))
    message = f"{moving} {how} {other}, {when}: the robot hits itself, but this contact is allowed here"
    return Diagnostic("Y0935", message, origin.source, origin.span, _ITSELF, place=origin.place)


_ITSELF = (
    "remove the allowance and choose another path; if only the shapes are too large, make them smaller, "
    "or write the pair under [collision] allowed in robot.toml"
)


def may_touch(handled: Handled, step: int, touching: frozenset[tuple[str, str]]) -> Iterator[MayTouch]:
    """Yield the pairs of bodies whose distance isn't checked during a command.

    Args:
        handled: the cell's state during each command, and the lines that allow pairs to touch. In a partial
            plan, such a line may be outside of the planned part.
        step: the step of the command.
        touching: the pairs that come closer than their margins.
    """
    cell = handled.at(step)
    givers = {one.pair: one.giver for one in handled.allowances.get(step, ())}
    for pair in sorted(cell.allowed) if cell is not None else ():
        yield MayTouch(*pair, givers.get(pair, "an earlier line"), pair in touching)
