"""The words of the language by kind, from the registry and the language's tables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

from yarclang.commands.registry import actions, commands
from yarclang.motion.profile import profile_names
from yarclang.semantics.names.commands import TARGETS
from yarclang.syntax.words import (
    AVOID,
    BLOCK_ENDS,
    BLOCK_HEADS,
    CONSTANTS,
    DECLARATIONS,
    FUNCTIONS,
    OPERATORS,
    OPTIONS,
    RATES,
    STATES,
)
from yarclang.units import UNITS
from yarclang.words.registry import word_specs


@dataclass(frozen=True, slots=True)
class Words:
    """The words of the language by kind, in upper case, and the units as they are written.

    Longer words come first, so that a search doesn't match only the beginning of a word.

    Attributes:
        blocks: words that begin or end a block.
        declarations: words that begin other declarations.
        commands: names of commands.
        suffixes: suffixes of commands.
        options: words that begin an option.
        operators: operators of expressions.
        functions: functions of expressions.
        constants: constants and states.
        units: units.
    """

    blocks: tuple[str, ...]
    declarations: tuple[str, ...]
    commands: tuple[str, ...]
    suffixes: tuple[str, ...]
    options: tuple[str, ...]
    operators: tuple[str, ...]
    functions: tuple[str, ...]
    constants: tuple[str, ...]
    units: tuple[str, ...]


@cache
def words() -> Words:
    """Return all words of the language, including those of commands, profiles and units that are
    registered later.
    """
    specs = commands().values()
    names = {name for spec in specs for name in (spec.name, spec.old_name) if name} | actions().keys()
    blocks = BLOCK_HEADS | BLOCK_ENDS | {"ELSE", "OF"}
    return Words(
        blocks=_ordered(blocks),
        declarations=_ordered(DECLARATIONS - blocks),
        commands=_ordered(names | {name for name, word in word_specs().items() if word.is_command}),
        suffixes=_ordered({*TARGETS, *profile_names(), AVOID}),
        options=_ordered(OPTIONS | RATES),
        operators=_ordered(OPERATORS),
        functions=_ordered(FUNCTIONS),
        constants=_ordered(CONSTANTS | STATES),
        units=_ordered(UNITS),
    )


def _ordered(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(sorted(names, key=lambda name: (-len(name), name)))
