"""A robot's settings, judged, and what the runtime looks at before anything moves: the very items that were judged."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from yarclang.backend_pmac.settings import settings_text
from yarclang.certify.settings import Listing, ProvedSettings, SettingsText, certify_settings
from yarclang.diagnostics import Diagnostic, Result
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.inspection import Item, Kind
from yarclang.source import SourceFile, Span

_SET_BY_PROGRAMS = ("I16", "I17")
"""I-variables that each program sets for itself: a controller may have any value."""


def settings_of(robot: Robot) -> Result[ProvedSettings]:
    """Write the settings of a robot's controller, and judge them.

    Returns:
        None, with findings, if something in them isn't proved.
    """
    judged = certify_settings(SourceFile(f"yarc settings {robot.name}", settings_text(robot)), robot)
    remedy = "correct robot.toml; if its values are right, this is a fault of yarclang: report it"
    return replace(judged, diagnostics=tuple(replace(one, help=remedy) for one in judged.diagnostics))


def proved_settings(robot: Robot) -> ProvedSettings:
    """Return the settings of a robot's controller.

    Raises:
        Trouble: something in them isn't proved.
    """
    judged = settings_of(robot)
    if judged.value is None:
        first = judged.diagnostics[0]
        what = f"the settings of {robot.name} aren't proved: {first.message}"
        raise Trouble(what, f"`yarc settings {robot.name}` shows all that is wrong", first.code)
    return judged.value


def check_settings(source: SourceFile, robot: Robot) -> Result[ProvedSettings]:
    """Judge a settings text that was saved or edited, and tell where it differs from what `yarc settings` prints.

    Args:
        source: the text, a character for each byte.
        robot: whose controller it is for.

    Returns:
        What was proved, with a warning for each difference; None, with the errors, if something isn't proved.
    """
    judged, own = certify_settings(source, robot), settings_of(robot)
    if judged.value is None or own.value is None:
        return replace(judged, diagnostics=judged.diagnostics or own.diagnostics)
    return replace(
        judged, diagnostics=tuple(_differences(source, judged.value.content, own.value.content, robot))
    )


def _differences(
    source: SourceFile, found: SettingsText, wanted: SettingsText, robot: Robot
) -> Iterator[Diagnostic]:
    """A warning for each item that is printed otherwise, in the order of the lines."""
    told = dict(_printed(wanted))
    for name, (line, text) in _printed(found):
        if text != told[name][1]:
            message = (
                f"{name}{text} is proved too, but `yarc settings {robot.name}` prints {name}{told[name][1]}"
            )
            help_ = "download what it prints: `yarc doctor` and each run refuse another value"
            if name.rstrip("=") in _SET_BY_PROGRAMS:
                help_ = "this is for programs of others: each of yarcc's sets its own"
            span = Span.on_line(line, 1, len(source.line(line)) + 1)
            yield Diagnostic("Y1176", message, source, span, help_)


def _printed(content: SettingsText) -> Iterator[tuple[str, tuple[int, str]]]:
    """What a controller is asked about, by its name: the line and the text."""
    for definition in content.definitions:
        yield f"#{definition.motor}->", (definition.line, definition.terms)
    for setting in content.settings.values():
        yield f"{setting.name}=", (setting.line, setting.printed)
    for statement, line in zip(content.feedback.statements, content.feedback.places, strict=True):
        name, equals, expression = statement.partition("=")
        yield name + equals, (line, expression)


def items_of(robot: Robot) -> tuple[Item, ...]:
    """List what a controller must have been told about a robot: each line of `yarc settings` that stays, as a question.

    Raises:
        Trouble: the settings aren't proved.
    """
    remedy = f"download `yarc settings {robot.name}` and SAVE"
    content = proved_settings(robot).content
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
