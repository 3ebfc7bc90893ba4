"""Answers that the controller gave at the inspection before a run, and their comparison with later answers.
No I/O.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Question:
    """A line that asks the controller for one value or several.

    Attributes:
        subjects: for each value, what it is, in words.
        parts: for each value, the part of the line that asks for it.
    """

    subjects: tuple[str, ...]
    parts: tuple[str, ...]

    @property
    def line(self) -> str:
        """Return the line with all its parts."""
        return "".join(self.parts)


@dataclass(frozen=True, slots=True)
class Remembered:
    """A question to the controller, and the controller's answer at the inspection: one text for each
    value.
    """

    question: Question
    reply: tuple[str, ...]

    def compared(self, reply: tuple[str, ...]) -> str:
        """Compare a later answer to the same question with the answer at the inspection.

        Args:
            reply: the later answer.

        Returns:
            The values that differ, each as it was and as it is now, as a text; empty if none differs.
        """
        if reply == self.reply:
            return ""
        if len(self.question.parts) == 1:
            return f"{self.question.subjects[0]} has changed"
        if len(reply) != len(self.reply):
            return f"{len(reply)} values answer {self.question.line!r} instead of {len(self.reply)}"
        differences = [
            f"{_named(subject)} was {old}, and is {new}"
            for subject, old, new in zip(self.question.subjects, self.reply, reply, strict=True)
            if old != new
        ]
        return ", ".join(differences)


@dataclass(frozen=True, slots=True)
class Memory:
    """The controller's answers at the inspection, with which later answers are compared. While the robot
    moves, all questions of `often` are repeated every second, together with one question of `seldom`.
    """

    often: tuple[Remembered, ...] = ()
    seldom: tuple[Remembered, ...] = ()

    def value(self, variable: str) -> str:
        """Return the value of a variable at the inspection, as the controller printed it; empty if no
        question of `often` asks for it.
        """
        for one in self.often:
            if variable in one.question.parts:
                return one.reply[one.question.parts.index(variable)]
        return ""


def _named(subject: str) -> str:
    """Return the name of a setting, with its explanation in brackets."""
    name, comma, what = subject.partition(", ")
    return f"{name} ({what})" if comma else name
