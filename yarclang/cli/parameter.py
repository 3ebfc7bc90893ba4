"""Base class of parameter types, with the value's type in brackets, which click supports only from 8.4 on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from click import ParamType
else:

    class ParamType(click.ParamType):
        """`click.ParamType`; the brackets are for the type checker alone."""

        def __class_getitem__(cls, value: object) -> type[ParamType]:
            """Return the class itself."""
            return cls


__all__ = ["ParamType"]
