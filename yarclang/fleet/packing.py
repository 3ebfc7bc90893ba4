"""Conversion of the compiler's values to bytes, for other processes, other machines and the cache.

The bytes are a pickle: whoever can write a pickle can run code. So bytes are accepted only from processes
that this process has started or was told to use, and from a cache whose entries have an authentication code
that only their user can compute (store.py).
"""

from __future__ import annotations

import copyreg
import io
import pickle
from types import MappingProxyType
from typing import Any


def packed(value: Any) -> bytes:
    """Return a value as bytes."""
    buffer = io.BytesIO()
    pickler = pickle.Pickler(buffer, protocol=5)
    pickler.dispatch_table = copyreg.dispatch_table.copy()
    pickler.dispatch_table[MappingProxyType] = _reduced
    pickler.dump(value)
    return buffer.getvalue()


def unpacked(content: bytes) -> Any:
    """Return the value that bytes contain. The bytes must come from a trusted source."""
    return pickle.loads(content)


def _reduced(mapping: MappingProxyType[Any, Any]) -> tuple[Any, tuple[dict[Any, Any]]]:
    return _read_only, (dict(mapping),)


def _read_only(mapping: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(mapping)
