"""Proof that the bodies of robot, load and cell stay apart, with their least distances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from yarclang import hir
from yarclang.certify.bodies.handled import Handled
from yarclang.certify.bodies.pieces import incomplete
from yarclang.certify.bodies.remedy import remedy
from yarclang.certify.bodies.second import Nearer, refuted
from yarclang.certify.bodies.sweep import Sweep, sweep_of
from yarclang.certify.bodies.touching import find_touching
from yarclang.certify.certificate import Clearance
from yarclang.certify.moments import pose_text, span_text
from yarclang.certify.read.layout import Layout, chunks
from yarclang.collision.meeting import Contact, contact
from yarclang.collision.proof import KNOWN, RESOLUTION, SLACK, Clearances, Meeting, clearances
from yarclang.collision.scene import Rows, Scene, scene_of, together
from yarclang.diagnostics import Diagnostic, grouped
from yarclang.frozen import frozen
from yarclang.robot.model import Robot
from yarclang.units import MM


@frozen
class Apart:
    """Least distances between bodies during a command.

    Attributes:
        cell: distance of the robot from the cell; None if no body of the cell is compared.
        own: distance of the robot's bodies from each other; None if no such pair is compared.
        touching: names, in upper case, of the pairs of bodies that are allowed to touch and come nearer to
            each other than their margin.
    """

    cell: Clearance | None
    own: Clearance | None
    touching: frozenset[tuple[str, str]] = frozenset()


NOTHING_NEAR = Apart(None, None)


def find_clearances(
    layout: Layout, program: hir.Program, robot: Robot, handled: Handled
) -> tuple[dict[int, Apart], list[Diagnostic]]:
    """Bound the least distances between bodies during every command.

    Args:
        layout: the segments of the controller text.
        program: the program that the text was compiled from.
        robot: the robot, with its bodies and kinematics.
        handled: the cell's state during each command.

    Returns:
        The distances by step, and findings where bodies come too close.
    """
    cell = program.cell
    if not robot.shapes and not handled.cells and not (cell and cell.obstacles):
        return {}, []
    apart: dict[int, Apart] = {}
    findings = list(incomplete(robot, cell, program.source))
    for places in chunks([place for place in layout.places if place.size]):
        cells = [handled.at(place.step) for place in places]
        scenes: list[Scene] = []
        for around in dict.fromkeys(cells):
            result = scene_of(robot, around)
            if result.value is None:
                source = program.source
                return {}, [
                    one if one.source else Diagnostic(one.code, one.message, source)
                    for one in result.diagnostics
                ]
            scenes.append(result.value)
        # Make one scene of all bodies, so that many motions can be proved together. Each motion has its own
        # pairs.
        scene, pairs = together(scenes)
        of_cell = dict(zip(dict.fromkeys(cells), pairs, strict=True))
        pairs_of = [of_cell[cell] for cell in cells]
        lets = any(one.allowed is not None for one in scenes)
        if not len(scene.pairs.first) and not lets:
            continue
        sweep = sweep_of(layout, places)
        scene_at = dict(zip(dict.fromkeys(cells), scenes, strict=True))
        touching: Mapping[int, frozenset[tuple[str, str]]] = {}
        if lets:
            touching, told_of = find_touching(sweep, [scene_at[cell] for cell in cells])
            findings += told_of
            if not len(scene.pairs.first):  # all pairs may touch
                apart |= {
                    place.step: Apart(None, None, touching.get(row, frozenset()))
                    for row, place in enumerate(places)
                }
                continue
        chosen = pairs_of if len(scenes) > 1 else None
        proved = clearances(scene, sweep.course, sweep.spans, chosen)
        findings += [
            _refuted(scene, sweep, one) for one in refuted(scene, sweep.course, sweep.spans, proved, chosen)
        ]
        kinds = {cell: _kinds(scene, of_cell[cell]) for cell in of_cell}
        for row, (place, cell) in enumerate(zip(places, cells, strict=True)):
            from_cell, from_itself = (
                _clearance(scene, proved, row, kind) if kind in kinds[cell] else None for kind in (1, 0)
            )
            apart[place.step] = Apart(from_cell, from_itself, touching.get(row, frozenset()))
        for row, meetings in _by_motion(proved.meetings):
            contacts = [(one, contact(scene, sweep.course, sweep.span(row), one)) for one in meetings]
            findings.append(_finding(scene, sweep, row, contacts, robot))
    return apart, list(grouped(findings))


def _refuted(scene: Scene, sweep: Sweep, place: Nearer) -> Diagnostic:
    """Return the finding about a clearance that the second proof refutes."""
    moving, other = scene.names(place.pair)
    origin = sweep.places[place.motion].motion.origin
    message = (
        f"{moving} and {other} are {place.distance / MM:.5g} mm apart "
        f"{place.time - sweep.starts(place.motion):.3f} s after its start, where {place.reported / MM:.5g} "
        "mm were reported: the two proofs of clearances disagree"
    )
    help_ = (
        "nothing is written: this is an error of yarclang; please report it with the program, robot and cell"
    )
    return Diagnostic("Y1180", message, origin.source, origin.span, help_, place=origin.place)


def _kinds(scene: Scene, own: Rows) -> set[int]:
    """Return the kinds of those pairs in `own` whose bodies must not touch.

    Kind 1 is a pair of a body of the robot and one of the cell, kind 0 a pair of two bodies of the robot.
    """
    return {int(one) for one in scene.pairs.of_cell[own][~scene.pairs.touching[own]]}


def _clearance(scene: Scene, found: Clearances, row: int, kind: int) -> Clearance:
    """Return the proved least distance in a motion among its pairs of bodies of one kind."""
    near, least = int(found.nearest[row, kind]), float(found.least[row, kind])
    # Beyond `KNOWN`, a distance is only a bound, and the bodies found need not be the nearest ones.
    return _FAR if near < 0 or least >= KNOWN else Clearance(least, *scene.names(near))


_FAR = Clearance(KNOWN)


def _by_motion(meetings: tuple[Meeting, ...]) -> Iterator[tuple[int, list[Meeting]]]:
    for row in sorted({one.motion for one in meetings}):
        yield row, [one for one in meetings if one.motion == row]


def _finding(
    scene: Scene, sweep: Sweep, row: int, contacts: list[tuple[Meeting, Contact]], robot: Robot
) -> Diagnostic:
    """Return a finding with the figures of a motion's worst pair of bodies, and the names of all others."""
    worst = min(contacts, key=lambda one: one[1].distance - scene.pairs.margin[one[0].pair])
    pair, closest = worst[0].pair, worst[1]
    moving, other = scene.names(pair)
    motion = sweep.places[row].motion
    origin = motion.origin
    when = span_text(closest.begin, closest.end, sweep.lasts(row))
    q = sweep.course.at(np.array([sweep.starts(row) + closest.worst]))[0]
    margin = float(scene.pairs.margin[pair])
    if closest.distance <= 0.0:
        code = "Y0901" if scene.pairs.of_cell[pair] else "Y0902"
        how = f"{moving} penetrates {other} by {max(-closest.distance / MM, 0.01):.3g} mm"
    elif closest.distance >= margin + SLACK:
        code = "Y0930"
        how = f"{moving} comes within {closest.distance / MM:.5g} mm of {other}"
        how += f", whose margin is {margin / MM:.4g} mm" if margin > 0.0 else ""
        how += f": too near the limit for a proof, which needs up to {RESOLUTION / MM:.2g} mm more"
    else:
        code = "Y0903"
        how = f"{moving} comes within {closest.distance / MM:.3g} mm of {other}"
        how += (
            f", whose margin is {margin / MM:.4g} mm"
            if margin > 0.0
            else ", too near to be distinguished from contact"
        )
    names = dict.fromkeys(" and ".join(scene.names(one.pair)) for one, _ in contacts)
    names.pop(f"{moving} and {other}")
    more = f"; also too near: {', '.join(names)}" if names else ""
    message = f"{how}, {when}; worst at {closest.worst:.3f} s, {pose_text(robot, origin, q)}{more}"
    near = (min(one.begin for _, one in contacts), max(one.end for _, one in contacts))
    help_, fix = remedy(motion, _REMEDIES[code], near, sweep.lasts(row))
    return Diagnostic(code, message, origin.source, origin.span, help_, fix, place=origin.place)


_REMEDIES = {
    "Y0901": (
        "avoid it by a via pose, another order, or another configuration (NEAR); or correct the obstacle "
        "in the cell.toml"
    ),
    "Y0902": (
        "choose another configuration (NEAR) or a via pose; if these links always touch, `yarc robot "
        "check` shows what to write into robot.toml"
    ),
    "Y0930": (
        "keep a little farther away, or describe the obstacle by boxes, cylinders, spheres and capsules: "
        "the proof is tighter for these than for a hollow mesh"
    ),
    "Y0903": ("keep the margin, for example with a via pose; or reduce the margin in the cell.toml"),
}
