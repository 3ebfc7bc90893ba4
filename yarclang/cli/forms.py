"""Format programs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Form:
    """Result of formatting a file.

    Attributes:
        before: text of the file before.
        after: text of the file after.
        found: findings that prevent the formatting.
    """

    before: str = ""
    after: str = ""
    found: tuple[Any, ...] = ()

    @property
    def is_changed(self) -> bool:
        """True if formatting changes the file."""
        return self.before != self.after


def form_of(path: str, renumber: tuple[int, int] | None = None) -> Form:
    """Format a file. With `renumber`, its commands are numbered from the first of these numbers, in steps of
    the second.
    """
    from yarclang.pipeline.sources import read_source
    from yarclang.syntax.form import usual_form

    read = read_source(path)
    if read.value is None:
        return Form(found=read.diagnostics)
    made = usual_form(read.value, renumber)
    return Form(found=made.diagnostics) if made.value is None else Form(read.value.text, made.value)
