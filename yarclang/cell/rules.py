"""Read the path constraints that a cell sets for all motions: `[[keep]]`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from yarclang.cell.bodies import Surroundings, belong
from yarclang.cell.frames import ROOTS, known_frame, mount_of
from yarclang.cell.keeping import LEAST_SIGHT, LEAST_TILT, MOST_TILT, Keep, KeepKind, region_of
from yarclang.cell.model import Mount, Zone
from yarclang.toml.draft import spoken, table_name
from yarclang.toml.places import Path
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.cell.schema import CellTable, KeepTable

_KINDS: Mapping[str, tuple[KeepKind, tuple[str, ...], tuple[str, ...]]] = {
    "upright": ("UPRIGHT", ("angle",), ()),
    "above": ("ABOVE", ("distance",), ()),
    "facing": ("FACING", ("angle",), ("range",)),
    "seen": ("SEEN", ("angle",), ("range",)),
}
"""For each rule: its word in the language, its required keys, and its optional keys."""


def read_rules(table: CellTable, around: Surroundings) -> dict[str, tuple[Zone, int]]:
    """Read the path constraints of a cell.toml (`[[keep]]`). Return a zone for each correct entry, with the
    number of the entry, by the zone's name. Report the wrong entries.
    """
    found: dict[str, tuple[Zone, int]] = {}
    for at, entry in enumerate(table.keep):
        rule = _read(entry, ("keep", at), around)
        if rule is None:
            continue
        zone = Zone.of(rule)
        if zone.name in found:
            message = f"{table_name(('keep', at))} repeats an earlier entry: {rule.words}."
            around.measures.file.say("Y1311", ("keep", at), message, "Remove one of them.")
            continue
        found[zone.name] = zone, at
    return found


def _read(entry: KeepTable, path: Path, around: Surroundings) -> Keep | None:
    measures, file = around.measures, around.measures.file
    units = measures.of_entry(entry.units, path)
    carried = _frame(entry.frame, (*path, "frame"), around)
    standing = _frame(entry.of or "B", (*path, "of"), around)
    sound = True
    if carried is not None and carried[1] is not None and not carried[1].on_flange:
        message = f"{table_name(path)} is a rule for {carried[0]}, which doesn't move with the robot."
        file.say("Y1371", (*path, "frame"), message, "Name TCP, FLANGE, or a frame that is fixed to FLANGE.")
        sound = False
    if standing is not None and standing[1] is not None and standing[1].on_flange:
        message = f"{table_name(path)} refers to {standing[0]}, which the robot carries."
        file.say("Y1371", (*path, "of"), message, "Name B, or a frame that is fixed to B.")
        sound = False
    if entry.rule is None:
        return None
    kind, needed, optional = _KINDS[entry.rule]
    if not belong(entry, path, entry.rule, needed, ("angle", "distance", "range"), around, optional):
        return None
    limits = _limits(entry, path, kind, around)
    if not sound or limits is None or units is None or carried is None or standing is None:
        return None
    if carried[1] is None or standing[1] is None:
        return None
    region = region_of(kind, carried[1].transform, standing[1].transform, *limits)
    return Keep(kind, carried[0], standing[0], region, of_cell=True)


def _frame(name: str | None, path: Path, around: Surroundings) -> tuple[str, Mount | None] | None:
    """Return the name (in upper case) and the pose of the frame that a rule names. The pose is None if it is
    known only with a robot. Report a wrong name, and return None for it.
    """
    if name is None:
        return None
    robot = around.robot
    if name.upper() == "TCP" and path[-1] == "frame":
        placed = None if robot is None else robot.flange_from_frame.get("TCP")
        if robot is not None and placed is None:
            message = f"{spoken(path)} is TCP, which {robot.name} doesn't have."
            around.measures.file.say("Y1329", path, message, "Name FLANGE, or a frame of this file.")
            return None
        return "TCP", None if placed is None else Mount(placed, on_flange=True)
    known = known_frame(name, path, {one: one for one in around.names}, around.measures.file)
    if known is None or (known not in ROOTS and known not in around.frames):
        return None
    return known, mount_of(known, around.frames)


def _limits(entry: KeepTable, path: Path, kind: KeepKind, around: Surroundings) -> tuple[float, ...] | None:
    """Return the limits of a path constraint: the angle [rad] or distance [m] and, for a cone, the range of
    distances from its apex [m]. Report wrong limits, and return None for them.
    """
    measures, file = around.measures, around.measures.file
    units = measures.of_entry(entry.units, path)
    if kind == "ABOVE":
        factor = measures.factor(units, "length", (*path, "distance"))
        return None if factor is None or entry.distance is None else (entry.distance * factor,)
    factor = measures.factor(units, "angle", (*path, "angle"))
    if factor is None or entry.angle is None:
        return None
    angle = entry.angle * factor
    if not LEAST_TILT <= angle <= MOST_TILT:
        message = (
            f"{spoken((*path, 'angle'))} is {angle / DEG:.6g} deg: no motion could be proved to observe it."
        )
        remedy = f"Write an angle from {LEAST_TILT / DEG:g} to {MOST_TILT / DEG:g} deg."
        file.say("Y1308", (*path, "angle"), message, remedy)
        return None
    if entry.range is None:
        return (angle,)
    place = (*path, "range")
    length = measures.factor(units, "length", place)
    if len(entry.range) != 2:
        message = f"{spoken(place)} must have 2 values, but has {len(entry.range)}."
        file.say("Y1309", place, message, "Write the smallest and the largest distance: [200, 600].")
        return None
    if length is None:
        return None
    near, far = (one * length for one in entry.range)
    if not (near >= LEAST_SIGHT and far >= near + LEAST_SIGHT and np.isfinite(far)):
        message = (
            f"{spoken(place)} is from {near / MM:.6g} to {far / MM:.6g} mm: no motion could be proved to "
            "observe it."
        )
        least = f"{LEAST_SIGHT / MM:g} mm"
        file.say("Y1308", place, message, f"Begin it at {least} or more, and make it at least {least} wide.")
        return None
    return angle, near, far
