"""The words of the language, with a line of documentation for each. Commands and profiles have their own
documentation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from types import MappingProxyType

from yarclang.commands.registry import actions, commands
from yarclang.commands.spec import CommandSpec
from yarclang.motion.profile import load_profile, profile_names
from yarclang.semantics.names.commands import DEFAULT_PROFILE
from yarclang.syntax.words import AVOID
from yarclang.units import UNITS
from yarclang.words.registry import word_specs


@dataclass(frozen=True, slots=True)
class Entry:
    """A word of the language.

    Attributes:
        summary: its meaning in a few words.
        example: an example line; empty without one.
    """

    summary: str
    example: str = ""


DECLARED: Mapping[str, Entry] = MappingProxyType(
    {name: Entry(word.summary, word.example) for name, word in word_specs().items() if not word.is_command}
)
"""Words that begin a line without an index."""


@cache
def action_entries() -> Mapping[str, Entry]:
    """Return the commands that aren't motions, with their documentation."""
    calls = {
        name: Entry(word.summary, word.example) for name, word in word_specs().items() if word.is_command
    }
    return MappingProxyType(
        {name: Entry(spec.summary, spec.examples[0]) for name, spec in actions().items()} | calls
    )


OPTIONS: Mapping[str, Entry] = MappingProxyType(
    {
        "BLEND": Entry(
            "passes into the next motion without a stop, within this distance of the end", "BLEND 5"
        ),
        "ACC": Entry("uses this share of the acceleration and jerk limits", "ACC 30%"),
        "TOL": Entry(
            "the largest deviation of the moving frame from its path, in length units; and in angle, 1 "
            "degree for each millimetre",
            "TOL 0.05",
        ),
        "UNTIL": Entry("ends the motion before its target as soon as an input is ON (or OFF)", "UNTIL TOUCH"),
        "INTO": Entry(
            "the register for the distance that a line with UNTIL has moved, in 0.01 mm", "INTO DEPTH"
        ),
        "ALLOW": Entry("lets two bodies touch during the motion: they aren't checked", "ALLOW GRIPPER BOX"),
        "STRETCH": Entry("multiplies all times of a timetable by this factor", "STRETCH 1.5"),
        "NEAR": Entry("takes the solution of the pose that is nearest to this joint position", "NEAR HOME"),
    }
)
"""Words that begin an option."""

RATES: Mapping[str, Entry] = MappingProxyType(
    {
        "VEL": Entry("the velocity of each joint at a waypoint of a timetable", "VEL 0 0 3 0 3 0"),
        "ACC": Entry("after VEL, the acceleration of each joint there", "ACC 0 0 0 0 0 0"),
    }
)
"""Words after the time of a waypoint."""

TIMES: Mapping[str, Entry] = MappingProxyType(
    {
        "MIN": Entry("the shortest time that profile and limits allow", "[MIN]"),
        "V": Entry("the speed of the moving frame in length units per time unit", "[V 250]"),
        "V<=": Entry("as fast as the limits allow, but the moving frame never faster than this", "[V<=250]"),
    }
)
"""Words of a motion time."""

OTHERS: Mapping[str, Entry] = MappingProxyType(
    {
        "ON": Entry("the value 1 of an input or output"),
        "OFF": Entry("the value 0 of an input or output"),
        "PI": Entry("3.14159..."),
        "OR": Entry("1 if at least one of the two isn't 0"),
        "AND": Entry("1 if neither is 0"),
        "NOT": Entry("1 if it is 0, else 0"),
        "SQRT": Entry("square root", "SQRT(2)"),
        "SIN": Entry("sine; a plain number counts as degrees", "SIN(30)"),
        "COS": Entry("cosine; a plain number counts as degrees", "COS(60)"),
        "TAN": Entry("tangent; a plain number counts as degrees", "TAN(45)"),
        "ATAN2": Entry("the angle of the direction x, y", "ATAN2(y, x)"),
        "ABS": Entry("the value without its sign", "ABS(-3)"),
        "MIN": Entry("the least of several", "MIN(A, B)"),
        "MAX": Entry("the largest of several", "MAX(A, B)"),
        "FLOOR": Entry("the next integer below", "FLOOR(2.7)"),
        "CEIL": Entry("the next integer above", "CEIL(2.1)"),
    }
)
"""Words of expressions, and states."""

TARGETS: Mapping[str, str] = MappingProxyType(
    {
        "RPY": "the target is a pose as x y z roll pitch yaw",
        "QUAT": "the target is a pose as x y z qx qy qz qw",
    }
)
"""Meanings of the target suffixes."""

FRAMES: Mapping[str, Entry] = MappingProxyType(
    {
        "B": Entry("the robot's base: the world of a program"),
        "FLANGE": Entry("the robot's flange, to which tools are fixed"),
        "TCP": Entry("the tool centre point that the robot's description gives"),
    }
)
"""Frames that the robot defines."""


@cache
def command_names() -> tuple[str, ...]:
    """Return all names of commands, with every suffix that each command allows."""
    names: list[str] = []
    for spec in commands().values():
        laws = ("", *profile_names()) if spec.is_motion and not spec.is_timed else ("",)
        targets = tuple(dict.fromkeys(("", *spec.targets)))
        avoids = ("", AVOID) if spec.may_avoid else ("",)
        names += [
            "_".join(filter(None, (spec.name, *suffixes))) for suffixes in product(targets, avoids, laws)
        ]
    return tuple(names)


@cache
def command_of(name: str) -> tuple[CommandSpec, str, str] | None:
    """Split a command's full name, such as MOVEJ_RPY_LSPB: return the command, its target suffix (empty for
    none) and its profile; None if there is no such command.
    """
    if name not in command_names():
        return None
    spec = max(
        (one for one in commands().values() if name == one.name or name.startswith(one.name + "_")),
        key=lambda one: len(one.name),
    )
    suffixes = name[len(spec.name) :].split("_")
    target = next((one for one in suffixes if one and one in spec.targets), "")
    profile = next((one for one in suffixes if one in profile_names()), DEFAULT_PROFILE)
    return spec, target, profile


@cache
def command_text(name: str) -> str:
    """Return a command's documentation in Markdown; empty if there is no such command."""
    found = command_of(name)
    if found is None:
        entry = action_entries().get(name) or DECLARED.get(name)
        return entry_text(name, entry) if entry else ""
    spec, target, profile = found
    lines = [f"**{name}**: {spec.summary}", "", spec.doc.strip()]
    if target in TARGETS:
        lines += ["", f"`_{target}`: {TARGETS[target]}"]
    if AVOID in name.split("_"):
        lines += ["", f"`_{AVOID}`: the path may leave the straight line to avoid bodies"]
    if spec.is_motion and not spec.is_timed:
        lines += ["", f"`_{profile}`: {load_profile(profile).summary}"]
    lines += ["", "```yarc", *spec.examples, "```"]
    return "\n".join(lines)


def entry_text(word: str, entry: Entry) -> str:
    """Return a word's documentation in Markdown."""
    example = f"\n\n```yarc\n{entry.example}\n```" if entry.example else ""
    return f"**{word}**: {entry.summary}{example}"


def unit_text(name: str) -> str:
    """Return a unit's documentation in Markdown; empty if there is no such unit."""
    unit = UNITS.get(name.lower())
    if unit is None:
        return ""
    si = {"length": "m", "angle": "rad", "time": "s"}[unit.kind]
    return f"**{unit.name}**: a unit of {unit.kind}, {unit.factor:g} {si}"


def word_text(word: str) -> str:
    """Return the meaning of any word of the language, in Markdown; empty if there is none."""
    for table in (OPTIONS, RATES, TIMES, OTHERS):
        if word in table:
            return entry_text(word, table[word])
    return command_text(word)
