"""Format the texts beside the picture as HTML: the robot's state at an instant, the facts of a command and of
a finding, and the colour legend.
"""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

import numpy as np

from yarclang.collision.scene import Scene
from yarclang.findings import Severity
from yarclang.report.clearance import SEEN, Near
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM
from yarclang.view import colours
from yarclang.view.rules import MOST_SHOWN
from yarclang.view.stage import Colour, Mark, Piece, Stage
from yarclang.view.track import followed

_TABLE = '<table style="font-size:12px;border-spacing:8px 0;margin:2px 0;width:100%">{}</table>'
_BLOCK = '<div style="font-size:12px;padding:2px 10px;line-height:1.45;overflow-wrap:anywhere">{}</div>'

STYLE = """<style>
.mantine-Button-root { height: auto; min-height: 1.9rem; padding-block: 0.25rem; }
.mantine-Button-label { white-space: normal; overflow: visible; overflow-wrap: anywhere; text-align: left; line-height: 1.3; height: auto; }
[data-dock-tab] { padding-inline: 0.45em !important; }
.mantine-Tabs-panel .mantine-Button-inner { justify-content: flex-start; }
</style>"""  # noqa: E501
"""Style of buttons and tabs. viser cuts off text that doesn't fit on a line; with this style, buttons show
their whole text, and tabs fit on one line.
"""


def instant_html(stage: Stage, time: float, nearest: str | None) -> str:
    """Return the robot's state at a time as HTML: the joints, and the pose in {B} and the speed of the frame
    whose path is drawn.

    Args:
        stage: the scene that is drawn.
        time: [s].
        nearest: text about the bodies that are nearest to each other; None for none.
    """
    times = np.array([time])
    q, v = stage.track.at(times)
    robot = stage.robot
    rows = stand_rows(stage, q[0])
    speed = float(followed(robot.chain, q, v, stage.flange_from_frame)[1][0])
    rows.append(("speed", f"{speed / MM:.1f} mm/s"))
    if nearest is not None:
        rows.append(("nearest bodies", nearest))
    rows += rule_rows(stage, time, q[0])
    if stage.ghost is not None:
        wanted = stage.ghost.at(times)[0]
        there = tool_poses(robot.chain, np.vstack([q, wanted]), stage.flange_from_frame)[:, :3, 3]
        rows.append(("off the plan", f"{float(np.linalg.norm(there[0] - there[1])) / MM:.2f} mm"))
        worst = int(np.argmax(np.abs(q[0] - wanted[0]) / robot.axis_units))
        off = float((q[0] - wanted[0])[worst] / robot.axis_units[worst])
        rows.append(("worst joint", f"{robot.joint_names[worst]} {off:+.3f} {robot.axis_unit_names[worst]}"))
    return rows_html(rows)


def stand_rows(stage: Stage, q: Array) -> list[tuple[str, str]]:
    """Return table rows with joint positions (n,) [rad or m], and with the pose in {B} of the frame whose
    path is drawn.
    """
    robot = stage.robot
    joints = _values(
        zip(robot.joint_names, (q / robot.axis_units).tolist(), robot.axis_unit_names, strict=True)
    )
    return [("joints", joints), (f"{{{stage.frame}}} in {{B}}", _pose(stage, q[None]))]


def rule_rows(stage: Stage, time: float, q: Array) -> list[tuple[str, str]]:
    """Return table rows with the path constraints (KEEP rules) that are in force at a time [s], and their
    angles and distances at joint positions (n,).
    """
    holds = stage.rules.at(time)
    rows = []
    for number in holds[:MOST_SHOWN]:
        rule = stage.rules.shown[number]
        now = rule.at(stage.robot, q)
        broken = "" if now.is_kept else ", BROKEN"
        rows.append(("keeps to", f"{rule.keep.words}: {now.figures}{broken}"))
    if len(holds) > MOST_SHOWN:
        rows.append(("keeps to", f"{len(holds) - MOST_SHOWN} more rules"))
    return rows


def _pose(stage: Stage, q: Array) -> str:
    pose = tool_poses(stage.robot.chain, q, stage.flange_from_frame)[0]
    place = " ".join(f"{value:.1f}" for value in (pose[:3, 3] / MM).round(1) + 0.0)
    turn = " ".join(f"{value:.1f}" for value in (roll_pitch_yaw(pose[:3, :3]) / DEG).round(1) + 0.0)
    return f"{place} mm, {turn} deg"


def _values(named: Iterable[tuple[str, float, str]]) -> str:
    rounded = [(name, round(value, 2) + 0.0, unit) for name, value, unit in named]
    units = {unit for _, _, unit in rounded}
    if len(units) == 1:
        return " ".join(f"{value:.2f}" for _, value, _ in rounded) + f" {units.pop()}"
    return " ".join(f"{value:.2f} {unit}" for _, value, unit in rounded)


def near_text(scene: Scene | None, found: Near) -> str:
    """Return a text with the distance of the two nearest bodies at the current joint positions."""
    pair = int(found.pair[0])
    if scene is None or pair < 0:
        return f"over {SEEN / MM:.0f} mm"
    first, second = scene.names(pair)
    return f"{float(found.apart[0]) / MM:.1f} mm ({first}, {second})"


def piece_html(piece: Piece) -> str:
    """Return the facts of a command as HTML."""
    when = (
        f"{piece.begins:.3f} to {piece.ends:.3f} s" if piece.ends > piece.begins else f"{piece.begins:.3f} s"
    )
    where = f" · line {piece.line}" if piece.line else ""
    head = f'<b data-piece="{escape(piece.label)}">{escape(piece.title)}</b>{where}'
    return _BLOCK.format(head) + rows_html([("from, to", when), *piece.facts])


def plain_html(text: str) -> str:
    """Return a text as a line of HTML; empty for an empty text."""
    return _BLOCK.format(escape(text)) if text else ""


def word_html(text: str, severity: Severity) -> str:
    """Return a text as a line of HTML in the colour of findings."""
    return _BLOCK.format(f'<b style="color:{_css(colours.SEVERITIES[severity])}">{escape(text)}</b>')


def mark_html(mark: Mark) -> str:
    """Return a finding with its remedy as HTML."""
    colour = _css(colours.SEVERITIES[mark.severity])
    code = f"{escape(mark.severity)} {escape(mark.code)}" if mark.code else escape(mark.severity)
    text = f'<b style="color:{colour}" data-mark="{escape(mark.code)}">{code}</b>: {escape(mark.text)}'
    remedy = f"<br><i>{escape(mark.remedy)}</i>" if mark.remedy else ""
    return _BLOCK.format(text + remedy)


def legend_html(ramp: str, most: float, unit: str, what: str, *, is_capped: bool = False) -> str:
    """Return a colour ramp as HTML, with the values at its ends. With `is_capped`, the upper end is marked:
    values may exceed it.
    """
    anchors = colours.RAMPS[ramp]
    stops = ", ".join(f"{_css(one)} {100.0 * at / (len(anchors) - 1):.0f}%" for at, one in enumerate(anchors))
    bar = f'<div style="height:12px;border-radius:3px;background:linear-gradient(90deg, {stops})"></div>'
    middle = f"{most / 2.0:g}"
    most_text = f"{'≥ ' * is_capped}{most:g} {unit}"
    ends = f"<span>0</span><span>{middle}</span><span>{most_text}</span>"
    scale = f'<div style="display:flex;justify-content:space-between">{ends}</div>'
    return _BLOCK.format(f"{escape(what)}{bar}{scale}")


def notes_html(stage: Stage) -> str:
    """Return notes about the picture's contents, and about what it leaves out, as HTML."""
    notes = "".join(f"<br>{escape(note)}" for note in stage.notes)
    return _BLOCK.format(f"<b>{escape(stage.title)}</b><br>{escape(stage.subtitle)}{notes}")


def robots_html(stage: Stage) -> str:
    """Return a text that distinguishes the actual and the planned robot in the picture of a run; empty for
    other scenes.
    """
    if stage.ghost is None:
        return ""
    planned = "planned robot (transparent) and planned path (thin)"
    actual = "actual robot in its own colours, and its path in the colours of the scale"
    return _BLOCK.format("<br>".join([_swatch(colours.GHOST, planned), _swatch(colours.JOINT_BODY, actual)]))


def key_html(stage: Stage) -> str:
    """Return the meaning of all colours except those of the path, as HTML."""
    kinds = {item.kind for item in stage.items}
    entries: list[tuple[Colour, str]] = []
    if stage.ghost is not None:
        entries.append((colours.GHOST, "planned robot and path"))
    if stage.scene is not None:
        entries.append((colours.TOUCHING, "bodies that touch, or are within their margin"))
    if "tool" in kinds:
        entries.append((colours.TOOL, "what the robot carries"))
    if "part" in kinds:
        entries.append((colours.PART, "parts; transparent if its presence isn't certain"))
    if "obstacle" in kinds:
        entries.append((colours.OBSTACLE, "obstacles"))
    shown = {item.colour for item in stage.items if item.kind == "zone"}
    entries += [(colour, f"zone: {rule}") for rule, colour in colours.ZONES.items() if colour in shown]
    if stage.rules.held:
        entries.append((colours.ZONES["allowed"], "rules of KEEP that hold; red where one is broken"))
    severities = dict.fromkeys(mark.severity for mark in stage.marks if mark.place is not None)
    entries += [(colours.SEVERITIES[one], f"{one} on the path") for one in severities]
    return _BLOCK.format("<br>".join(_swatch(colour, text) for colour, text in entries))


def _swatch(colour: Colour, text: str) -> str:
    square = "display:inline-block;width:10px;height:10px;border-radius:2px;margin-right:6px"
    return f'<span style="{square};background:{_css(colour)}"></span>{escape(text)}'


def rows_html(rows: Iterable[tuple[str, str]]) -> str:
    """Return names and values as a table of HTML."""
    cells = (
        (
            "<tr><td "
            f'style="color:#777;white-space:nowrap;vertical-align:top">{escape(name)}</td><td>{escape(value)}</td></tr>'
        )
        for name, value in rows
    )
    return _TABLE.format("".join(cells))


def _css(colour: Colour) -> str:
    return f"rgb({colour[0]},{colour[1]},{colour[2]})"
