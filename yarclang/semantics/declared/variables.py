"""Check that each of the controller's variables belongs to only one signal in a program, its modules and its
cell.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from yarclang.diagnostics import Diagnostic
from yarclang.frozen import frozen
from yarclang.hir import Signal
from yarclang.semantics.names.scope import Where

Kind = Literal["input", "output"]


@frozen
class _Declared:
    kind: Kind
    name: str
    safe: float | None
    where: Where


@dataclass(slots=True)
class Signals:
    """The signals of a program, its modules and its cell: for each variable, its first declaration."""

    _first: dict[str, _Declared] = field(default_factory=dict)

    def add(self, kind: Kind, signal: Signal, safe: float | None, where: Where) -> tuple[Diagnostic, ...]:
        """Add a signal; return a finding if its variable already belongs to another signal.

        Args:
            kind: input or output.
            signal: the signal's name and variable.
            safe: the safe value of an output; None without one.
            where: place of the declaration.
        """
        new = _Declared(kind, signal.name, safe, where)
        first = self._first.setdefault(signal.variable, new)
        line = first.where.seen_from(where.source)
        if first is new or new == first:
            return ()
        if first.kind != kind:
            message = (
                f"{signal.variable} is the {first.kind} {first.name} in {line} already, and can't be an "
                f"{kind} too"
            )
            return (
                Diagnostic("Y0416", message, where.source, where.span, "correct one of the two variables"),
            )
        if first.name == signal.name and first.safe == safe:
            return ()  # a program and its module may both declare a signal
        if first.name == signal.name:
            message = (
                f"{signal.name} has two safe values: {_shown(first.safe)} in {line}, and {_shown(safe)} here"
            )
        else:
            message = f"{signal.variable} has two names: {first.name} in {line}, and {signal.name}"
        return (Diagnostic("Y0415", message, where.source, where.span, "use the same name everywhere"),)


def _shown(safe: float | None) -> str:
    return "none" if safe is None else f"{safe:g}"
