"""The labels of a picture that don't move, as viser writes them: names of bodies and frames, and findings of the command at hand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from yarclang.robot.model import Array
from yarclang.view.labels import Label, labelled, raised
from yarclang.view.stage import Mark

_TITLE = 60
"""Characters of a finding's label."""


class Lettering:
    """Labels are given one after the other, and then written all at once, so that none lies on another."""

    def __init__(self, scene: Any, marks: Sequence[Mark]) -> None:
        self._scene, self._marks = scene, marks
        self._given: list[tuple[Label, list[Any]]] = []
        self._findings: list[tuple[Label, list[int]]] = []
        self._nodes: list[tuple[list[int], Any]] = []
        self._piece, self._shown = -1, True

    def give(self, label: Label, group: list[Any]) -> None:
        """A label that is hidden and shown with a group of nodes."""
        self._given.append((label, group))

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
        for (_, group), node in zip(self._given, nodes[count:], strict=True):
            group.append(node)
        self._label()

    def follow(self, piece: int) -> None:
        """Show the findings of a command and of its neighbours; -1 for all."""
        if piece != self._piece:
            self._piece = piece
            self._label()

    def show_marks(self, is_shown: bool) -> None:
        """Show or hide the labels of findings."""
        self._shown = is_shown
        self._label()

    def _label(self) -> None:
        wanted = labelled(self._marks, self._piece)
        for numbers, node in self._nodes:
            text = self._said(number for number in numbers if number in wanted)
            if self._shown and text:
                node.text = text
            node.visible = self._shown and bool(text)

    def _said(self, numbers: Iterable[int]) -> str:
        """What a label says of findings."""
        return ", ".join(
            dict.fromkeys(self._marks[number].code or short(self._marks[number]) for number in numbers)
        )


def short(mark: Mark) -> str:
    """A finding in a few words."""
    text = mark.text if len(mark.text) <= _TITLE else f"{mark.text[: _TITLE - 1]}…"
    return f"{mark.code} {text}".strip()
