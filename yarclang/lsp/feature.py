"""What a feature is: one value of `Feature`, in one file of lsp/features."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from yarclang.lsp.server import Server


@dataclass(frozen=True, slots=True)
class Feature:
    """Some methods of the protocol: what answers each, as a function of server and parameters, and the options that are announced.

    `listens` is called with the server and each analysis that arrives. `commands` are those that the client may have carried out.
    """

    methods: dict[str, tuple[Callable[..., Any], Any]]
    listens: Callable[..., None] | None = None
    commands: dict[str, Callable[..., Any]] | None = None

    def register(self, server: Server) -> None:
        """Make the server answer."""
        for method, (answer, options) in self.methods.items():
            server.feature(method, options)(_with_server(server, answer))
        for name, command in (self.commands or {}).items():
            server.command(name)(_with_server(server, command))
        if self.listens is not None:
            server.listeners.append(self.listens)


def _with_server(server: Server, answer: Callable[..., Any]) -> Callable[..., Any]:
    """A function of the parameters alone. It keeps whether it is to be awaited: the library looks at that."""
    from inspect import iscoroutinefunction

    async def awaited(*params: Any) -> Any:
        return await answer(server, *params)

    def called(*params: Any) -> Any:
        return answer(server, *params)

    return awaited if iscoroutinefunction(answer) else called
