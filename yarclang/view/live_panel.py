"""The controls beside the picture of a running robot: state, inputs that can be set, outputs. Clicks become
orders; nothing is drawn here.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from yarclang.coordinator.messages.replies import NamedSignal, Surroundings
from yarclang.findings import Severity
from yarclang.view import figures
from yarclang.view.panel import Give, Order
from yarclang.view.stage import Stage
from yarclang.view.switches import Switches

if TYPE_CHECKING:
    import viser


class Text:
    """A piece of HTML that is sent only when it changes."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._node = gui.add_html("", visible=False)
        self._shown = ""

    def show(self, html: str) -> None:
        """Show a text; hide it if it is empty."""
        if html != self._shown:
            self._node.content, self._node.visible = html, bool(html)
            self._shown = html


class LivePanel:
    """The controls beside the picture of a running robot.

    Args:
        gui: user interface of the page.
        stage: the scene that is drawn.
        switches: groups of the scene's bodies that can be hidden.
        give: called with orders: `input` with a name and a value, `group` with a name and True to show it.
    """

    def __init__(self, gui: viser.GuiApi, stage: Stage, switches: Switches, give: Give) -> None:
        self._gui, self._give = gui, give
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
        gui.set_panel_label("yarc view")
        self._head = Text(gui)
        self.show_head(stage)
        self._lost = Text(gui)
        self._said = Text(gui)
        self._now = Text(gui)
        self._inputs = gui.add_folder("Inputs")
        with self._inputs:
            self._fixed = Text(gui)
        with gui.add_folder("Outputs"):
            self._outputs = Text(gui)
        with gui.add_folder("Show", expand_by_default=False):
            gui.add_html(figures.key_html(stage))
            for name, text in switches.groups.items():
                box: Any = gui.add_checkbox(text, switches.is_shown(name))
                box.on_update(lambda _, name=name, box=box: give(Order("group", name, bool(box.value))))
        self._boxes: dict[str, Any] = {}
        self._stale = False

    def show_head(self, stage: Stage) -> None:
        """Show the title, the source of the messages, and notes about what can't be shown."""
        self._head.show(figures.STYLE + figures.notes_html(stage))

    def show_now(self, html: str) -> None:
        """Show the current figures."""
        self._now.show(html)

    def show_said(self, text: str) -> None:
        """Show a warning; hide it if it is empty."""
        self._said.show(figures.word_html(text, "warning") if text else "")

    def show_lost(self, text: str, severity: Severity = "error") -> None:
        """Show the reason why the current state isn't known; hide it if it is empty."""
        self._stale = bool(text)
        self._lost.show(figures.word_html(text, severity) if text else "")
        for box in self._boxes.values():
            box.disabled = box.disabled or self._stale

    def show_around(self, around: Surroundings) -> None:
        """Show the current inputs and outputs."""
        if [*self._boxes] != [one.name for one in around.inputs]:
            self._make_boxes(around)
        for one in around.inputs:
            box = self._boxes[one.name]
            is_fixed = bool(around.fixed) or self._stale
            if box.disabled != is_fixed:
                box.disabled = is_fixed
            if one.value is not None and box.value != bool(one.value):
                box.value = bool(one.value)
        none = "the cell, the program and the session declare none"
        self._fixed.show(figures.plain_html(none if not around.inputs else around.fixed))
        rows = [(one.name, f"{_value(one)} ({one.variable})") for one in around.outputs]
        self._outputs.show(figures.rows_html(rows) if rows else figures.plain_html(none))

    def _make_boxes(self, around: Surroundings) -> None:
        for old in self._boxes.values():
            old.remove()
        self._boxes = {}
        with self._inputs:
            for one in around.inputs:
                box = self._gui.add_checkbox(one.name, bool(one.value), hint=one.variable)
                box.on_update(partial(self._ticked, one.name))
                self._boxes[one.name] = box

    def _ticked(self, name: str, event: Any) -> None:
        if event.client_id is not None:  # None if this program has set the box
            self._give(Order("input", name, bool(event.target.value)))


def _value(one: NamedSignal) -> str:
    if one.value is None:
        return "not known"
    return {0.0: "OFF", 1.0: "ON"}.get(one.value, f"{one.value:g}")
