"""Reading of the settings text of a Turbo PMAC: what was proved about the settings, differences from the
robot's own settings, and questions for a controller.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from yarclang.backend import Settings
from yarclang.backend_pmac.settings import settings_text
from yarclang.certify.pmac.settings import Listing, ProvedSettings, SettingsText, certify_settings
from yarclang.diagnostics import Diagnostic, Result
from yarclang.robot.model import Robot
from yarclang.runtime.inspection import Item, Kind
from yarclang.source import SourceFile, Span

_SET_BY_PROGRAMS = ("I16", "I17")
"""I-variables that each program sets for itself. A controller may have any values of them before a program
runs.
"""


def _written(robot: Robot) -> SourceFile:
    return SourceFile(f"yarc settings {robot.name}", settings_text(robot))


def _content(robot: Robot) -> SettingsText:
    """Prove the robot's own settings text, and return its content."""
    judged = certify_settings(_written(robot), robot)
    assert judged.value is not None
    return judged.value.content


def _judge(source: SourceFile, robot: Robot) -> Result[tuple[str, ...]]:
    judged = certify_settings(source, robot)
    told = None if judged.value is None else tuple(_bounds(judged.value, robot))
    return Result(told, judged.diagnostics)


def _bounds(proved: ProvedSettings, robot: Robot) -> Iterator[str]:
    """Yield sentences with the proved maximum errors of the axis definitions and of PLC 0, rounded up, in
    each unit of the robot's axes.
    """
    for what, bounds in (("axis definitions", proved.commanded), ("PLC 0", proved.feedback)):
        largest: dict[str, float] = {}
        for bound, unit in zip(bounds, robot.axis_unit_names, strict=True):
            largest[unit] = max(float(bound), largest.get(unit, 0.0))
        told = (f"{math.ceil(bound * 1e6) / 1e6:.6f} {unit}" for unit, bound in largest.items())
        yield f"{what} within {', '.join(told)}"


def _different(source: SourceFile, robot: Robot) -> tuple[Diagnostic, ...]:
    judged = certify_settings(source, robot)
    if judged.value is None:
        return ()
    return tuple(_differences(source, judged.value.content, _content(robot), robot))


def _differences(
    source: SourceFile, found: SettingsText, wanted: SettingsText, robot: Robot
) -> Iterator[Diagnostic]:
    """Yield a warning for each setting that is printed differently from the robot's own, in the order of
    the lines.
    """
    told = dict(_printed(wanted))
    for name, (line, text) in _printed(found):
        if text != told[name][1]:
            message = (
                f"the proof holds for {name}{text} too, but `yarc settings {robot.name}` prints "
                f"{name}{told[name][1]}"
            )
            help_ = "download the printed settings: `yarc doctor` and each run refuse another value"
            if name.rstrip("=") in _SET_BY_PROGRAMS:
                help_ = "this is for other programs: each program of yarcc sets its own"
            span = Span.on_line(line, 1, len(source.line(line)) + 1)
            yield Diagnostic("Y1176", message, source, span, help_)


def _printed(content: SettingsText) -> Iterator[tuple[str, tuple[int, str]]]:
    """Yield the settings in a text that a controller can be asked for: their names, line numbers and
    printed values.
    """
    for definition in content.definitions:
        yield f"#{definition.motor}->", (definition.line, definition.terms)
    for setting in content.settings.values():
        yield f"{setting.name}=", (setting.line, setting.printed)
    for statement, line in zip(content.feedback.statements, content.feedback.places, strict=True):
        name, equals, expression = statement.partition("=")
        yield name + equals, (line, expression)


def _items(robot: Robot) -> tuple[Item, ...]:
    """Return the settings that a controller must have for a robot, as questions for the controller. Each line
    of `yarc settings` whose effect lasts gives one question.
    """
    remedy = f"download `yarc settings {robot.name}` and SAVE"
    content = _content(robot)
    items: list[tuple[int, Item]] = []
    for definition in content.definitions:
        question = f"#{definition.motor}->"
        subject = f"axis definition of motor {definition.motor}"
        items.append((definition.line, Item(subject, question, definition.terms, "definition", remedy)))
    for pointer in content.pointers:
        subject, question = f"address of {pointer.variable}", f"{pointer.variable}->"
        items.append((pointer.line, Item(subject, question, pointer.address, "address", remedy)))
    for setting in content.settings.values():
        if setting.name not in _SET_BY_PROGRAMS:
            kind: Kind = "bits" if setting.name == "I5" else "number"
            subject = f"{setting.name}, {setting.remark}"
            items.append((setting.line, Item(subject, setting.name, setting.printed, kind, remedy)))
    items += [_program(listing, remedy) for listing in (content.feedback, content.guard)]
    return tuple(item for _, item in sorted(items, key=lambda one: one[0]))


def _program(listing: Listing, remedy: str) -> tuple[int, Item]:
    name = f"PLC {listing.number}"
    return listing.places[0], Item(name, f"LIST {name}", "\n".join(listing.statements), "listing", remedy)


def _lines(text: str) -> tuple[str, ...]:
    bare = (line.partition(";")[0].strip() for line in text.splitlines())
    return tuple(line for line in bare if line)


SETTINGS = Settings(settings_text, _judge, _different, _items, _lines)
