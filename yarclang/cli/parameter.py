"""Base class for click's parameter types that accepts the type of the value in square brackets, as in
`ParamType[int]`. click itself supports this only from 8.4 on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from click import ParamType
else:

    class ParamType(click.ParamType):
        """`click.ParamType` with brackets, which only the type checker uses."""

        def __class_getitem__(cls, value: object) -> type[ParamType]:
            """Return the class itself."""
            return cls


__all__ = ["ParamType"]
