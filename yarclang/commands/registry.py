"""All commands: each file of commands/builtin that has a COMMAND."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from yarclang.commands import builtin
from yarclang.commands.spec import CommandSpec
from yarclang.named import by_name


@cache
def commands() -> Mapping[str, CommandSpec]:
    """Return the commands by name, in alphabetic order.

    Raises:
        NamedTwice: two of them have one name, or one has the name that another had before.
    """
    modules = sorted(f"{builtin.__name__}.{module.name}" for module in iter_modules(builtin.__path__))
    specs: list[tuple[str, CommandSpec]] = [(name, import_module(name).COMMAND) for name in modules]
    names = [(name, place, spec) for place, spec in specs for name in (spec.name, spec.old_name) if name]
    found = by_name("command", names)
    return MappingProxyType({name: spec for name, spec in sorted(found.items()) if name == spec.name})
