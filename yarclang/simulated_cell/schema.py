"""Schema of a script of inputs: its keys and types. This module imports pydantic; import it late."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from yarclang.toml.tables import Document, Table

Value = Annotated[float, Field(ge=-1e9, le=1e9)]
Delay = Annotated[float, Field(ge=0.0, le=1e6)]
Pause = Annotated[float, Field(ge=0.001, le=1e6)]
"""Time between two changes of an input [s]. A controller wouldn't notice a shorter time."""


class InputTable(Table):
    """Table `[[inputs]]`."""

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


Lying = Annotated[float, Field(ge=-1e5, le=1e5)]
"""Coordinate of a place [mm or deg]."""


class CameraTable(Table):
    """Table `[[cameras]]`: the part to look for, the frame of its position, and registers for the values."""

    required = ("part", "frame")
    name: str = "camera"
    part: str | None = None
    frame: str | None = None
    found: str | None = None
    x: str | None = None
    y: str | None = None
    z: str | None = None
    rz: str | None = None
    unit: Annotated[float, Field(ge=1e-6, le=1e6)] = 0.01
    delay: Delay = 0.1
    lies: list[Annotated[list[Lying], Field(min_length=4, max_length=4)]] = Field(default=[])
    does: list[Literal["answer", "nothing", "late", "twice", "far", "nonsense"]] = Field(default=[])


class ScriptTable(Document):
    """A whole script file."""

    inputs: list[InputTable] = Field(default=[])
    cameras: list[CameraTable] = Field(default=[])
    wanted: ClassVar = {
        "inputs": "tables, each under [[inputs]]",
        "cameras": "tables, each under [[cameras]]",
        "lies": "lists of x, y, z [mm] and rz [deg], one for each part: [[10, -5, 0, 12]]",
        "does": "a list of answer, nothing, late, twice, far and nonsense, one for each question",
    }
    tables: ClassVar = {"inputs": InputTable, "cameras": CameraTable}
    examples: ClassVar = {
        "input": 'for example input = "PART_READY".',
        "to": 'to = "ON", "OFF" or a number.',
        "part": 'for example part = "BOX", one of the [[parts]] of the cell.',
        "frame": 'for example frame = "TRAY", one of the [frames] of the cell.',
    }
