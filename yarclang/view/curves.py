"""Draw curves over time beside the picture, as SVG: joint positions within their ranges, joint speeds, and
the speed of the frame whose path is drawn.

A vertical marker shows the current instant. A style in a separate node sets its position, so that only a few
bytes are sent while time runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

import numpy as np

from yarclang.report.pictures.palette import joint_style
from yarclang.robot.model import Array
from yarclang.units import MM
from yarclang.view.stage import Stage
from yarclang.view.track import followed

_SAMPLES = 400
"""Number of instants for which the curves have values."""
_WIDTH, _HEIGHT, _GAP = 400.0, 70.0, 22.0
"""Width and height of a diagram, and height of the line of text above it [pixels]."""
_LEAST_SPEED = 1.0
"""Least upper end of the scale of a speed diagram [mm/s]. On a smaller scale, rounding errors would look like
motion.
"""
_LEAST_SHARE = 1.0
"""Least upper end of the scale of a diagram in percent of a limit [%]."""
_DASHES = {"-": "", "--": ' stroke-dasharray="6 3"', ":": ' stroke-dasharray="2 3"'}


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A diagram with several curves over time.

    Attributes:
        title: text above the diagram.
        values: (N, k) value of each curve at each time.
        low: smallest value of the scale.
        high: largest value of the scale.
        names: (k,) names of the curves.
    """

    title: str
    values: Array
    low: float
    high: float
    names: tuple[str, ...]


def curves_of(stage: Stage) -> tuple[Curve, ...]:
    """Return the diagrams of a scene over time; empty for a scene without time."""
    if stage.duration <= 0.0:
        return ()
    times = np.linspace(0.0, stage.duration, _SAMPLES)
    q, v = stage.track.at(times)
    robot, limits = stage.robot, stage.robot.limits
    lower, upper = (
        np.where(np.isfinite(limits.lower), limits.lower, -np.pi),
        np.where(np.isfinite(limits.upper), limits.upper, np.pi),
    )
    place = 100.0 * (2.0 * q - lower - upper) / (upper - lower)
    share = 100.0 * v / limits.velocity
    speed = followed(robot.chain, q, v, stage.flange_from_frame)[1] / MM
    most = max(float(np.abs(share).max()), _LEAST_SHARE)
    fastest = max(float(speed.max()), _LEAST_SPEED)
    return (
        Curve("joints, −100 to 100 % of their ranges", place, -100.0, 100.0, robot.joint_names),
        Curve(f"joint speeds, largest {most:.0f} % of the limit", share, -most, most, robot.joint_names),
        Curve(
            f"speed of {{{stage.frame}}}, largest {fastest:.4g} mm/s",
            speed[:, None],
            0.0,
            fastest,
            (stage.frame,),
        ),
    )


def curves_html(curves: tuple[Curve, ...]) -> str:
    """Return diagrams as HTML, one below the other, with the marker of the current instant over all of
    them.
    """
    marker = (
        '<div style="position:absolute;top:0;bottom:0;left:10px;right:10px;pointer-events:none">'
        '<div data-marker style="position:absolute;top:0;bottom:0;width:1px;background:#d62828;'
        'left:var(--yarc-instant, 0%)"></div></div>'
    )
    return f'<div style="position:relative">{"".join(map(_picture, curves))}{marker}</div>'


def _picture(curve: Curve) -> str:
    across = np.linspace(0.0, _WIDTH, len(curve.values))
    up = _HEIGHT * (1.0 - (curve.values - curve.low) / (curve.high - curve.low))
    lines = []
    for column, name in enumerate(curve.names):
        colour, style = joint_style(column)
        points = " ".join(
            f"{x:.1f},{y:.1f}" for x, y in zip(across.tolist(), up[:, column].tolist(), strict=True)
        )
        lines.append(
            f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.3"{_DASHES[style]} '
            f'vector-effect="non-scaling-stroke"><title>{escape(name)}</title></polyline>'
        )
    zero = _HEIGHT * curve.high / (curve.high - curve.low)
    return (
        f'<div style="font-size:11px;padding:4px 10px 0;height:{_GAP - 4:.0f}px;line-height:{_GAP - 4:.0f}px">'  # noqa: E501
        f"{escape(curve.title)}</div>"
        f'<div style="padding:0 10px"><svg viewBox="0 0 {_WIDTH:.0f} {_HEIGHT:.0f}" preserveAspectRatio="none" '  # noqa: E501
        f'style="width:100%;height:{_HEIGHT:.0f}px;display:block;border:1px solid #ddd;box-sizing:border-box">'  # noqa: E501
        f'<line x1="0" x2="{_WIDTH:.0f}" y1="{zero:.1f}" y2="{zero:.1f}" stroke="#ccc"/>{"".join(lines)}</svg></div>'  # noqa: E501
    )


def key_html(curves: tuple[Curve, ...]) -> str:
    """Return the colour key of the joints as HTML; empty if there are no diagrams."""
    names = curves[0].names if curves else ()
    swatches = (
        f'<span style="white-space:nowrap;margin-right:8px"><b style="color:{joint_style(number)[0]}">—</b> '
        f"{escape(name)}</span>"
        for number, name in enumerate(names)
    )
    return f'<div style="font-size:11px;padding:2px 10px">{"".join(swatches)}</div>' if names else ""


def instant_html(share: float) -> str:
    """Return the CSS style that places the marker of the current instant in the diagrams.

    Args:
        share: share of the time that has passed, from 0 to 1.
    """
    return f"<style>:root {{ --yarc-instant: {100.0 * share:.3f}%; }}</style>"
