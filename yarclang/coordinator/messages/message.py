"""What all messages have in common."""

from __future__ import annotations

from typing import Annotated, Any, Final

from pydantic import BaseModel, ConfigDict, Field

VERSION: Final = 1
"""Of the protocol. It grows when something that was understood before isn't understood any more."""

LARGEST: Final = 1e9
"""Largest magnitude of a number that somebody wants [mm, deg or per s]: beyond, the kinematics would overflow."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
"""A finite number of a size that can be reckoned with."""

Joints = dict[str, float]
"""Joint positions by their names, in the robot's axis units: deg, or mm."""


class Message(BaseModel):
    """A value that never changes, whose JSON form has these fields and no others."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )

    def to_json(self) -> dict[str, Any]:
        """Return the message as plain data."""
        return self.model_dump(mode="json")
