"""Base class and common types of all messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler

from yarclang.coordinator.messages.field_texts import field_texts

if TYPE_CHECKING:
    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import CoreSchema

VERSION: Final = 1
"""Version of the protocol. It increases when messages of the previous version are no longer understood."""

LARGEST: Final = 1e9
"""Largest absolute value of a number in an order [mm, deg or per s]. Larger numbers could overflow in the
kinematics.
"""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
"""A finite number whose absolute value is at most `LARGEST`."""

Joints = dict[str, float]
"""Joint positions by the names of the joints, in the robot's axis units: deg or mm."""


class Message(BaseModel):
    """Base class of messages, which are immutable. Their JSON form has exactly their fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the schema with the docstrings of the fields."""
        made = handler(schema)
        properties = handler.resolve_ref_schema(made).get("properties", {})
        for name, text in field_texts(cls).items():
            if name in properties:
                properties[name].setdefault("description", text)
        return made

    def to_json(self) -> dict[str, Any]:
        """Return the message as plain data for JSON."""
        return self.model_dump(mode="json")


class RegisterRange(Message):
    """A register that accepts integers from `low` to `high`."""

    name: str
    low: int
    high: int


class ValuesWanted(Message):
    """Values that a program accepts from outside while it waits. An order `fill` answers question `number`,
    and must contain all registers that are `needed`. `place` is the command that waits.
    """

    number: int
    place: str
    registers: tuple[RegisterRange, ...]
    needed: tuple[str, ...]


class Question(Message):
    """A question to the operator for an integer from `low` to `high`, which is stored in the register
    `into`.
    """

    text: str
    into: str
    low: int
    high: int
