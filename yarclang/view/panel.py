"""The controls beside the picture: time, lists of commands and findings, figures.

Clicks become orders; nothing is drawn here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Literal

from yarclang.view import figures
from yarclang.view.curves import curves_html, curves_of, instant_html, key_html
from yarclang.view.dragging import Draggable
from yarclang.view.listing import Listing
from yarclang.view.stage import Stage
from yarclang.view.switches import Switches

if TYPE_CHECKING:
    import viser

FACTORS = ("0.1×", "0.25×", "0.5×", "1×", "2×", "5×", "10×")
_ROWS = 10
_Shade = Literal["gray", "blue"]
_PLAIN: _Shade = "gray"
_CURRENT: _Shade = "blue"


@dataclass(frozen=True, slots=True)
class Order:
    """An order that a user has given by a click or an input in the panel.

    Attributes:
        kind: kind of the order.
        value: the subject of the order, or the new value.
        more: a second value, for orders that need one.
    """

    kind: Literal[
        "play",
        "time",
        "factor",
        "piece",
        "mark",
        "worst",
        "ramp",
        "group",
        "ray",
        "find",
        "turn",
        "input",
        "drag",
        "dragged",
    ]
    value: Any = None
    more: Any = None


Give = Callable[[Order], None]


class Rows:
    """A list shown as buttons, with a search field and two buttons for turning pages."""

    def __init__(
        self, gui: viser.GuiApi, rows: list[str], kind: Literal["piece", "mark", "worst"], give: Give
    ) -> None:
        self.listing = Listing(rows, _ROWS)
        self._kind = kind
        self._current = -1
        self._drawn: list[tuple[str, bool, _Shade]] = []
        self._buttons: list[Any] = []
        if len(rows) > _ROWS:
            find: Any = gui.add_text("Find", "")

            find.on_update(lambda _: give(Order("find", kind, find.value)))

        for place in range(min(_ROWS, len(rows))):
            button: Any = gui.add_button(" ", color=_PLAIN)
            self._buttons.append(button)
            self._drawn.append((" ", True, _PLAIN))

            button.on_click(partial(self._pressed, place, give))

        self._where: Any = None
        if len(rows) > _ROWS:
            self._where = gui.add_html("")
            pages: Any = gui.add_button_group(" ", ("earlier", "later"))

            pages.on_click(lambda _: give(Order("turn", kind, -1 if pages.value == "earlier" else 1)))
        self.draw()

    def _pressed(self, place: int, give: Give, _: Any) -> None:
        shown = self.listing.shown
        if place < len(shown):
            give(Order(self._kind, shown[place]))

    def choose(self, number: int) -> None:
        """Turn to the page with a row, and highlight the row."""
        if number == self._current:
            return
        self._current = number
        if not self.listing.word:
            self.listing.follow(number)
        self.draw()

    def draw(self) -> None:
        """Send all changes to the browser."""
        shown = self.listing.shown
        for place, button in enumerate(self._buttons):
            number = shown[place] if place < len(shown) else -1
            text = self.listing.rows[number] if number >= 0 else " "
            wanted: tuple[str, bool, _Shade] = (
                text,
                number >= 0,
                _CURRENT if number == self._current and number >= 0 else _PLAIN,
            )
            if wanted != self._drawn[place]:
                button.label, button.visible, button.color = wanted
                self._drawn[place] = wanted
        if self._where is not None:
            first = self.listing.page * _ROWS + 1
            count = len(self.listing.chosen)
            what = (
                f"{first:,} to {first + len(shown) - 1:,} of {count:,}"
                if count
                else "none contains this text"
            )
            self._where.content = f'<div style="font-size:12px;padding:0 10px;color:#777">{what}</div>'


class Panel:
    """The controls beside the picture of a scene."""

    def __init__(
        self, gui: viser.GuiApi, stage: Stage, switches: Switches, ramps: dict[str, str], give: Give
    ) -> None:
        self._gui, self._stage = gui, stage
        self._shown_time = -1.0
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
        gui.set_panel_label("yarc view")
        gui.add_html(figures.STYLE + figures.notes_html(stage) + figures.robots_html(stage))
        self._play = gui.add_button("Play", color="blue", disabled=stage.duration <= 0.0)
        most = max(math.ceil(stage.duration * 1e3) / 1e3, 1e-3)
        self._slider: Any = gui.add_slider("Time [s]", 0.0, most, _step(stage.duration), 0.0)
        factor: Any = gui.add_dropdown("Speed", FACTORS, initial_value="1×")
        self._play.on_click(lambda _: give(Order("play")))
        self._slider.on_update(partial(self._slid, give))
        factor.on_update(lambda _: give(Order("factor", float(factor.value.rstrip("×")))))

        if ramps:
            ramp: Any = gui.add_dropdown(
                "Colour by", tuple(ramps.values()), initial_value=next(iter(ramps.values()))
            )
            by_text = {text: name for name, text in ramps.items()}
            ramp.on_update(lambda _: give(Order("ramp", by_text[ramp.value])))

        self._legend = gui.add_html("")
        self._now = gui.add_html("")
        tabs = gui.add_tab_group()
        with tabs.add_tab("Commands"):
            self._piece = gui.add_html("")
            rows = [
                f"{piece.begins:8.2f} s  {piece.title}{'' if piece.planned else '  (not planned)'}"
                for piece in stage.pieces
            ]
            self.pieces = Rows(gui, rows, "piece", give)
        with tabs.add_tab(f"Findings ({len(stage.marks)})"):
            self._mark = gui.add_html("" if stage.marks else _NONE)
            rows = [f"{mark.code} {self._whose(mark.piece)}{mark.text}".strip() for mark in stage.marks]
            self.marks = Rows(gui, rows, "mark", give)
        if stage.worst:
            with tabs.add_tab("Worst"):
                gui.add_html(_NEAREST)
                Rows(gui, [one.text for one in stage.worst], "worst", give)
        curves = curves_of(stage)
        self._instant: Any = None
        if curves:
            with tabs.add_tab("Curves"):
                gui.add_html(key_html(curves))
                gui.add_html(curves_html(curves))
                self._instant = gui.add_html(instant_html(0.0))
        self._line: Any = None
        if stage.draggable:
            with tabs.add_tab("Frames"):
                self._offer_frames(give)
        with tabs.add_tab("Show"):
            gui.add_html(figures.key_html(stage))
            for name, text in switches.groups.items():
                box: Any = gui.add_checkbox(text, switches.is_shown(name))
                box.on_update(lambda _, name=name, box=box: give(Order("group", name, bool(box.value))))

    def _offer_frames(self, give: Give) -> None:
        """Add a menu with the frames that can be dragged, and a field for the line that declares the dragged
        frame.
        """
        gui = self._gui
        gui.add_html(_DRAG)
        texts = [f"{{{one.name}}} in {{{one.parent}}}{_where(one)}" for one in self._stage.draggable]
        chosen: Any = gui.add_dropdown("Frame", (_NOTHING, *texts), initial_value=_NOTHING)
        chosen.on_update(
            lambda _: give(Order("drag", texts.index(chosen.value) if chosen.value != _NOTHING else -1))
        )
        self._line = gui.add_text("Line", "", multiline=True)

    def show_line(self, text: str) -> None:
        """Show the line that declares the dragged frame; empty if no frame is dragged."""
        if self._line is not None and self._line.value != text:
            self._line.value = text

    def _show_instant(self, time: float) -> None:
        """Move the marker of the curves to a time [s]."""
        if self._instant is not None:
            self._instant.content = instant_html(min(time / self._stage.duration, 1.0))

    def _slid(self, give: Give, event: Any) -> None:
        if event.client_id is not None:  # None if this program has moved the slider
            give(Order("time", float(self._slider.value)))

    def _whose(self, piece: int) -> str:
        return (
            f"{self._stage.pieces[piece].label}: " if piece >= 0 and self._stage.pieces[piece].label else ""
        )

    def show_time(self, time: float) -> None:
        """Move the slider to a time [s]."""
        if time != self._shown_time:
            self._shown_time = time
            self._show_instant(time)
            self._slider.value = round(time, 3)

    def show_playing(self, plays: bool) -> None:
        """Label the button with the action that it will have: start or stop."""
        label = "Pause" if plays else "Play"
        if self._play.label != label:
            self._play.label = label

    def show_now(self, html: str) -> None:
        """Show the figures of the current instant."""
        self._now.content = html

    def show_legend(self, html: str) -> None:
        """Show the meaning of the path's colours."""
        self._legend.content = html

    def show_piece(self, number: int) -> None:
        """Show the figures of a command; for -1 show none."""
        self.pieces.choose(number)
        self._piece.content = figures.piece_html(self._stage.pieces[number]) if number >= 0 else ""

    def show_mark(self, number: int) -> None:
        """Show the text of a finding."""
        self.marks.choose(number)
        self._mark.content = figures.mark_html(self._stage.marks[number])


def _where(one: Draggable) -> str:
    """Return the file and the line that declare a frame."""
    return f", {PurePath(one.source).name}:{one.line}" if one.source else ", a new frame"


_NOTHING = "none"
_DRAG = (
    '<div style="font-size:12px;padding:2px 10px">Choose a frame, drag it by its arrows, rings and '
    "squares, and copy its line. No file is changed. A frame on the robot moves with the robot.</div>"
)
_NEAREST = '<div style="font-size:12px;padding:2px 10px">The places nearest to a limit, nearest first.</div>'
_NONE = '<div style="font-size:12px;padding:2px 10px">There are no findings.</div>'


def _step(duration: float) -> float:
    """Return a step of the slider [s] that is small enough for stopping at any instant."""
    return 0.001 if duration < 600.0 else 0.01
