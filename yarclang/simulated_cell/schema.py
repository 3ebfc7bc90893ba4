"""The form of a script of inputs: its keys and types. This module imports pydantic; import it late."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from yarclang.toml.tables import Document, Table

Value = Annotated[float, Field(ge=-1e9, le=1e9)]
Delay = Annotated[float, Field(ge=0.0, le=1e6)]
Pause = Annotated[float, Field(ge=0.001, le=1e6)]
"""A shorter one is over before a controller has looked."""


class InputTable(Table):
    """`[[inputs]]`."""

    required = ("input", "to")
    wanted: ClassVar = {
        "to": '"ON", "OFF" or a number',
        "stuck": "true or false",
        "toggle": "two times in [brackets], s",
    }
    input: str | None = None
    to: Value | None = None
    at: Delay | None = None
    place: str | None = None
    output: str | None = None
    delay: Delay = 0.0
    toggle: list[Pause] | None = None
    stuck: bool | None = None


class ScriptTable(Document):
    """The whole file."""

    inputs: list[InputTable] = Field(default=[])
    wanted: ClassVar = {"inputs": "tables, each under [[inputs]]"}
    tables: ClassVar = {"inputs": InputTable}
    examples: ClassVar = {
        "input": 'for example input = "PART_READY".',
        "to": 'to = "ON", "OFF" or a number.',
    }
