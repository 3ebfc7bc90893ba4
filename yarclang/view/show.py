"""Show a scene in a browser: process orders, advance the time, and update the picture."""

from __future__ import annotations

import contextlib
import queue
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.report.clearance import SEEN, near, touching
from yarclang.robot.model import Array
from yarclang.units import MM
from yarclang.view import colours, figures
from yarclang.view.clearance import apart_over
from yarclang.view.door import Door, opened
from yarclang.view.panel import Order, Panel
from yarclang.view.picking import ANGLE, beside, picked_time
from yarclang.view.picture import Picture
from yarclang.view.player import Player
from yarclang.view.stage import Stage

if TYPE_CHECKING:
    import viser

_RATE = 30.0
"""Number of pictures per second while time runs."""
_TEXT_RATE = 8.0
"""Number of updates of figures and slider per second."""
_MOST_CLEARANCES = 3_000
"""Largest number of path points at which clearances are computed. Values at other points are interpolated."""
_PASSES = 20.0
"""Longest wait for an order [s]. It is limited so that an interrupt is noticed."""


def show(stage: Stage, door: Door, ready: Callable[[Door], None]) -> None:
    """Serve the picture of a scene until it is interrupted (KeyboardInterrupt).

    Args:
        stage: the scene.
        door: address at which the picture is served; port 0 means any free port.
        ready: called with the actual address when the server listens.

    Raises:
        PortTakenError: the port is in use, or the address doesn't belong to this machine.
    """
    with opened(door) as server:
        showing = _Showing(server, stage)
        ready(Door(door.host, server.get_port()))
        showing.run()


class _Showing:
    """The picture that is shown. Only the thread of `run` draws; viser's threads only add orders."""

    def __init__(self, server: viser.ViserServer, stage: Stage) -> None:
        self._stage = stage
        self._orders: queue.SimpleQueue[Order] = queue.SimpleQueue()
        self._player = Player(stage.duration)
        self._values: dict[str, Array] = {"speed": stage.way.speed / MM}
        self._ramps = ramps_of(stage)
        self._piece = -2
        self._dragged = -1
        self._picture = Picture(server, stage)
        self._panel = Panel(server.gui, stage, self._picture.switches, self._ramps, self._orders.put)
        self._lists = {"piece": self._panel.pieces, "mark": self._panel.marks}

        @server.scene.on_click()
        def _(event: Any) -> None:
            self._orders.put(Order("ray", np.array(event.ray_origin), np.array(event.ray_direction)))

        if self._ramps:
            self._colour(next(iter(self._ramps)))
        self._follow(figures_too=True)

    def run(self) -> None:
        """Process orders and advance the time, without end."""
        last = written = time.monotonic()
        while True:
            due = last + 1.0 / _RATE - time.monotonic() if self._player.plays else _PASSES
            with contextlib.suppress(queue.Empty):
                order = self._orders.get(timeout=due) if due > 0.0 else self._orders.get_nowait()
                self._carry_out(order)
                continue
            now = time.monotonic()
            if self._player.pass_by(now - last):
                texts = now - written >= 1.0 / _TEXT_RATE or not self._player.plays
                written = now if texts else written
                self._follow(figures_too=texts)
            last = now

    def _carry_out(self, order: Order) -> None:
        match order.kind:
            case "play":
                self._player.press()
                self._follow(figures_too=True)
            case "time":
                self._jump(order.value)
            case "factor":
                self._player.factor = order.value
            case "piece":
                self._jump(self._stage.pieces[order.value].begins)
                self._choose(order.value)
            case "mark":
                self._choose_mark(order.value)
            case "worst":
                piece = self._stage.worst[order.value].piece
                self._jump((self._stage.pieces[piece].begins + self._stage.pieces[piece].ends) / 2.0)
                self._choose(piece)
            case "ramp":
                self._colour(order.value)
            case "group":
                self._picture.show_group(order.value, order.more)
            case "ray":
                self._pick(order.value, order.more)
            case "find":
                self._lists[order.value].listing.choose(order.more)
                self._lists[order.value].draw()
            case "drag":
                self._drag(order.value)
            case "dragged":
                self._tell_dragged(order.value, order.more)
            case "turn":
                self._lists[order.value].listing.turn(order.more)
                self._lists[order.value].draw()

    def _drag(self, number: int) -> None:
        """Show the handles of a frame that the user can drag; for -1 show none."""
        self._dragged = number
        self._picture.drag(number, lambda position, wxyz: self._orders.put(Order("dragged", position, wxyz)))
        one = self._stage.draggable[number] if number >= 0 else None
        self._panel.show_line("" if one is None else one.declaration(one.parent_from_frame))

    def _tell_dragged(self, position: Array, wxyz: Array) -> None:
        if self._dragged >= 0:
            one = self._stage.draggable[self._dragged]
            self._panel.show_line(one.declaration(one.moved_to(position, wxyz)))

    def _jump(self, to: float) -> None:
        self._player.plays = False
        self._player.jump(to)
        self._follow(figures_too=True)

    def _choose(self, piece: int) -> None:
        self._piece = piece
        self._picture.choose_piece(piece)
        self._panel.show_piece(piece)

    def _choose_mark(self, number: int) -> None:
        mark = self._stage.marks[number]
        if mark.time is not None:
            self._jump(mark.time)
        if mark.piece >= 0:
            self._choose(mark.piece)
        self._picture.choose_mark(number)
        self._panel.show_mark(number)

    def _pick(self, eye: Array, direction: Array) -> None:
        placed = [number for number, mark in enumerate(self._stage.marks) if mark.place is not None]
        places = np.array([self._stage.marks[number].place for number in placed]).reshape(-1, 3)
        found, angle = beside(places, eye, direction)
        if found >= 0 and angle <= ANGLE:
            self._choose_mark(placed[found])
            return
        when = picked_time(self._stage.way, eye, direction)
        if when is not None:
            self._jump(when)

    def _colour(self, ramp: str) -> None:
        if ramp not in self._values:
            self._values[ramp] = values_of(self._stage, ramp)
        values = self._values[ramp]
        is_clearance = ramp == "clearance"
        most = SEEN / MM if is_clearance else colours.round_up(float(values.max(initial=0.0)))
        unit = "mm/s" if ramp == "speed" else "mm"
        self._picture.colour_way(values, most, ramp)
        text = f"path of {{{self._stage.frame}}}: {self._ramps[ramp]}"
        self._panel.show_legend(figures.legend_html(ramp, most, unit, text, is_capped=is_clearance))

    def _follow(self, *, figures_too: bool) -> None:
        now, stage = self._player.time, self._stage
        self._picture.move_to(now)
        if not figures_too:
            return
        q = stage.track.at(np.array([now]))[0]
        scene = stage.scene_at(now)
        if scene is not None:
            self._picture.colour_bodies(touching(scene, q[0]))
        self._panel.show_time(now)
        self._panel.show_playing(self._player.plays)
        nearest = figures.near_text(scene, near(scene, q)) if scene is not None else None
        self._panel.show_now(figures.instant_html(stage, now, nearest))
        piece = stage.piece_at(now)
        if piece != self._piece:
            self._choose(piece)


def ramps_of(stage: Stage) -> dict[str, str]:
    """Return the quantities that can colour the path, with their names for people."""
    if len(stage.way.points) < 2:
        return {}
    ramps = {"speed": "speed"}
    if stage.ghost is not None:
        ramps["deviation"] = "distance from the plan"
    if stage.scene is not None:
        ramps["clearance"] = "smallest distance of two bodies (samples)"
    return ramps


def values_of(stage: Stage, ramp: str) -> Array:
    """Return the values that colour the path, (N,) [mm], one for each point of the path."""
    times = stage.way.times
    if ramp == "deviation":
        assert stage.ghost is not None  # offered only with a ghost
        from yarclang.view.track import followed

        q, v = stage.ghost.at(times)
        there = followed(stage.robot.chain, q, v, stage.flange_from_frame)[0]
        away: Array = np.linalg.norm(stage.way.points - there, axis=1) / MM
        return away
    every = max(-(-len(times) // _MOST_CLEARANCES), 1)
    chosen = np.unique(np.append(np.arange(0, len(times), every), len(times) - 1))
    apart = apart_over(stage, times[chosen]) / MM
    values: Array = np.interp(np.arange(len(times)), chosen, apart)
    return np.maximum(values, 0.0)
