"""Convert a command's inspection to plain data, with units in the names."""

from __future__ import annotations

from typing import Any

import numpy as np

from yarclang.hir import Dwell, FrameLink, Step, TimedMove
from yarclang.report.inspection.flow import flows_json
from yarclang.report.inspection.inspected import Inspected, WayPoint, chain_of
from yarclang.report.inspection.limits import Pace
from yarclang.report.pose_text import pose_values
from yarclang.robot.model import Array, Robot
from yarclang.units import MS


def inspected_json(inspected: Inspected) -> dict[str, Any]:
    """Return an inspected command as plain data: everything that the text about it shows. Joints are given by
    name, and unknown values are null.
    """
    origin, robot = inspected.origin, inspected.robot
    motion = inspected.motion
    return {
        "place": origin.label,
        "index": origin.index,
        "name": origin.name,
        "step": inspected.number,
        "file": origin.source.name,
        "line": origin.span.line,
        "source": origin.source.line(origin.span.line),
        "frames": {"moving": _frames(origin.moving), "base": _frames(origin.base)},
        "start": _joints(robot, inspected.start),
        "end": _joints(robot, inspected.end),
        "targets": [_target(robot, one) for one in inspected.waypoints],
        "begins_s": inspected.begins,
        "program_duration_s": inspected.total.most if inspected.total else None,
        "program_takes": inspected.total.to_json() if inspected.total else None,
        "profile": (motion.profile or None) if motion else None,
        "timetable": _table(inspected.step) if isinstance(inspected.step, TimedMove) else None,
        "segments": motion.curve.segments if motion else None,
        "segment_time_ms": motion.curve.segment / MS if motion else None,
        "duration_s": motion.curve.duration if motion else _stands(inspected.step),
        "flows": flows_json(inspected.flows),
        "carries": list(inspected.carries),
        "convex_pieces": {one.name: {"count": one.count, "most": one.most} for one in inspected.divided},
        "parts": {verb.replace(" ", "_"): list(names) for verb, names in inspected.deeds},
        "limits": _limits(inspected.pace),
        "shortest_s": inspected.pace.shortest if inspected.pace else None,
        "certificate": inspected.certificate.to_json() if inspected.certificate else None,
        "controller_text": [
            {
                "first": one.first,
                "last": one.last,
                "what": one.what,
                "lines": list(inspected.text[one.first - 1 : one.last]),
            }
            for one in inspected.stretches
        ],
    }


def _table(step: TimedMove) -> dict[str, Any]:
    """Return the rows of a timetable, and the interpolation between them."""
    table = step.table
    between = (
        "clamped spline"
        if table.velocities is None
        else "cubic"
        if table.accelerations is None
        else "quintic"
    )
    return {
        "file": step.file or None,
        "rows": len(table.times),
        "first_s": float(table.times[0]),
        "last_s": float(table.times[-1]),
        "between": between,
        "stretch": step.stretch,
    }


def _stands(step: Step) -> float | None:
    """Return the duration of a dwell [s]; None for another step."""
    return step.duration if isinstance(step, Dwell) else None


def _frames(link: FrameLink | None) -> list[dict[str, Any]]:
    return [
        {
            "frame": one.name,
            "in": one.parent.name if one.parent else None,
            "pose": _pose(one.parent_from_frame),
            "file": one.source.name if one.source else None,
            "line": one.span.line if one.span else None,
        }
        for one in chain_of(link)
    ]


def _pose(pose: Array) -> dict[str, float]:
    names = ("x_mm", "y_mm", "z_mm", "roll_deg", "pitch_deg", "yaw_deg")
    return dict(zip(names, np.round(pose_values(pose), 9).tolist(), strict=True))


def _joints(robot: Robot, q: Array | None) -> dict[str, float] | None:
    if q is None:
        return None
    keys = (f"{name}_{unit}" for name, unit in zip(robot.joint_names, robot.axis_unit_names, strict=True))
    return dict(zip(keys, np.round(q / robot.axis_units, 9).tolist(), strict=True))


def _target(robot: Robot, waypoint: WayPoint) -> dict[str, Any]:
    return {
        "pose_in_B": _pose(waypoint.pose),
        "distance_from": _joints(robot, waypoint.reference),
        "near": waypoint.near,
        "out_of_reach_mm": waypoint.unreachable.miss * 1e3
        if waypoint.unreachable and waypoint.unreachable.kind == "reach"
        else None,
        "solutions": [
            {
                "joints": _joints(robot, one.q),
                "distance": one.distance,
                "verdict": one.verdict,
                "reason": one.reason,
                "out_of_limits": _joints(robot, one.excess) if one.verdict == "out of limits" else None,
            }
            for one in waypoint.solutions
        ],
    }


def _limits(pace: Pace | None) -> list[dict[str, Any]]:
    return [
        {"kind": one.kind, "of": one.whose, "share": one.share, "time_s": one.time, "way_share": one.s}
        for one in (pace.limits if pace else ())
    ]
