"""The page of a running robot: the picture and the panel beside it. Only changes are sent to the browser.
This module reads no clock.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from yarclang.cell.model import Parts
from yarclang.coordinator.messages.replies import Surroundings
from yarclang.report.clearance import touching
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.view.live_panel import LivePanel
from yarclang.view.live_parts import LiveParts
from yarclang.view.of_live import Live, stage_of_live
from yarclang.view.panel import Give, Order
from yarclang.view.parts import standing_parts
from yarclang.view.picture import Picture
from yarclang.view.reaching import Place
from yarclang.view.stage import Stage
from yarclang.view.switches import OFF_AT_FIRST

if TYPE_CHECKING:
    import viser

_STILL = 1e-5
"""If no joint has moved by more than this, the robot isn't moved in the picture [rad or m]."""
_TEXT_EACH = 5
"""The figures are updated with every `_TEXT_EACH`-th picture."""


class LivePage:
    """The page of a running robot: the picture and the panel beside it.

    Args:
        server: web server of the page.
        give: function that is called with each order of a user, such as a click.
    """

    _stage: Stage
    _picture: Picture
    _panel: LivePanel

    def __init__(self, server: viser.ViserServer, give: Give) -> None:
        self._server, self._give = server, give
        self._place: Place | None = None
        self._live: Live | None = None
        self._lost = ""
        self._drawn: Array | None = None
        self._parts: Parts | None = None
        self._count = 0
        self._around: Surroundings | None = None
        self._changed = ""

    def attach(self, live: Live, place: Place, subtitle: str) -> None:
        """Show a robot. If the robot or its cell has changed, build a new picture."""
        before, self._live = self._place, live
        if place.cell is not None and place.cell.parts:
            live.parts = LiveParts(place.robot, place.cell)
        else:
            live.parts = None
        if before is not None and before.is_as(place):
            self._stage = replace(self._stage, subtitle=subtitle)
            self._panel.show_head(self._stage)
            self._show_lost("")
            return
        if before is not None and before.robot.fingerprint != place.robot.fingerprint:
            self._changed = _other(before, place)
        self._place = place
        q = place.robot.home if live.joints is None else live.joints
        notes = (*place.notes, *([self._changed] if self._changed else []))
        stage = stage_of_live(place.robot, place.cell, q, subtitle=subtitle)
        self._stage = replace(stage, notes=(*notes, *stage.notes))
        hidden = self._picture.switches.hidden if before is not None else OFF_AT_FIRST
        with self._server.atomic():
            self._server.scene.reset()
            self._server.gui.reset()
            self._picture = Picture(self._server, self._stage, hidden)
            self._panel = LivePanel(self._server.gui, self._stage, self._picture.switches, self._give)
        self._picture.move_to(0.0)
        self._lost, self._drawn, self._count = "", None, 0
        self._parts = None
        if self._around is not None:
            self._panel.show_around(self._around)

    def show_around(self, around: Surroundings) -> None:
        """Show the current inputs and outputs of the robot."""
        self._around = around
        self._panel.show_around(around)

    def draw(self, lost: str = "") -> None:
        """Draw the changes since the last call.

        Args:
            lost: reason why the robot's current state isn't known; empty if it is known.
        """
        live = self._live
        assert live is not None  # a robot is attached before anything is drawn
        self._show_lost(lost or live.stale)
        q = live.joints
        moved = q is not None and (self._drawn is None or bool(np.abs(q - self._drawn).max() > _STILL))
        if q is not None and moved:
            self._picture.stand_at(q)
            self._drawn = q
        if live.parts is not None and live.parts.parts is not self._parts and not self._lost:
            self._parts = live.parts.parts
            self._picture.show_parts(standing_parts(live.robot, self._parts)[0])
        self._count = (self._count + 1) % _TEXT_EACH
        if self._count != 1:
            return
        stands = self._drawn if self._drawn is not None else self._stage.robot.home
        self._panel.show_said(live.said)
        self._panel.show_now(live.html(self._stage, stands))
        if self._stage.scene is not None and not self._lost:
            self._picture.colour_bodies(touching(self._stage.scene, stands))

    def lose(self, why: str) -> None:
        """Report that no coordinator serves the robot, and draw the robot grey."""
        self._show_lost(why)

    def take(self, order: Order) -> None:
        """Execute a user's order about the picture. An order to set an input is ignored if no coordinator
        serves the robot.
        """
        if order.kind == "group":
            self._picture.show_group(order.value, order.more)
        elif order.kind == "input" and self._around is not None:
            self._panel.show_around(self._around)

    def refuse(self, name: str, trouble: Trouble) -> None:
        """Show the reason why an input wasn't set."""
        code = f" ({trouble.code})" if trouble.code else ""
        if self._live is not None:
            self._live.said = f"{name} isn't set: {trouble.what}{code}"
        if self._around is not None:
            self._panel.show_around(self._around)

    def _show_lost(self, why: str) -> None:
        if why == self._lost:
            return
        if bool(why) != bool(self._lost):
            self._picture.fade("not connected" if why else "")
        self._lost = why
        self._panel.show_lost(f"not connected: {why}" if why else "")
        if not why and self._around is not None:
            self._panel.show_around(self._around)


def _other(before: Place, now: Place) -> str:
    old, new = before.robot, now.robot
    if (old.name, old.size) == (new.name, new.size):
        return f"{new.name} has a new description since this page was opened"
    return (
        f"another robot is served here now: {new.name} with {new.size} joints, not {old.name} with {old.size}"
    )
