"""What the catalogue says of one code."""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen

Severity = Literal["error", "warning", "note"]


@frozen
class Finding:
    """A kind of finding.

    `code` is permanent: `Y` and four digits, the first two the family. `why` says what is
    wrong and why it matters at the machine; `example` shows it and `better` shows what to
    write instead (YARC source, or a line of robot.toml).
    """

    code: str
    name: str
    severity: Severity
    title: str
    why: str
    example: str = ""
    better: str = ""

    @property
    def family(self) -> str:
        """The two digits of the family."""
        return self.code[1:3]
