"""Write certificates as JSON, command by command, since a whole certificate wouldn't fit into memory.

A certificate of 100,000 commands takes 170 MB as JSON, and ten times as much as plain data in memory.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from yarclang.certify.certificate import Certificate

_NULL = "null\n}"
_NONE = "[]\n}"


def certificate_pieces(certificate: Certificate, *, ascii_only: bool = True) -> Iterator[str]:
    """Yield a certificate as JSON, in pieces of text. Joined, they are
    `json.dumps(certificate.to_json(), indent=2)`.

    Args:
        certificate: certificate to write.
        ascii_only: True to escape all characters that aren't ASCII.
    """
    whole = json.dumps({**certificate.whole_to_json(), "commands": []}, indent=2, ensure_ascii=ascii_only)
    if not certificate.commands:
        yield whole
        return
    yield whole.removesuffix(_NONE)
    begin = "["
    for command in certificate.commands:
        text = json.dumps(command.to_json(), indent=2, ensure_ascii=ascii_only)
        yield f"{begin}\n    {_indented(text, 4)}"
        begin = ","
    yield "\n  ]\n}"


def report_pieces(report: dict[str, Any], certificate: Certificate | None) -> Iterator[str]:
    """Yield a report as JSON, in pieces of text.

    Args:
        report: plain data.
        certificate: certificate that is written last, with the key `certificate`.
    """
    text = json.dumps({**report, "certificate": None}, indent=2, ensure_ascii=False)
    if certificate is None:
        yield text
        return
    yield text.removesuffix(_NULL)
    for piece in certificate_pieces(certificate, ascii_only=False):
        yield _indented(piece, 2)
    yield "\n}"


def reports_pieces(reports: list[tuple[dict[str, Any], Certificate | None]]) -> Iterator[str]:
    """Yield the document that `--format json` prints, in pieces of text: the report about each file, with its
    certificate.
    """
    yield '{\n  "version": 1,\n  "files": ['
    begin = ""
    for report, certificate in reports:
        yield f"{begin}\n    "
        for piece in report_pieces(report, certificate):
            yield _indented(piece, 4)
        begin = ","
    yield "\n  ]\n}\n"


def _indented(text: str, spaces: int) -> str:
    """Return lines of JSON with more indentation. Strings in these lines must not have line breaks."""
    return text.replace("\n", f"\n{' ' * spaces}")
