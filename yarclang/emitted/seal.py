"""The seal of a controller text: a hash that shows damage and edits. It is no signature."""

from __future__ import annotations

import hashlib
import re

from yarclang.emitted.header import UNSEALED

_CERTIFICATE = f"\n; certificate {UNSEALED}\n"
_UNSEALED = f"\n; sha256 {UNSEALED}\n"
_SEAL = re.compile(r"\n; sha256 ([0-9a-f]{64})\n")


def sealed(text: str, certificate: str) -> str:
    """Return a controller text that was checked, with the certificate's summary and the seal in its header.

    Args:
        text: the text, with `UNSEALED` in place of the summary and of the seal.
        certificate: the summary, one line of ASCII.
    """
    # Only the header changes, so that a long text is copied only once.
    end = max(text.find(mark) + len(mark) for mark in (_CERTIFICATE, _UNSEALED))
    header = text[:end].replace(_CERTIFICATE, f"\n; certificate {certificate}\n", 1)
    return header.replace(_UNSEALED, f"\n; sha256 {_hash(header, text[end:])}\n", 1) + text[end:]


def is_sealed(text: str) -> bool:
    """Return True if a controller text is unchanged since it was sealed."""
    found = _SEAL.search(text)
    return found is not None and _hash(_SEAL.sub(_UNSEALED, text, count=1)) == found[1]


_AT_ONCE = 1 << 20
"""Number of characters that are encoded in one step."""


def _hash(*texts: str) -> str:
    """Return the SHA-256 of the concatenated texts, as 64 hex digits."""
    digest = hashlib.sha256()
    for text in texts:
        for begin in range(0, len(text), _AT_ONCE):
            digest.update(text[begin : begin + _AT_ONCE].encode("ascii", "replace"))
    return digest.hexdigest()
