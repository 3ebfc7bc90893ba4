"""Check, before any program, that the zones of a cell can be respected at all, and that the robot's HOME
respects them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.cell.keeping import Sight, Tilt
from yarclang.cell.model import Cell, HalfSpace, JointWindow, ShapeRegion, Unplaced, Zone
from yarclang.collision.scene import Scene, scene_of
from yarclang.collision.zones.regions import Place, coal_of, faces_of, reach
from yarclang.collision.zones.sights import aimed_at
from yarclang.collision.zones.watched import tool_frame
from yarclang.collision.zones.windows import room
from yarclang.collision.zones.workspace import Watch, broken_at
from yarclang.diagnostics import Diagnostic
from yarclang.robot.model import Limits, Robot
from yarclang.shapes import Box, Cylinder
from yarclang.units import DEG, MM


def impossible_zones(robot: Robot, cell: Cell) -> Iterator[Diagnostic]:
    """Yield a finding for each zone that no robot position can respect, by itself or together with an
    earlier zone.
    """
    for at, zone in enumerate(cell.zones):
        why = _by_itself(robot, zone)
        for other in cell.zones[:at]:
            why = why or _beside(robot, other, zone)
        if why is not None:
            yield _told("Y0913", cell, zone, f"no motion can respect the zone {zone.name}: {why}.", _REMEDY)


def home_in_zones(robot: Robot, cell: Cell) -> Iterator[Diagnostic]:
    """Yield a finding for each zone that the robot's HOME breaks, with {TCP} as the tool."""
    told: set[str] = set()
    scene = scene_of(robot, cell).value
    if scene is None:
        return
    for watch, slack in broken_at(robot, cell, tool_frame(robot), robot.home):
        if watch.zone.name not in told:
            told.add(watch.zone.name)
            message = (
                f"{robot.name}'s HOME breaks the zone {watch.zone.name}: {_how(robot, scene, watch, slack)}."
            )
            help_ = "A program that starts in HOME is refused: give it another START, or correct the zone."
            yield _told("Y0914", cell, watch.zone, message, help_)


_REMEDY = "Correct its size, place, margin or watched bodies."


def _told(code: str, cell: Cell, zone: Zone, message: str, help_: str) -> Diagnostic:
    return Diagnostic(
        code, message[0].upper() + message[1:], cell.source, cell.zone_places.get(zone.name), help_
    )


def _by_itself(robot: Robot, zone: Zone) -> str | None:
    """Return the reason why no robot position respects a zone, even without any other zone; None if the zone
    can be respected.
    """
    for window in (zone.region, zone.posture):
        if isinstance(window, JointWindow) and (zone.rule in ("allowed", "posture")):
            joint = _joint_without(robot, window, robot.limits)
            if joint is not None:
                return f"its window for {joint} is outside of the limits of {joint}"
    region, limits = zone.region, robot.limits
    if isinstance(region, JointWindow):
        covered = ((region.lower <= limits.lower) & (limits.upper <= region.upper)).all()
        return (
            "its window covers all positions of its joints" if zone.rule == "forbidden" and covered else None
        )
    if zone.rule == "allowed" and isinstance(region, ShapeRegion) and _depth(region) <= zone.margin > 0.0:
        return f"its margin of {zone.margin / MM:.4g} mm leaves no room inside"
    return None


def _depth(region: ShapeRegion) -> float:
    """Return the largest depth that a point can have inside a region [m]."""
    match region.shape:
        case Box(size=size):
            return float(size.min()) / 2.0
        case Cylinder(radius=radius, length=length):
            return min(radius, length / 2.0)
        case shape:
            return shape.radius


def _beside(robot: Robot, first: Zone, second: Zone) -> str | None:
    """Return the reason why no robot position respects both of two zones; None if both can be respected."""
    one, other = first.region, second.region
    rules = {first.rule, second.rule}
    if isinstance(one, JointWindow) and isinstance(other, JointWindow):
        joint = _joint_without(robot, one, other) if rules == {"allowed"} else None
        return f"its window for {joint} doesn't overlap with that of {first.name}" if joint else None
    if isinstance(one, Unplaced) or isinstance(other, Unplaced) or not set(first.watch) & set(second.watch):
        return None
    if rules == {"allowed"} and _apart(one, other, first.margin + second.margin):
        return f"it doesn't overlap with {first.name}, which is an allowed zone too"
    if rules == {"allowed", "forbidden"}:
        allowed, forbidden = (one, other) if first.rule == "allowed" else (other, one)
        if _within(allowed, forbidden):
            whole = first.name if first.rule == "forbidden" else "it"
            return f"{'it' if whole != 'it' else first.name} lies inside {whole}, which is forbidden"
    return None


def _joint_without(robot: Robot, one: JointWindow, other: JointWindow | Limits) -> str | None:
    """Return the name of a joint for which a window has no position in common with another window, or with
    the joint limits; None if there is no such joint.
    """
    low, high = np.maximum(one.lower, other.lower), np.minimum(one.upper, other.upper)
    (empty,) = np.nonzero(low > high)
    return robot.joint_names[int(empty[0])] if len(empty) else None


def _apart(one: Place, other: Place, margin: float) -> bool:
    """Return True if two regions have no point in common.

    If one is a half space, it is reduced by `margin`; between other regions the margin is ignored.
    """
    if isinstance(one, HalfSpace) or isinstance(other, HalfSpace):
        half, rest = (one, other) if isinstance(one, HalfSpace) else (other, one)
        assert isinstance(half, HalfSpace)
        return float(reach(rest, half.normal[None])[0]) < half.offset + margin
    import coal

    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    (shape, placed), (second, there) = coal_of(one), coal_of(other)
    return float(coal.distance(shape, placed, second, there, request, answer)) > 0.0


def _within(inner: Place, outer: Place) -> bool:
    """Return True if a region lies in another one with flat faces."""
    faces = faces_of(outer)
    return faces is not None and bool((reach(inner, faces.normals) <= faces.offsets).all())


def _how(robot: Robot, scene: Scene, watch: Watch, slack: float) -> str:
    """Return a clause that states the way in which HOME breaks a zone."""
    zone, q = watch.zone, robot.home
    window = zone.region if isinstance(zone.region, JointWindow) else zone.posture
    if window is not None and zone.rule in ("allowed", "posture"):
        out = -room(window, q[None])[0] / robot.axis_units
        joint = int(np.argmax(out))
        return (
            f"{robot.joint_names[joint]} is {out[joint]:.4g} {robot.axis_unit_names[joint]} outside of its "
            "window"
        )
    if isinstance(zone.region, Tilt):
        return f"the axis tilts {-slack / DEG:.4g} deg more than allowed"
    if isinstance(zone.region, Sight):
        aim = aimed_at(zone.region, scene, q[None])
        angle, distance = float(aim.angle[0]) / DEG, float(aim.distance[0]) / MM
        return f"the point is {angle:.4g} deg off the axis, and {distance:,.6g} mm away"
    if watch.item is None:
        return "the joints are in its window"
    what = "out of it" if zone.rule == "allowed" else "in it"
    beyond = -(slack + zone.margin)
    if beyond <= 0.0:
        return (
            f"{watch.item.name} is within {-beyond / MM:.4g} mm of its border, but its margin is "
            f"{zone.margin / MM:.4g} mm"
        )
    return f"{watch.item.name} is {beyond / MM:,.6g} mm {what}"
