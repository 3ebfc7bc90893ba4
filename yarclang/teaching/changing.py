"""Change the fields of one command."""

from __future__ import annotations

from collections.abc import Mapping

from yarclang.runtime.actions import Trouble
from yarclang.syntax.ast import Statement
from yarclang.syntax.lines import code_of
from yarclang.teaching.edits import Draft, Edited, Program
from yarclang.teaching.fields import Part, Placed, Reader
from yarclang.teaching.holding import holding, units_of
from yarclang.teaching.wording import checked

_ORDER: tuple[Part, ...] = ("name", "moving", "value", "time", "units", "base", "option", "comment")


def change(
    program: Program, line: int, fields: Mapping[str, str], joints: tuple[str, ...] | None = None
) -> Edited:
    """Change fields of a command. All other bytes of the line stay unchanged.

    Args:
        program: the program.
        line: number of the command's line.
        fields: new texts of fields by field name; an empty text removes the field from the command.
        joints: names of the robot's joints; None for J1 and so on.

    Raises:
        Trouble: a field can't be changed in this way; the message is the reason.
    """
    statement = program.statement(line)
    reader = Reader(program.sketch, joints)
    placed = {one.field.name: one for one in reader.placed(statement)}
    wanted = {name: _wanted(name, text, placed) for name, text in fields.items()}
    changed = {name: text for name, text in wanted.items() if text != _known(placed[name])}
    _add_time_unit(program, statement, placed, changed)
    draft = Draft(program)
    for row, pieces in _pieces(statement, program, placed, changed).items():
        at = statement.line + row
        text = draft.content(at)
        for begin, end, put in sorted(pieces, reverse=True):
            text = text[:begin] + put + text[end:]
        draft.changed[at] = text
    edited = draft.finished(statement.line, _told(statement, changed))
    _read_back(program, edited, statement, changed, joints)
    return edited


def _add_time_unit(
    program: Program, statement: Statement, placed: Mapping[str, Placed], changed: dict[str, str]
) -> None:
    """Add a unit to a new time, if neither the line nor DEFAULT gives one."""
    text = next((changed[name] for name in ("time", "speed", "ceiling") if changed.get(name)), "")
    if not text or text.upper() == "MIN" or "units" in changed or "units" not in placed:
        return
    if "time" in units_of(statement) or "time" in holding(program, statement.line).units:
        return
    changed["units"] = ",".join(filter(None, (placed["units"].field.value, "s")))


def _known(one: Placed) -> str:
    return one.field.value


def _wanted(name: str, text: str, placed: Mapping[str, Placed]) -> str:
    one = placed.get(name)
    if one is None:
        known = ", ".join(placed)
        raise Trouble(f"this command has no field {name[:40]!r}", f"its fields are {known}", "field")
    made = checked(name.rpartition(".")[2], one.field.kind, text)
    if not made and one.part == "value" and name != "text":
        raise Trouble(f"{one.field.label} can't be left out", "delete the line, or give a value", "field")
    return made


def _pieces(
    statement: Statement, program: Program, placed: Mapping[str, Placed], changed: Mapping[str, str]
) -> dict[int, list[tuple[int, int, str]]]:
    """Return the replacements of text in each row of a statement, each as (first column, column after the
    last, new text); columns count from 0.

    A field that the statement lacks is inserted after the fields that precede it in the order of the
    language.
    """
    found: dict[int, list[tuple[int, int, str]]] = {}
    added: dict[Part, list[str]] = {}
    timed = [name for name in changed if placed[name].part == "time"]
    given = [name for name in timed if changed[name]]
    if len(given) > 1:
        labels = " and ".join(given)
        raise Trouble(f"{labels} can't both be given in a line", "leave one of the two empty", "field")
    for name, text in changed.items():
        piece = placed[name]
        if piece.part == "time" and given and name not in given:
            continue  # another time field is filled in, and replaces this one
        place = piece.place
        if place is None:
            if text:
                added.setdefault(piece.part, []).append(piece.form.replace("@", text))
            continue
        row, begin, end = place.row, place.start - 1, place.end - 1
        line = program.content(statement.line + row)
        if not text and piece.part != "value":
            begin = len(line[:begin].rstrip(" \t"))
        put = piece.form.replace("@", text) if text or piece.part == "value" else ""
        found.setdefault(row, []).append((begin, end, put))
    for part in _ORDER:
        if part in added:
            row, column = _behind(statement, program, part)
            put = "".join(f" {piece}" for piece in added[part])
            pieces = found.setdefault(row, [])
            same = next((piece for piece in pieces if piece[0] == piece[1] == column), None)
            if same is not None:  # an earlier part is inserted at the same place: append to it
                pieces.remove(same)
                put = same[2] + put
            pieces.append((column, column, put))
    return {row: _merged(pieces) for row, pieces in found.items()}


def _merged(pieces: list[tuple[int, int, str]]) -> list[tuple[int, int, str]]:
    """Merge insertions with the removals whose ranges contain them."""
    joined: list[tuple[int, int, str]] = []
    for begin, end, put in sorted(pieces):
        if joined and begin < joined[-1][1]:
            last = joined.pop()
            joined.append((last[0], max(last[1], end), last[2] + put))
        else:
            joined.append((begin, end, put))
    return joined


def _behind(statement: Statement, program: Program, part: Part) -> tuple[int, int]:
    """Return the row and column (from 0) at which a field that the statement lacks is inserted: after the
    last of the fields that precede it in the order of the language.
    """
    before = _ORDER[: _ORDER.index(part)] if part != "option" else _ORDER[:-1]
    row, column = 0, statement.name.place.end - 1
    if part == "comment":
        return 0, len(code_of(program.content(statement.line)).rstrip())
    places = []
    if statement.moving is not None and "moving" in before:
        places.append(statement.moving.place)
    if "value" in before:
        places += [item.place for point in statement.waypoints[-1:] for item in point.items]
        places += [statement.expression.place] if statement.expression is not None else []
    for name, one in (("time", statement.time), ("units", statement.units), ("base", statement.base)):
        if one is not None and name in before:
            places.append(one.place)
    if part == "option":
        places += [(option.argument or option.word).place for option in statement.options]
    if places:
        last = max(places, key=lambda one: (one.row, one.end))
        row, column = last.row, last.end - 1
    return row, column


def _told(statement: Statement, changed: Mapping[str, str]) -> str:
    if not changed:
        return f"line {statement.line} has these values already"
    shown = ", ".join(f"{name} {text}" if text else f"no {name}" for name, text in list(changed.items())[:4])
    return f"changed line {statement.line}: {shown}"


def _read_back(
    program: Program,
    edited: Edited,
    statement: Statement,
    changed: Mapping[str, str],
    joints: tuple[str, ...] | None,
) -> None:
    """Parse the new line again, and check that each changed field has its new text."""
    from yarclang.source import SourceFile
    from yarclang.teaching.edits import applied

    after = Program(SourceFile(program.source.name, applied(program.source.text, edited.edits)))
    found = after.sketch.statement_at(statement.line)
    read = (
        {}
        if found is None
        else {one.field.name: one.field.value for one in Reader(after.sketch, joints).placed(found)}
    )
    for name, text in changed.items():
        if _plain(read.get(name, "")) != _plain(text):
            raise Trouble(
                f"{name} {text[:60]!r} would be read as something else in line {statement.line}",
                "change the line by hand; nothing was changed",
                "field",
            )


def _plain(text: str) -> str:
    return "".join(text.split()).upper()
