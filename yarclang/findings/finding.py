"""What the catalogue says of one code."""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen

Severity = Literal["error", "warning", "note"]

Need = Literal["", "name", "meaning", "use", "default", "unit", "end", "block", "place"]
"""What an earlier or a damaged line should have given: a name; what a name stands for; the use of a name; what DEFAULT gives; the right unit; the END or the
first line of a block; the place where a motion leads. Empty: nothing."""

Sort = Literal["", "meeting", "time", "unreachable", "limits", "tolerance"]
"""What went wrong, where several findings share it: bodies meet or come too near; a time is too short; no configuration or way was found; the certificate has
broken limits, or a difference that is judged by the tolerance. Empty: no other finding shares it."""

_OF_PLACES = frozenset(["05", "06", "07", "08", "09"])
"""Families of what depends on where a motion leads."""


def family_of(code: str) -> str:
    """Return the two digits of the family of a code."""
    return code[1:3]


def number_of(code: str) -> int | None:
    """Return the four digits of a code as a number; None for a text that is no code."""
    digits = code[1:]
    is_code = code[:1] == "Y" and len(digits) == 4 and digits.isascii() and digits.isdigit()
    return int(digits) if is_code else None


@frozen
class Follows:
    """A finding by which another one is explained: one of this code, on the same line, on a line above, or on any other line."""

    code: str
    where: Literal["here", "above", "elsewhere"]


@frozen
class Finding:
    """A kind of finding.

    `code` is permanent: `Y` and four digits, the first two the family. `why` says what is
    wrong and why it matters at the machine; `example` shows it and `better` shows what to
    write instead (YARC source, or a line of robot.toml).

    The other fields say how it is related to others, so that one fault is said once.
    """

    code: str
    name: str
    severity: Severity
    title: str
    why: str
    example: str = ""
    better: str = ""
    needs: Need = ""
    """What a line with an error may have failed to give; read it by `need`."""
    follows: tuple[Follows, ...] = ()
    """Findings that explain this one, so that it needn't be said."""
    hides: Literal["", "names", "module"] = ""
    """What can't be seen because of it: the names that its line would use, or all names of a module."""
    sort: Sort = ""
    is_explained: bool = False
    """True if a rule's warning about the same command gives its reason, so that both are said as one."""
    tag: Literal["", "unneeded", "outdated"] = ""
    """How editors show the text: as something that could as well be taken away, or as something that is written otherwise today."""

    @property
    def family(self) -> str:
        """The two digits of the family."""
        return family_of(self.code)

    @property
    def anchor(self) -> str:
        """The anchor of its page among those of all findings."""
        return f"{self.code.lower()}-{self.name}"

    @property
    def need(self) -> Need:
        """What another line should have given; the place of a motion for all families that speak of one."""
        return self.needs or ("place" if self.family in _OF_PLACES else "")


def page(finding: Finding) -> str:
    """Return a finding's page in Markdown: what it means, an example, and a better one."""
    parts = [f"# {finding.code} {finding.name}", f"**{finding.severity}**: {finding.title}.", finding.why]
    for title, lines in (("For example", finding.example), ("Better", finding.better)):
        if lines:
            parts.append(f"{title}:\n\n```yarc\n{lines}\n```")
    return "\n\n".join(parts) + "\n"
