"""Entries of the catalogue of findings, and relations between them."""

from __future__ import annotations

from typing import Literal

from yarclang.frozen import frozen

Severity = Literal["error", "warning", "note"]

Need = Literal["", "name", "meaning", "use", "default", "unit", "end", "block", "place"]
"""Information that a finding needs, and that is missing if another line is invalid: a name; the meaning of a
name; the use of a name; the value of DEFAULT; the right unit; the END or the first line of a block; the end
of a motion. Empty for none.
"""

Sort = Literal["", "meeting", "time", "unreachable", "limits", "tolerance"]
"""Kind of fault that several findings have in common: bodies collide or come too near; a time is too short;
no configuration or path was found; the certificate exceeds limits; the certificate finds a deviation above
the tolerance. Empty for none.
"""

_OF_PLACES = frozenset(["05", "06", "07", "08", "09"])
"""Families of findings that depend on the end of a motion."""


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
    """A relation between two kinds of findings: one explains the other.

    Attributes:
        code: code of the explaining finding.
        where: line of the explaining finding, seen from the explained one: the same line, a line above, or
            any other line.
    """

    code: str
    where: Literal["here", "above", "elsewhere"]


@frozen
class Finding:
    """A kind of finding (an error, a warning or a note) in the catalogue.

    Most fields after `better` relate findings to each other, so that a fault is reported only once.

    Attributes:
        code: permanent code: `Y` and four digits, of which the first two are the family.
        name: name by which users select the finding.
        severity: severity of the finding.
        title: heading of the finding.
        why: explanation of the fault, and of its effect at the machine.
        example: a text with the fault (YARC source, or a line of robot.toml).
        better: the corrected text.
        needs: information that may be missing because of an invalid line; use `need` to read it.
        follows: findings that explain this one. It isn't reported beside them.
        hides: what is unknown because of this finding: the names that its line would use, or all names of a
            module.
        sort: kind of fault that several findings have in common.
        is_explained: True if a rule's warning about the same command gives the reason, so that both are
            reported as one.
        tag: style in editors: that of superfluous text, or of an outdated form.
    """

    code: str
    name: str
    severity: Severity
    title: str
    why: str
    example: str = ""
    better: str = ""
    needs: Need = ""
    follows: tuple[Follows, ...] = ()
    hides: Literal["", "names", "module"] = ""
    sort: Sort = ""
    is_explained: bool = False
    tag: Literal["", "unneeded", "outdated"] = ""

    @property
    def family(self) -> str:
        """The two digits of the finding's family."""
        return family_of(self.code)

    @property
    def anchor(self) -> str:
        """Anchor of the finding's section on the page of all findings."""
        return f"{self.code.lower()}-{self.name}"

    @property
    def need(self) -> Need:
        """Information that the finding needs, and that may be missing because of another line. If `needs` is
        empty, findings of the families about places need the end of a motion.
        """
        return self.needs or ("place" if self.family in _OF_PLACES else "")


def page(finding: Finding) -> str:
    """Return a finding's page in Markdown: its meaning, an example, and a better text."""
    parts = [f"# {finding.code} {finding.name}", f"**{finding.severity}**: {finding.title}.", finding.why]
    for title, lines in (("For example", finding.example), ("Better", finding.better)):
        if lines:
            parts.append(f"{title}:\n\n```yarc\n{lines}\n```")
    return "\n\n".join(parts) + "\n"
