"""All commands: each file of commands/builtin that has a COMMAND."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from yarclang.commands import builtin
from yarclang.commands.spec import CommandSpec


@cache
def commands() -> Mapping[str, CommandSpec]:
    """The commands by name, in alphabetic order."""
    found: dict[str, CommandSpec] = {}
    for module in sorted(iter_modules(builtin.__path__), key=lambda module: module.name):
        spec: CommandSpec = import_module(f"{builtin.__name__}.{module.name}").COMMAND
        found[spec.name] = spec
    return MappingProxyType(dict(sorted(found.items())))
