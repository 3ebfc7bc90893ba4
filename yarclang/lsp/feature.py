"""Features of the server. Each file in lsp/features has one value of `Feature`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Feature:
    """A feature of the language server: some methods of the protocol, with the functions that answer them.

    Attributes:
        methods: for each method, the function that answers it, and the options that the server announces. The
            function gets the server and the client's parameters.
        listens: function that is called with the server and each new analysis.
        commands: functions that the client may call by name.
    """

    methods: dict[str, tuple[Callable[..., Any], Any]]
    listens: Callable[..., None] | None = None
    commands: dict[str, Callable[..., Any]] | None = None
