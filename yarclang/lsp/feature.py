"""What a feature is: one value of `Feature`, in one file of lsp/features."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Feature:
    """Some methods of the protocol: what answers each, as a function of server and parameters, and the options that are announced.

    `listens` is called with the server and each analysis that arrives. `commands` are those that the client may have carried out.
    """

    methods: dict[str, tuple[Callable[..., Any], Any]]
    listens: Callable[..., None] | None = None
    commands: dict[str, Callable[..., Any]] | None = None
