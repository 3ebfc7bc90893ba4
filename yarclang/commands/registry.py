"""Registry of all commands: the COMMAND of each file in commands/builtin."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from yarclang.commands import builtin
from yarclang.commands.spec import ActionSpec, CommandSpec
from yarclang.named import by_name


@cache
def commands() -> Mapping[str, CommandSpec]:
    """Return the motions and other commands of the language that have a `CommandSpec`, by name, in alphabetic
    order.

    Raises:
        NamedTwice: two commands share a name, or one has the old name of another.
    """
    return MappingProxyType({name: spec for name, spec in _found().items() if isinstance(spec, CommandSpec)})


@cache
def actions() -> Mapping[str, ActionSpec]:
    """Return the actions (commands without motion) by name, in alphabetic order.

    Raises:
        NamedTwice: two commands or actions share a name, or one has the old name of another.
    """
    return MappingProxyType({name: spec for name, spec in _found().items() if isinstance(spec, ActionSpec)})


@cache
def _found() -> Mapping[str, CommandSpec | ActionSpec]:
    modules = sorted(f"{builtin.__name__}.{module.name}" for module in iter_modules(builtin.__path__))
    specs: list[tuple[str, CommandSpec | ActionSpec]] = [
        (name, import_module(name).COMMAND) for name in modules
    ]
    names = [(spec.name, place, spec) for place, spec in specs]
    old = [(spec.old_name, place, spec) for place, spec in specs if isinstance(spec, CommandSpec)]
    found = by_name("command", [*names, *(one for one in old if one[0])])
    return {name: spec for name, spec in sorted(found.items()) if name == spec.name}
