"""Resolve the names of commands, and replace outdated names by the current ones."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from yarclang.commands.registry import actions, commands
from yarclang.commands.spec import CommandSpec, Values
from yarclang.diagnostics import Collector, Edit, Fix
from yarclang.frozen import frozen
from yarclang.progress import each
from yarclang.semantics.names.foreign import INSTEAD
from yarclang.subjects import unknown
from yarclang.syntax.ast import Block, Node, Statement
from yarclang.syntax.words import AVOID, DECLARATIONS

DEFAULT_PROFILE = "LSPB"
TARGETS = ("RPY", "QUAT")


@frozen
class ResolvedName:
    """A command's name, split at its underscores, with the meaning of each part.

    Attributes:
        spec: the command.
        values: the kind of its values; None for a command without values.
        profile: name of the motion profile.
        full: the command's current name, with the suffixes that the program has.
        avoids: True if the motion avoids obstacles.
    """

    spec: CommandSpec
    values: Values | None
    profile: str
    full: str
    avoids: bool = False


class CommandNames:
    """Cache of resolved command names. A wrong name is reported once for each statement, even in a loop.

    Args:
        profiles: names of the planner's motion profiles.
    """

    def __init__(self, profiles: tuple[str, ...]) -> None:
        self._profiles = profiles
        self._sound: dict[str, ResolvedName] = {}
        self._told: dict[tuple[Collector, int], ResolvedName | None] = {}

    def resolved(self, statement: Statement, findings: Collector) -> ResolvedName | None:
        """Resolve a statement's name as `resolve_name` does; `findings` are those of the statement's file."""
        if (sound := self._sound.get(statement.name.text)) is not None:
            return sound
        key = findings, statement.line
        if key in self._told:
            return self._told[key]
        before = len(findings.found)
        found = resolve_name(statement, self._profiles, findings)
        if found is not None and len(findings.found) == before:
            self._sound[statement.name.text] = found
        else:
            self._told[key] = found
        return found

    def look_up(self, nodes: Iterable[Node], findings: Collector) -> None:
        """Resolve the names of all commands in a file, including commands that are never carried out."""
        for node in each(nodes):
            if isinstance(node, Block):
                self.look_up((*node.body, *(node.otherwise or ())), findings)
            elif node.name.text not in self._sound:
                word = node.name.name
                is_command = node.index is not None or word not in DECLARATIONS
                if is_command and word != "CALL" and word not in actions():
                    self.resolved(node, findings)


def resolve_name(statement: Statement, profiles: Iterable[str], findings: Collector) -> ResolvedName | None:
    """Split a command's name MOTION[_TARGET][_AVOID][_PROFILE] into its parts.

    Args:
        statement: the command.
        profiles: names of the planner's motion profiles.
        findings: receives the findings.

    Returns:
        None with a finding if there is no such command.
    """
    name, span = statement.name.name, statement.span(statement.name.place)
    spec, suffixes, old = _longest_match(name)
    if spec is None:
        subject = unknown(name, _known(tuple(profiles)))
        help_ = (
            INSTEAD.get(name)
            or subject.question
            or f"the commands are {', '.join(sorted({*commands(), *actions(), 'CALL'}))}"
        )
        findings.add("Y0202", f"{statement.name.text} is no command", span, help_, subject=subject)
        return None
    target, profile, avoids = "", DEFAULT_PROFILE, False
    for position, suffix in enumerate(suffixes):
        if position == 0 and suffix in spec.targets and suffix:
            target = suffix
        elif position == bool(target) and spec.may_avoid and suffix == AVOID:
            avoids = True
        elif position == len(suffixes) - 1 and _has_law(spec) and suffix in profiles:
            profile = suffix
        else:
            findings.add(
                "Y0203", _wrong_suffix(spec, suffix, suffixes, profiles), span, _taken(spec, profiles)
            )
            return None
    full = "_".join((spec.name, *suffixes))
    if old:
        fix = Fix(f"write {full}", (Edit(span, full),))
        findings.add("Y0204", f"{name} is now called {full}", span, f"write {full}", fix)
    return ResolvedName(spec, spec.targets.get(target), profile, full, avoids)


def is_command(word: str) -> bool:
    """Return True if a word in any case is a command's name, with or without suffixes."""
    name = word.upper()
    return name in actions() or name == "CALL" or _longest_match(name)[0] is not None


@lru_cache(maxsize=4)
def _known(profiles: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of all commands, without suffixes and with each possible suffix."""
    suffixes = (*TARGETS, AVOID, *profiles)
    return (
        *commands(),
        *actions(),
        "CALL",
        *(f"{one}_{suffix}" for one in commands() for suffix in suffixes),
    )


@lru_cache(maxsize=1024)
def _longest_match(name: str) -> tuple[CommandSpec | None, tuple[str, ...], bool]:
    """Find the command whose name is the longest prefix of a given name.

    Returns:
        The command (None if there is none), the suffixes after its name, and True if this is an outdated name
        of the command.
    """
    names = [(spec.name, spec, False) for spec in commands().values()]
    names += [(spec.old_name, spec, True) for spec in commands().values() if spec.old_name]
    for known, spec, old in sorted(names, key=lambda entry: -len(entry[0])):
        if name == known:
            return spec, (), old
        if name.startswith(known + "_"):
            return spec, tuple(name[len(known) + 1 :].split("_")), old
    return None, (), False


def _has_law(spec: CommandSpec) -> bool:
    """Return True if a command accepts a motion profile: all motions except timetables do."""
    return spec.is_motion and not spec.is_timed


def _wrong_suffix(spec: CommandSpec, suffix: str, suffixes: tuple[str, ...], profiles: Iterable[str]) -> str:
    if suffix in suffixes[: suffixes.index(suffix)] or suffixes.count(suffix) > 1:
        return f"the suffix _{suffix} is given twice"
    if (
        suffix in spec.targets
        or (_has_law(spec) and suffix in profiles)
        or (spec.may_avoid and suffix == AVOID)
    ):
        return f"_{suffix} is in the wrong place in {spec.name}_{'_'.join(suffixes)}"
    return f"{spec.name} doesn't take the suffix _{suffix}"


def _taken(spec: CommandSpec, profiles: Iterable[str]) -> str:
    targets = [f"_{target}" for target in spec.targets if target]
    avoids = [f"_{AVOID}"] if spec.may_avoid else []
    laws = [f"_{profile}" for profile in profiles] if _has_law(spec) else []
    if not targets and not laws:
        return f"{spec.name} takes no suffix"
    kinds = [
        kind[0] if len(kind) == 1 else f"one of {', '.join(kind)}" for kind in (targets, avoids, laws) if kind
    ]
    return f"{spec.name} takes {', then '.join(kinds)}"
