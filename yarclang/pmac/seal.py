"""The seal of a controller text: a hash that shows damage and edits. It is no signature."""

from __future__ import annotations

import hashlib
import re

from yarclang.pmac.header import UNSEALED

_CERTIFICATE = f"\n; certificate {UNSEALED}\n"
_UNSEALED = f"\n; sha256 {UNSEALED}\n"
_SEAL = re.compile(r"\n; sha256 ([0-9a-f]{64})\n")


def sealed(text: str, certificate: str) -> str:
    """Return a judged text with the certificate's summary and the seal in its header.

    Args:
        text: with `UNSEALED` in place of both.
        certificate: the summary, one line of ASCII.
    """
    certified = text.replace(_CERTIFICATE, f"\n; certificate {certificate}\n", 1)
    return certified.replace(_UNSEALED, f"\n; sha256 {_hash(certified)}\n", 1)


def is_sealed(text: str) -> bool:
    """Return True if a text is as it was when it was sealed."""
    found = _SEAL.search(text)
    return found is not None and _hash(_SEAL.sub(_UNSEALED, text, count=1)) == found[1]


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("ascii", "replace")).hexdigest()
