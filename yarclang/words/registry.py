"""Registry of all words that begin a line and are neither motions nor actions: the WORD of each file in
words/builtin.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from yarclang.named import by_name
from yarclang.words import builtin
from yarclang.words.spec import WordSpec


@cache
def word_specs() -> Mapping[str, WordSpec]:
    """Return the specifications of all words that begin a line and are neither motions nor actions, by name,
    in alphabetic order.

    Raises:
        NamedTwice: two words share a name.
    """
    modules = sorted(f"{builtin.__name__}.{module.name}" for module in iter_modules(builtin.__path__))
    specs: list[tuple[str, WordSpec]] = [(name, import_module(name).WORD) for name in modules]
    found = by_name("word", [(spec.name, place, spec) for place, spec in specs])
    return MappingProxyType(dict(sorted(found.items())))
