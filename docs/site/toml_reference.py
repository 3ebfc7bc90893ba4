"""Make the references of robot.toml and cell.toml from the models with which yarclang reads these files.
keys.toml has the descriptions of the keys.
"""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Le
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from yarclang.cell.schema import CellTable
from yarclang.robot.kinds import DEFAULT
from yarclang.robot.schema import robot_table
from yarclang.toml.tables import LARGEST, LEAST, Document, Table

WORDS = tomllib.loads((Path(__file__).parent / "keys.toml").read_text(encoding="utf-8"))
_TYPES = {str: "text", bool: "`true` or `false`", int: "integer", float: "number"}


def robot_page() -> str:
    """Return the page of robot.toml."""
    return page("robot", robot_table(DEFAULT))


def cell_page() -> str:
    """Return the page of cell.toml."""
    return page("cell", CellTable)


def page(file: str, document: type[Document]) -> str:
    """Return the page of a file: its own keys, then each table."""
    words = WORDS[file]
    lines = [
        f"# {file}.toml",
        "",
        words["page"].strip(),
        "",
        "## The whole file",
        "",
        *rows(document, words["file"]),
    ]
    for key, name, table in tables_of(document):
        lines += [f"## {name}", "", words[key]["table"], "", *rows(table, words[key])]
    return "\n".join(lines)


def tables_of(document: type[Document]) -> Iterator[tuple[str, str, type[Table]]]:
    """Yield the tables of a file: key, heading, form."""
    for key, table in document.tables.items():
        kind = get_origin(bare(document.model_fields[key].annotation))
        name = {list: f"[[{key}]]", dict: f"[{key}.NAME]"}.get(kind, f"[{key}]")
        yield key, name, table


def rows(table: type[Table], words: dict[str, str]) -> list[str]:
    """Return the rows of a table's keys."""
    lines = ["| key | value | if it is left out | what it is |", "|---|---|---|---|"]
    for key, field in table.model_fields.items():
        value = table.wanted.get(key) or type_of(field.annotation, field.metadata)
        lines.append(f"| `{key}` | {value} | {otherwise(table, key, field)} | {words[key]} |")
    return [*lines, ""]


def otherwise(table: type[Table], key: str, field: FieldInfo) -> str:
    """Return the default of a key, or "required". The text is empty if the key has no default."""
    if key in table.required:
        return "**required**"
    default = field.default
    if default is PydanticUndefined or default is None or default in ([], {}, ""):
        return ""
    return (
        f"`{str(default).lower() if isinstance(default, bool) else repr(default).replace(chr(39), chr(34))}`"
    )


def bare(annotation: Any) -> Any:
    """Return a type without None and without its bounds."""
    if get_origin(annotation) is Annotated:
        return bare(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return bare(next(each for each in get_args(annotation) if each is not NoneType))
    return annotation


def type_of(annotation: Any, metadata: list[Any]) -> str:
    """Return a type in words, with its bounds."""
    if get_origin(annotation) in (Union, UnionType):
        return type_of(next(each for each in get_args(annotation) if each is not NoneType), metadata)
    if get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        return type_of(inner, [*metadata, *more])
    origin = get_origin(annotation)
    if origin is Literal:
        return ", ".join(f'`"{each}"`' for each in get_args(annotation))
    if origin is list:
        inner = get_args(annotation)[0]
        return "tables" if is_table(inner) else f"list of: {type_of(inner, [])}"
    if origin is dict:
        inner = get_args(annotation)[1]
        return "tables by name" if is_table(inner) else f"by name: {type_of(inner, [])}"
    if is_table(annotation):
        return "table"
    return _TYPES[annotation] + bounds(metadata)


def is_table(annotation: Any) -> bool:
    """Return True if a type is a table of the file."""
    return isinstance(bare(annotation), type) and issubclass(bare(annotation), Table)


def bounds(metadata: list[Any]) -> str:
    """Return the bounds of a number as text. The text is empty for the bounds that all numbers have."""
    flat = [each for one in metadata for each in (getattr(one, "metadata", None) or [one])]
    low = next((each.ge for each in flat if isinstance(each, Ge)), None)
    high = next((each.le for each in flat if isinstance(each, Le)), None)
    if low == LEAST and high == LARGEST:
        return " above 0"
    if low == 0 and high == LARGEST:
        return " from 0"
    if low is None or high is None or high == LARGEST:
        return ""
    return f" from {low:,g} to {high:,.10g}"
