"""Hashes and cache keys of programs and their steps. They are equal for equal behaviour, wherever the
commands are in the text.
"""

from __future__ import annotations

import hashlib
import marshal
from collections.abc import Callable, Hashable
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from yarclang.cell.keeping import Keep, Sight
from yarclang.decisions import simple
from yarclang.hir import (
    FrameLink,
    Goal,
    JointDelta,
    JointGoal,
    JointMove,
    LineMove,
    Motion,
    Origin,
    PoseDelta,
    PoseGoal,
    Program,
    Reading,
    Signal,
    Step,
    WayOut,
    When,
)
from yarclang.memory import NO_MEMORY, Forgetful, Memory


def flat(*parts: Any) -> bytes:
    """Serialise numbers, texts, bytes and tuples of them to bytes, for use in cache keys.

    A bytes object is hashed and compared in one operation, while a tuple needs one for each element. Equal
    bytes mean equal elements. Equal elements may give different bytes (a numpy float is written differently
    from a float), but this only causes a cache miss.
    """
    return marshal.dumps(parts, _WITHOUT_REFERENCES)


_WITHOUT_REFERENCES = 2
"""Version of the marshal format that writes only values, without references to shared objects."""


def key_of(step: Motion) -> bytes:
    """Return a cache key of a motion's behaviour and the frame that it moves. The motion's position in the
    text doesn't count.
    """
    timing, speed = step.timing, step.timing.speed
    search = step.search if isinstance(step, JointMove | LineMove) else None
    return flat(
        type(step).__name__,
        tuple(map(_key_of_goal, step.goals)),
        tuple([None if one is None else one.tobytes() for one in step.besides]),
        step.profile,
        (
            timing.duration,
            timing.share,
            timing.ramp,
            None if speed is None else _key_of_reading(speed),
            # Optional parts, here and below, are added only if the motion has them. So the keys of motions
            # without them don't change.
            *(() if timing.ceiling is None else (timing.ceiling,)),
        ),
        step.tolerance,
        None if step.blend is None else _key_of_reading(step.blend),
        _key_of_link(step.origin.tool),
        # The search, if an input may end the motion.
        *(
            ()
            if search is None
            else ((search.variable, search.value, search.name, search.flag, search.depth),)
        ),
        # The pairs of bodies that may touch.
        *((tuple([(one.first, one.second) for one in step.allowed]),) if step.allowed else ()),
        # The path constraints.
        *((tuple([("keep", one.told) for one in step.keeps]),) if step.keeps else ()),
        # The word "avoids", if the motion avoids obstacles.
        *(("avoids",) if isinstance(step, LineMove) and step.avoids else ()),
    )


def _key_of_link(link: FrameLink | None) -> Hashable:
    """Return a cache key of the chain of frames from a moving frame to the flange."""
    if link is None:
        return None
    return link.name, link.parent_from_frame.tobytes(), _key_of_link(link.parent)


def _key_of_reading(reading: Reading) -> Hashable:
    return reading.length, reading.angle, *((True,) if reading.or_less else ())


def _key_of_goal(goal: Goal) -> Hashable:
    match goal:
        case JointGoal():
            return "joints", goal.q.tobytes()
        case JointDelta():
            return "delta", goal.dq.tobytes()
        case PoseGoal():
            near = None if goal.near is None else goal.near.tobytes()
            pose = goal.base_from_moving.tobytes(), goal.flange_from_moving.tobytes(), near
            return "pose", *pose, *((True,) if goal.shifted else ())
        case PoseDelta():
            parts = (goal.shift, goal.turn, goal.axes, goal.flange_from_moving)
            told = tuple(part.tobytes() for part in parts)
            return "poses apart", goal.axes_on_flange, *told, *((True,) if goal.shifted else ())


def fingerprint(program: Program, memory: Memory = NO_MEMORY) -> str:
    """Compute a hash of the program's behaviour, including its obstacles and zones.

    Layout, comments, the file's name and the spelling of commands do not affect the hash.

    Args:
        program: the checked program.
        memory: cache of the hashed bytes of each motion.

    Returns:
        The SHA-256 as 64 hex digits.
    """
    digest = hashlib.sha256()
    _feed(digest.update, program.start)
    _feed(digest.update, program.outputs)
    for step in program.steps:
        if not isinstance(memory, Forgetful) and isinstance(step, Motion) and not step.origin.place:
            digest.update(_fed(step, memory))
        else:
            digest.update(_bytes_of(step))
    if program.registers:
        _feed(digest.update, program.registers)
    if program.watches:
        _feed(digest.update, program.watches)
    if program.ways_out:
        _feed(digest.update, program.ways_out)
    if program.cell is not None:
        # Names of the cell need no hash of their own: the steps contain the meanings of those that are used.
        _feed(digest.update, program.cell.obstacles)
        _feed(digest.update, program.cell.zones)
        if program.cell.parts:
            _feed(digest.update, program.cell.parts)
            _feed(digest.update, tuple(sorted((*program.cell.grips.items(), *program.cell.removals.items()))))
        if program.cell.allowances:
            fed = [(one.first, one.second, one.leads_to, one.leaves) for one in program.cell.allowances]
            _feed(digest.update, ("allow", *fed))
        if (present := program.cell.present) is not None:
            parts = present.parts
            _feed(digest.update, (parts.items, tuple(sorted(parts.closed)), parts.expected, present.leaving))
    return digest.hexdigest()


def way_fingerprint(way: WayOut) -> str:
    """Compute a hash of the robot's behaviour while it withdraws (`WayOut`), as 16 hex digits."""
    digest = hashlib.sha256()
    _feed(digest.update, way.steps)
    return digest.hexdigest()[:16]


def _fed(step: Motion, memory: Memory) -> bytes:
    """Return the bytes that a motion adds to the program's hash. They are cached by the identity of the
    motion's fields.

    A step from the cache shares its field objects with the earlier step, unless it is in a loop or a SUB
    (semantics/recalling.py).
    """
    label = step.origin.label
    _, *parts = (getattr(step, name) for name in step.__dataclass_fields__)
    # The cached value keeps the field objects alive, so that no other object can get one of their ids.
    key = ("hashed", type(step), label, *map(id, parts))
    kept: tuple[bytes, list[object]] | None = memory.get(key)
    if kept is None:
        kept = _bytes_of(step), parts
        memory.keep(key, kept)
    return kept[0]


def _bytes_of(step: Step) -> bytes:
    fed: list[bytes] = []
    if (
        isinstance(step, When)
        and not step.again
        and step.within is None
        and (compared := simple(step.condition)) is not None
    ):
        # A condition that only compares an input with a value is written in the older form, so that hashes
        # don't change.
        one, value = compared
        step_parts = (step.origin, Signal(one.name, one.variable), value)
        fed.append(b"When(")
        for part in step_parts:
            _feed(fed.append, part)
        fed.append(b")")
    else:
        _feed(fed.append, step)
    return b"".join(fed)


def _feed(feed: Callable[[bytes], object], value: object) -> None:
    kind: Any = type(value)
    if value is None or kind is float or kind is str:  # by far the most frequent kinds
        feed(f"{value!r};".encode())
    elif kind is Keep and not isinstance(value.region, Sight):  # type: ignore[attr-defined]
        # Rules without a cone keep their older form, so that hashes don't change.
        keep: Keep = value  # type: ignore[assignment]
        feed(b"Keep(")
        _feed(feed, (keep.kind, keep.frame, keep.of, *keep.region.numbers))
        feed(b")")
    elif (known := _known_fields(kind)) is not None:
        head, names = known
        feed(head)
        for name in names:
            part = getattr(value, name)
            if name not in _LATER or part is not _LATER[name]:
                _feed(feed, part)
        feed(b")")
    elif isinstance(value, Origin):
        feed(f"{value.label};".encode())
    elif isinstance(value, Path):
        pass  # The path of a mesh file does not matter: its content has a digest of its own.
    elif isinstance(value, np.ndarray):
        feed(str(value.shape).encode() + (value + 0.0).tobytes())
    elif isinstance(value, tuple):
        for item in value:
            _feed(feed, item)
    else:
        feed(f"{value!r};".encode())


_LATER: dict[str, object] = {
    "ceiling": None,
    "search": None,
    "offset": None,
    "shifted": False,
    "or_less": False,
    "step": None,
    "outside": False,
    "of_tool": False,
    "weight": None,
    "rack": None,
    "tool": None,
    "changes": False,
    "teaches": "",
    "then": "",
    "way": "",
    "allowed": (),
    "pieces": 0,
    "keeps": (),
    "keep": None,
    "avoids": False,
}
"""Fields added after programs had been hashed, with their default values.

A default value is left out of the hash, so that the hash of an older program does not change.
"""


@cache
def _known_fields(kind: type[Any]) -> tuple[bytes, tuple[str, ...]] | None:
    """Return the bytes that begin a dataclass's entry in a hash, and the names of the fields that it
    compares.

    None for Origin, which adds only its label, and for types that aren't dataclasses.
    """
    if issubclass(kind, Origin) or not is_dataclass(kind):
        return None
    return kind.__name__.encode() + b"(", tuple(one.name for one in fields(kind) if one.compare)
