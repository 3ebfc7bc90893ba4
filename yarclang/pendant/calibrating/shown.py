"""Conversion of a calibration to a message for pages: its recorded positions (touches), their residuals,
and the uncertainty of the result.
"""

from __future__ import annotations

import numpy as np

from yarclang.calibration.spread import (
    ERROR,
    FAR,
    LARGEST_TIP,
    LARGEST_TURN,
    FrameSpread,
    TipSpread,
    frame_spread,
    helpful_tilt,
    tip_spread,
)
from yarclang.calibration.touching import FrameTouching, HomeTouching, TipTouching, Touching
from yarclang.coordinator.messages.findings import finding_message
from yarclang.pendant.calibrating.kept import Calibration
from yarclang.pendant.messages.calibration import CalibrationShown, SpreadRow, TouchShown
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array
from yarclang.units import DEG, MM

_FEWEST_VISITS = 3
_BELOW = 0.975
"""Level of the quantile of Student's t distribution for the reported error bound. Since errors have both
signs, 95 of 100 errors are within the bound.
"""
_EXACT = 1e-3
"""Largest residual that counts as exact [mm or deg]. No touch with a smaller residual is marked as the
worst one.
"""


def shown(calibration: Calibration | None, *, mine: bool) -> CalibrationShown:
    """Return a calibration as a message.

    Args:
        calibration: calibration to show; None if none is running.
        mine: True if the calibration belongs to the session that asks.
    """
    if calibration is None:
        return CalibrationShown(
            version=0, kind="", name="", tool="", by="", mine=True, touches=(), needed=0, next="",
                ready=False,
            result=(), unit="", findings=(), spread=(), advice="", error_mm=ERROR / MM, told=False,
        )  # fmt: skip
    touching = calibration.touching
    rows, advice = _spread(touching)
    error = touching.error()
    return CalibrationShown.model_validate(
        {
            "version": calibration.version,
            "kind": calibration.kind,
            "name": touching.name,
            "tool": calibration.tool,
            "by": calibration.user,
            "mine": mine,
            "touches": _touches(touching),
            "needed": touching.missing,
            "next": touching.next_step(),
            "ready": bool(touching.result_text()),
            "result": tuple(touching.result_text().splitlines()),
            "unit": _unit(touching),
            "findings": tuple(map(finding_message, touching.findings)),
            "spread": rows,
            "advice": advice,
            "error_mm": round(error / MM, 3),
            "told": error != ERROR,
        }
    )


def _touches(touching: Touching) -> tuple[TouchShown, ...]:
    residuals = touching.residuals()
    worst = -1
    if residuals is not None and len(residuals) and residuals.max() > _EXACT:
        worst = int(np.argmax(residuals))
    units = touching.robot.axis_units
    return tuple(
        TouchShown(
            label=_label(touching, at),
            joints=tuple((joints / units).round(3).tolist()),
            residual=None if residuals is None else round(float(residuals[at]), 4),
            worst=at == worst,
            can_go=touching.can_go(at),
        )
        for at, joints in enumerate(touching.joints)
    )


def _label(touching: Touching, at: int) -> str:
    if isinstance(touching, FrameTouching):
        return touching.named[at] if at < len(touching.named) else "point of the plane"
    return "at the marks" if isinstance(touching, HomeTouching) else "touch"


def _unit(touching: Touching) -> str:
    if not isinstance(touching, HomeTouching):
        return "mm"
    robot = touching.robot
    names = {robot.axis_unit_names[robot.joint_names.index(name)] for name in touching.marks}
    return " or ".join(sorted(names))


def _spread(touching: Touching) -> tuple[tuple[SpreadRow, ...], str]:
    if not touching.joints:
        return (), ""
    match touching:
        case TipTouching():
            return _of_tip(touching.poses()[:, :3, :3], touching.error())
        case FrameTouching():
            return _of_frame(touching.points(), touching.error())
        case HomeTouching():
            return _of_marks(touching)
        case _:
            raise AssertionError(touching)


def _of_tip(rotations: Array, error: float) -> tuple[tuple[SpreadRow, ...], str]:
    spread: TipSpread = tip_spread(rotations, error)
    rows = tuple(
        SpreadRow(
            label=f"tip along {_direction(direction)} of {{FLANGE}}",
            value=_length(axis),
            enough=bool(axis <= LARGEST_TIP),
        )
        for axis, direction in zip(spread.axes, spread.directions, strict=True)
    )
    worst = float(spread.axes[0])
    if worst <= LARGEST_TIP:
        return rows, ""
    certainty = "isn't known at all" if np.isinf(worst) else f"is known only to {_length(worst)}"
    if error > LARGEST_TIP:
        return rows, f"the touches deviate by {_length(error)} each: record the worst ones again"
    tilt = helpful_tilt(rotations, error)
    after_that = "" if np.isinf(tilt.longest) else f": then it is known to {_length(tilt.longest)}"
    alike = (
        "the touches are tilted too little, or all about the same axis"
        if len(rotations) > 1
        else "one touch isn't enough"
    )
    return rows, (
        f"{alike}: the tip along {_direction(spread.directions[0])} of the flange {certainty}. "
        f"Touch next with the tool turned by {tilt.angle / DEG:+.0f} deg about {'xyz'[tilt.axis]} of "
        f"the flange from the last touch{after_that}"
    )


def _of_frame(points: Array, error: float) -> tuple[tuple[SpreadRow, ...], str]:
    spread: FrameSpread = frame_spread(points, error)
    rows = [SpreadRow(label="origin", value=_length(spread.origin), enough=True)]
    for axis, turn in zip("xyz", spread.turns, strict=True):
        value = "not known yet" if np.isinf(turn) else f"{turn / DEG:.2f} deg"
        rows.append(SpreadRow(label=f"turned about {axis}", value=value, enough=bool(turn <= LARGEST_TURN)))
    far = spread.at(FAR)
    rows.append(
        SpreadRow(
            label=f"a point {FAR / MM:g} mm from the origin",
            value=_length(far),
            enough=bool((spread.turns <= LARGEST_TURN).all()),
        )
    )
    if len(points) < 2:
        return tuple(rows), ""
    needed = np.sqrt(2.0) * error / LARGEST_TURN / MM
    advice = []
    if spread.turns[2] > LARGEST_TURN:
        advice.append(
            f"the point on x is only {spread.base / MM:.0f} mm from the origin: touch it again, "
            f"{needed:.0f} mm or more away"
        )
    if len(points) > 2 and spread.turns[0] > LARGEST_TURN:
        advice.append(
            f"the points of the plane are at most {spread.width / MM:.0f} mm beside the x axis: touch "
            f"one {needed:.0f} mm or more beside it"
        )
    if len(points) > 2 and spread.turns[1] > LARGEST_TURN and not advice:
        advice.append(
            "the points of the plane lie far from the origin along x: touch one right beside the origin"
        )
    return tuple(rows), "; ".join(advice)


def _of_marks(touching: HomeTouching) -> tuple[tuple[SpreadRow, ...], str]:
    robot, visits = touching.robot, np.array(touching.joints)
    if len(visits) < 2:
        return (
            (),
            (
                "one visit doesn't show the repeatability of the mark: move away, approach it again from "
                "the same side, and touch again"
            ),
        )
    from scipy.special import stdtrit

    rows, share = [], float(stdtrit(len(visits) - 1.0, _BELOW))
    for at, name in enumerate(robot.joint_names):
        if name not in touching.marks:
            continue
        unit, factor = robot.axis_unit_names[at], robot.axis_units[at]
        # Error bound of the mean, by Student's t distribution, because each mark was visited only a few
        # times.
        error = share * float(visits[:, at].std(ddof=1)) / np.sqrt(len(visits))
        moved = _flange_moves(touching, at, error)
        rows.append(
            SpreadRow(
                label=f"offset of {name}",
                value=f"{error / factor:.4f} {unit}, the flange by {_length(moved)}",
                enough=moved <= LARGEST_TIP,
            )
        )
    if len(visits) < _FEWEST_VISITS:
        return tuple(rows), "two visits may agree by chance: make a third one"
    return tuple(rows), ""


def _flange_moves(touching: HomeTouching, joint: int, by: float) -> float:
    """Return how far the flange is displaced [m] by an error of one joint while the joints are at their
    marks.

    Args:
        touching: recorded positions of the joints at their marks.
        joint: number of the joint.
        by: error of the joint [rad or m].
    """
    there = np.mean(touching.joints, axis=0)
    off = there.copy()
    off[joint] += by
    places = flange_poses(touching.robot.chain, np.array([there, off]))[:, :3, 3]
    return float(np.linalg.norm(places[1] - places[0]))


def _direction(direction: Array) -> str:
    at = int(np.argmax(np.abs(direction)))
    if abs(direction[at]) > _ALONG:
        return "xyz"[at]
    return " ".join(f"{value:.2f}" for value in direction.round(2) + 0.0)


_ALONG = 0.985
"""Least cosine of the angle between a direction and a coordinate axis at which the direction is named after
the axis. It corresponds to 10 deg.
"""


def _length(value: float) -> str:
    return "not known" if np.isinf(value) else f"{value / MM:.2f} mm"
