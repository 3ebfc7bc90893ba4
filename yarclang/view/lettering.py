"""The labels of a picture that don't move, as viser writes them: names of bodies and frames, and findings of the command at hand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.labels import Label, labelled, raised
from yarclang.view.stage import Mark
from yarclang.view.switches import Switches

_TITLE = 60
"""Characters of a finding's label."""


class Lettering:
    """Labels are given one after the other, and then written all at once, so that none lies on another."""

    def __init__(self, scene: Any, marks: Sequence[Mark], switches: Switches) -> None:
        self._scene, self._marks, self._switches = scene, marks, switches
        self._given: list[tuple[Label, tuple[str, ...]]] = []
        self._findings: list[tuple[Label, list[int]]] = []
        self._nodes: list[tuple[list[int], Any]] = []
        self._piece = -1

    def give(self, label: Label, *groups: str) -> None:
        """Add a label that is visible if none of some groups is switched off."""
        self._given.append((label, groups))

    def give_marks(self, numbers: list[int], place: Array) -> None:
        """The label of the findings at one spot."""
        self._findings.append((Label(self._said(numbers), place, 0.8, "bottom-left"), numbers))

    def write(self, eye: Array, middle: Array) -> None:
        """Write all that was given, as it is seen from an eye that looks at the middle (3,)."""
        # findings stay where they are; the others make room
        labels = [*(label for label, _ in self._findings), *(label for label, _ in self._given)]
        nodes = []
        for number, (label, height) in enumerate(zip(labels, raised(labels, eye, middle), strict=True)):
            nodes.append(
                self._scene.add_label(
                    f"/label_{number}",
                    label.text,
                    position=label.place + np.array([0.0, 0.0, height]),
                    font_screen_scale=label.scale,
                    anchor=label.anchor,
                )
            )
        count = len(self._findings)
        self._nodes = [
            (numbers, node) for (_, numbers), node in zip(self._findings, nodes[:count], strict=True)
        ]
        for (_, groups), node in zip(self._given, nodes[count:], strict=True):
            self._switches.add(node, *groups)
        self._label()

    def follow(self, piece: int) -> None:
        """Show the findings of a command and of its neighbours; -1 for all."""
        if piece != self._piece:
            self._piece = piece
            self._label()

    def look(self) -> None:
        """Show what the switches let be seen now."""
        self._label()

    def _label(self) -> None:
        wanted = labelled(self._marks, self._piece)
        is_shown = self._switches.is_shown("marks")
        for numbers, node in self._nodes:
            text = self._said(number for number in numbers if number in wanted)
            if is_shown and text:
                node.text = text
            node.visible = is_shown and bool(text)

    def _said(self, numbers: Iterable[int]) -> str:
        """What a label says of findings."""
        return ", ".join(
            dict.fromkeys(self._marks[number].code or short(self._marks[number]) for number in numbers)
        )


def short(mark: Mark) -> str:
    """A finding in a few words."""
    text = mark.text if len(mark.text) <= _TITLE else f"{mark.text[: _TITLE - 1]}…"
    return f"{mark.code} {text}".strip()
