"""What the forms of TOML files share: strict tables, and numbers within reason. Imports pydantic; import it late."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import BaseModel, ConfigDict, Field

LARGEST = 1e12
"""No number is larger, whatever its unit: beyond it, sums and products lose their digits."""
LEAST = 1e-6
"""The least size, speed, acceleration, jerk, tolerance."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Field(ge=LEAST, le=LARGEST)]


class Table(BaseModel):
    """A table of a file: strict types, no other keys.

    A required key is optional to pydantic and stands in `required`: so that a file with one bad value can still be checked in all
    that doesn't depend on it. `wanted` says in words what a key takes, where its type alone doesn't.
    Validators are built when first used: only that of the whole file is.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)
    required: ClassVar[tuple[str, ...]] = ()
    wanted: ClassVar[Mapping[str, str]] = {}


class Document(Table):
    """A whole file. `tables` has the table, or the kind of table, below each key; `examples` shows what to add where a key is missing."""

    tables: ClassVar[Mapping[str, type[Table]]] = {}
    examples: ClassVar[Mapping[str, str]] = {}
