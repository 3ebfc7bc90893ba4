"""A TOML file with the positions of its values, and the findings about it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from yarclang.diagnostics import Diagnostic
from yarclang.source import SourceFile
from yarclang.subjects import Name, Subject
from yarclang.toml.places import Path, Places


@dataclass(slots=True)
class TomlFile:
    """A TOML file and the findings about it.

    Attributes:
        source: text of the file.
        places: positions of the keys and values.
        findings: the findings so far.
    """

    source: SourceFile
    places: Places
    findings: list[Diagnostic] = field(default_factory=list)

    def say(
        self,
        code: str,
        path: Path,
        message: str,
        remedy: str,
        subject: Subject | None = None,
        *,
        at_key: bool = False,
    ) -> None:
        """Add a finding at the value of a key, or at the key itself.

        Args:
            code: code of the finding.
            path: path of the key.
            message: message of the finding.
            remedy: help of the finding.
            subject: subject of the finding.
            at_key: True for a finding at the key.
        """
        span = self.places.of_key(path) if at_key else self.places.of_value(path)
        self.findings.append(Diagnostic(code, message, self.source, span, remedy, subject=subject))


def right_length(
    file: TomlFile, path: Path, values: Sequence[object], size: int, what: str, per: str
) -> bool:
    """Check that a list has one entry for each joint or motor; report a finding if it hasn't.

    Args:
        file: the file.
        path: path of the list.
        values: the list.
        size: number of joints or motors.
        what: words for an entry, for the message.
        per: "joint" or "motor".

    Returns:
        True if the length is right.
    """
    if len(values) == size:
        return True
    last = path[-1]
    name = last if isinstance(last, str) else f"Row {last + 1} of {path[-2]}"
    message = f"{name} has {len(values)} {what}{'s' * (len(values) != 1)}, but the robot has {size} {per}s."
    file.say("Y1309", path, message, f"Write one {what} for each {per}, from the base to the flange.")
    return False


def did_you_mean(name: str, names: Iterable[str]) -> tuple[str, Name]:
    """Return two values for a finding about a wrong name: the help, which suggests similar names from
    `names`, and the subject, which is the wrong name.
    """
    known = sorted(names)
    near = difflib.get_close_matches(name, known, 1, 0.6)
    shown = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    listed = f"There {'are' if len(known) > 1 else 'is only'} {shown}." if known else "There is none."
    return (f"Did you mean {near[0]}? {listed}", Name(name, near[0])) if near else (listed, Name(name))
