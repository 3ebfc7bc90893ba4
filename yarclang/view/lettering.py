"""Write the labels at fixed points of the picture in viser: names of bodies and frames, and findings of the
current command.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.labels import Label, labelled, raised
from yarclang.view.stage import Mark
from yarclang.view.switches import Switches

_TITLE = 60
"""Largest number of characters in a finding's label."""


class Lettering:
    """Labels that are collected first and then written together, so that none covers another."""

    def __init__(self, scene: Any, marks: Sequence[Mark], switches: Switches) -> None:
        self._scene, self._marks, self._switches = scene, marks, switches
        self._given: list[tuple[Label, tuple[str, ...]]] = []
        self._findings: list[tuple[Label, list[int]]] = []
        self._nodes: list[tuple[list[int], Any]] = []
        self._piece = -1

    def give(self, label: Label, *groups: str) -> None:
        """Add a label that is visible as long as all of its groups are switched on."""
        self._given.append((label, groups))

    def give_marks(self, numbers: list[int], place: Array) -> None:
        """Add one label for all findings at a point of the scene."""
        self._findings.append((Label(self._said(numbers), place, 0.8, "bottom-left"), numbers))

    def write(self, eye: Array, middle: Array) -> None:
        """Write all labels for a camera at `eye` (3,) that looks at `middle` (3,) [m]."""
        # Findings come first and aren't moved; all other labels give way to them.
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
        """Show the labels of the findings of a command and of its neighbours; -1 for all commands."""
        if piece != self._piece:
            self._piece = piece
            self._label()

    def look(self) -> None:
        """Show the labels whose groups are switched on."""
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
        """Return the text of a label for findings."""
        return ", ".join(
            dict.fromkeys(self._marks[number].code or short(self._marks[number]) for number in numbers)
        )


def short(mark: Mark) -> str:
    """Return a finding in a few words."""
    text = mark.text if len(mark.text) <= _TITLE else f"{mark.text[: _TITLE - 1]}…"
    return f"{mark.code} {text}".strip()
