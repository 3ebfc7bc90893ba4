"""Cache the steps of commands. The key is the text of a command and the meanings of the names in it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import fields, replace
from operator import attrgetter
from typing import Any

from yarclang.diagnostics import Collector
from yarclang.frozen import frozen
from yarclang.hir import FrameLink, Gap, Origin, Step
from yarclang.memory import Memory, recall
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.names.scope import (
    Formula,
    Frame,
    JointPosition,
    Named,
    Places,
    Pose,
    Scope,
    Table,
    Where,
)
from yarclang.semantics.values.amounts import Amount
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Statement

_NO_TEXT = SourceFile("", "")


class _Watched(Scope):
    """A scope that records which names are looked up in it."""

    __slots__ = ("_scope", "asked", "is_listed")

    def __init__(self, scope: Scope) -> None:
        super().__init__()
        self._scope = scope
        self.asked: dict[tuple[bool, str], Named | Frame | None] = {}
        self.is_listed = False
        """True if a list of all names was requested: the result then depends on every name, and isn't
        cached.
        """

    def name(self, name: str) -> Named | None:
        found = self.asked[False, name] = self._scope.name(name)
        return found

    def frame(self, name: str) -> Frame | None:
        found = self.asked[True, name] = self._scope.frame(name)
        return found

    def declared(self, name: str) -> Named | None:
        self.is_listed = True
        return self._scope.declared(name)

    def where(self, name: str) -> Where | None:
        self.is_listed = True
        return self._scope.where(name)

    def names(self, *kinds: type) -> list[str]:
        self.is_listed = True
        return self._scope.names(*kinds)

    def frame_names(self) -> Iterator[str]:
        self.is_listed = True
        return self._scope.frame_names()

    def copy(self) -> Scope:
        self.is_listed = True
        return self._scope.copy()


_Asked = tuple[tuple[bool, str, Hashable], ...]
_Link = tuple[int, bool, str]
"""The lookup that found a frame: the number of the scope (0: of the command, 1: of DEFAULT), True if the
name is that of the frame (False: that of a pose in the frame), and the name.
"""
_Links = tuple[_Link | None, _Link | None]


@frozen
class _Kept:
    """A cached step without its place in the text.

    Attributes:
        made: type of the step.
        origin: fields of its origin.
        parts: fields of the step after its origin.
        line: line number of the command when it was read.
        asked: names that were looked up in the command's scope and in that of DEFAULT, with their meanings.
        links: the lookups that found its moving frame and its base frame.
    """

    made: Callable[..., Step]
    origin: tuple[object, ...]
    parts: tuple[object, ...]
    line: int
    asked: tuple[_Asked, _Asked]
    links: _Links


def step_before(
    memory: Memory,
    robot: Robot,
    statement: Statement,
    defaults: Defaults,
    scope: Scope,
    findings: Collector,
    make: Callable[[Defaults, Scope], Step | None],
) -> Step | None:
    """Return the step of a command outside of loops and SUBs.

    The step comes from the cache if the text of the command and the meanings of all names in it are
    unchanged. Otherwise `make` reads the command. Commands with findings are not cached.

    Args:
        memory: the cache.
        robot: the robot of the program.
        statement: the command.
        defaults: the values of the DEFAULT line of its file.
        scope: the names in scope at this line.
        findings: the findings of the command's file; receives those of `make`.
        make: function that reads the command with given defaults and scope.
    """
    source = findings.source
    default = defaults.statement
    key = (
        "step",
        robot,
        _text(source, statement),
        None if default is None else _text(source, default),
        defaults.has_bad_time,
    )
    kept: _Kept | None = memory.get(key)
    if kept is not None and (frames := _frames_as_they_were(kept, defaults, scope)) is not None:
        return _placed(kept, statement.line, source, frames)
    watched = _Watched(scope), _Watched(defaults.scope)
    before = len(findings.found)
    step = make(replace(defaults, scope=watched[1]), watched[0])
    if step is None or isinstance(step, Gap) or len(findings.found) > before:
        return step
    links = tuple(_named(link, watched) for link in (step.origin.moving, step.origin.base))
    if any(one.is_listed for one in watched) or _LOST in links:
        return step
    origin = replace(step.origin, source=_NO_TEXT, moving=None, base=None)  # the cache must not hold the text
    asked = tuple(tuple((*which, _meaning(found)) for which, found in one.asked.items()) for one in watched)
    # Most commands look up the same names. Let them share one object, so that these names are compared only
    # once.
    shared = recall(memory, ("asked", asked), lambda: asked)
    parts = tuple(getattr(step, name) for name in list(step.__dataclass_fields__)[1:])
    memory.keep(key, _Kept(type(step), _PARTS(origin), parts, statement.line, shared, links))  # type: ignore[arg-type]
    return step


def _text(source: SourceFile, statement: Statement) -> Hashable:
    return source.lines[statement.line - 1 : statement.line - 1 + statement.rows]


def _meaning(found: Named | Frame | None) -> Hashable:
    """Return the meaning of a name as a value that can be compared. SUBs and modules are compared by
    identity.
    """
    match found:
        case Frame():
            return found.transform.tobytes(), found.on_flange, _meaning_of_link(found.link)
        case JointPosition():
            return found.q.tobytes()
        case Pose():
            return found.transform.tobytes(), _meaning_of_link(found.link)
        case Amount():
            return repr(found.value), found.unit  # 0.0 equals -0.0, their texts differ
        case Places(rows=rows):
            return tuple(map(_meaning, rows))
        case Formula(meaning=meaning):
            return meaning
        case Table(rows=rows):
            return tuple(tuple((repr(one.value), one.unit) for one in row) for row in rows)
    return found


def _meaning_of_link(link: FrameLink | None) -> Hashable:
    return (
        None if link is None else (link.name, link.parent_from_frame.tobytes(), _meaning_of_link(link.parent))
    )


def _frames_as_they_were(
    kept: _Kept, defaults: Defaults, scope: Scope
) -> tuple[FrameLink | None, ...] | None:
    """Return the current moving frame and base frame of a cached command; None if a name that the command
    uses has another meaning now.

    The scope caches the answer up to its next declaration. The id of `kept.asked` is part of the key. The
    scope also stores `kept.asked` itself, so that no other object can get this id.
    """
    key = id(kept.asked), kept.links
    seen: tuple[object, tuple[FrameLink | None, ...]] | None = scope.seen.get(key)
    if seen is not None:
        return seen[1]
    scopes = scope, defaults.scope
    for one, asked in zip(scopes, kept.asked, strict=True):
        for is_frame, name, meaning in asked:
            if _meaning(one.frame(name) if is_frame else one.name(name)) != meaning:
                return None
    links = tuple([None if one is None else _link_of(scopes[one[0]], *one[1:]) for one in kept.links])
    scope.seen[key] = kept.asked, links
    return links


def _link_of(scope: Scope, is_frame: bool, name: str) -> FrameLink | None:
    """Return the declaration (link) of a frame, or of the frame in which a pose is given."""
    found = scope.frame(name) if is_frame else scope.name(name)
    return found.link if isinstance(found, Frame | Pose) else None


_LOST = (-1, False, "")


def _named(link: FrameLink | None, watched: tuple[_Watched, _Watched]) -> _Link | None:
    """Return the lookup that found a frame. None without a frame; _LOST if no lookup of a name found it."""
    if link is None:
        return None
    for number, one in enumerate(watched):
        for (is_frame, name), found in one.asked.items():
            if isinstance(found, Frame | Pose) and found.link is link:
                return number, is_frame, name
    return _LOST


_NAMES = tuple(entry.name for entry in fields(Origin))
_PARTS = attrgetter(*_NAMES)
_SPANS = tuple(place for place, entry in enumerate(fields(Origin)) if "Span" in str(entry.type))
_SOURCE, _MOVING, _BASE = (_NAMES.index(name) for name in ("source", "moving", "base"))


def _placed(kept: _Kept, line: int, source: SourceFile, frames: tuple[FrameLink | None, ...]) -> Step:
    """Return a cached step, moved to the line on which its command is now."""
    # Twice as fast as `replace`, which matters: after an edit, nearly every command of the program passes
    # here.
    values: list[Any] = list(kept.origin)
    values[_SOURCE] = source
    values[_MOVING], values[_BASE] = frames
    if down := line - kept.line:
        for place in _SPANS:
            if (span := values[place]) is not None:
                values[place] = Span(span.line + down, span.column, span.end_line + down, span.end_column)
    return kept.made(Origin(*values), *kept.parts)
