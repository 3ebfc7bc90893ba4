"""Show the places of the cell's parts, and set them."""

from __future__ import annotations

import re

import numpy as np

from yarclang.coordinator.messages import orders, replies
from yarclang.coordinator.messages.findings import findings_of
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM

_PUT = re.compile(r"(?P<part>.+?)\s+\{(?P<frame>[^{}]+)\}(?P<values>.*)")
_VALUES = 6


async def _parts(session: Session, rest: str) -> None:
    word, _, behind = rest.strip().partition(" ")
    part = " ".join(behind.upper().split())
    match word.lower():
        case "":
            order: orders.AskParts | orders.PlacePart = orders.AskParts()
        case "reset":
            order = orders.PlacePart(part=part or None, at="file")
        case "gone" if part:
            order = orders.PlacePart(part=part, at="gone")
        case "put" if part:
            order = _put(part)
        case _:
            raise Misused(f"{rest.strip()} says nothing about parts")
    changes = isinstance(order, orders.PlacePart)
    if changes and session.asks and not await session.agrees("are the parts really there?"):
        session.say("nothing has changed")
        return
    told = await session.attached.ask(order)
    session.show(findings_of(told.findings))
    for line in _lines(told):
        session.say(line)


def _put(text: str) -> orders.PlacePart:
    found = _PUT.fullmatch(text)
    if found is None:
        raise Misused("a part and a frame are needed: .parts put BOX {FEEDER}")
    try:
        values = [float(one) for one in found["values"].split()]
    except ValueError:
        raise Misused(f"{found['values'].strip()} aren't numbers") from None
    if len(values) not in (0, _VALUES):
        raise Misused("six values are needed: X Y Z (mm), roll, pitch, yaw (deg)")
    pose = tuple(values or [0.0] * _VALUES)
    return orders.PlacePart(part=found["part"].strip(), at="frame", frame=f"{{{found['frame']}}}", pose=pose)


def _lines(told: replies.Parts) -> list[str]:
    lines = []
    for one in told.parts:
        pose = np.array(one.pose)
        values = (*(pose[:3, 3] / MM), *(roll_pitch_yaw(pose[:3, :3]) / DEG))
        where = " ".join(f"{value + 0.0:.4g}" for value in np.round(values, 2))
        if one.held is None:
            place = f"{'lies' if one.sure else 'may lie'} at {where} {{B}}"
        else:
            holds = f"{one.held} holds it" if one.held else "it is fixed to the flange"
            place = f"{holds if one.sure else f'perhaps {holds}'}, at {where} {{FLANGE}}"
        lines.append(f"{one.name}: {place}")
    if told.doubt:
        lines.append(
            f"the places of the parts aren't certain: {told.doubt}; confirm them by .parts reset or .parts "
            "put"
        )
    elif not told.parts and not told.findings:
        lines.append("no part is left in the cell")
    elif not told.moved and not told.findings:
        lines.append("at their places in the cell's file")
    return lines


COMMANDS = (
    DotCommand(
        ".parts",
        "[reset | put | gone ...]",
        "show or set the places of the cell's parts",
        "teaching",
        _parts,
        complete=lambda _, begun: (one for one in ("gone", "put", "reset") if one.startswith(begun.lower())),
        doc="Without more, each part: its place (mm, deg), and what holds it. `reset [PART]` sets all "
        "parts, or one, to their places in the cell's file; `put BOX {TABLE} 100 0 0 0 0 90` that a "
        "part lies at that place in a frame (mm; roll, pitch, yaw in deg; without values at its "
        "origin), and with the frame of a gripper that the gripper holds it; `gone BOX` that it was "
        "taken out of the cell. The next commands are planned and proved with these places. Nothing "
        "moves, and no output is set. The sensors of a simulated robot detect the parts at these "
        "places.",
    ),
)
