"""Base classes of schemas of TOML files: strict tables, bounded numbers. This imports pydantic, so import
it late.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import BaseModel, ConfigDict, Field

LARGEST = 1e12
"""Largest number, in any unit. Sums and products of larger numbers lose digits."""
LEAST = 1e-6
"""Smallest size, speed, acceleration, jerk and tolerance."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Field(ge=LEAST, le=LARGEST)]


class Table(BaseModel):
    """A table of a file, with strict types. Unknown keys are errors.

    Required keys are optional for pydantic, so that a file with a missing or wrong value can still be
    checked. Validators are built only when they are first used, because only the validator of the whole file
    is needed.

    Attributes:
        required: the required keys.
        wanted: descriptions of the values of keys, if their type alone isn't clear.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)
    required: ClassVar[tuple[str, ...]] = ()
    wanted: ClassVar[Mapping[str, str]] = {}


class Document(Table):
    """A whole file.

    Attributes:
        tables: the class of the table, or of each of several tables, that belongs to each key.
        examples: text to add for missing keys.
    """

    tables: ClassVar[Mapping[str, type[Table]]] = {}
    examples: ClassVar[Mapping[str, str]] = {}
