"""What a controller answered when it was looked at, to be compared with what it answers later. No I/O."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Question:
    """What can be asked in one line: of each part, what it is called and how it is asked."""

    subjects: tuple[str, ...]
    parts: tuple[str, ...]

    @property
    def line(self) -> str:
        """The line."""
        return "".join(self.parts)


@dataclass(frozen=True, slots=True)
class Remembered:
    """A question, and what was answered when the controller was looked at."""

    question: Question
    reply: tuple[str, ...]

    def compared(self, reply: tuple[str, ...]) -> str:
        """Return what is otherwise now, with the old and the new value; empty where nothing is."""
        if reply == self.reply:
            return ""
        if len(self.question.parts) == 1:
            return f"{self.question.subjects[0]} is another one than before"
        if len(reply) != len(self.reply):
            return f"{len(reply)} values answer {self.question.line!r} instead of {len(self.reply)}"
        told = [
            f"{_named(subject)} was {old}, and is {new}"
            for subject, old, new in zip(self.question.subjects, self.reply, reply, strict=True)
            if old != new
        ]
        return ", ".join(told)


@dataclass(frozen=True, slots=True)
class Memory:
    """What a controller answered when it was looked at: `often` is asked each second, of `seldom` one each second."""

    often: tuple[Remembered, ...] = ()
    seldom: tuple[Remembered, ...] = ()

    def value(self, variable: str) -> str:
        """Return what a variable was, as it was printed; empty if nobody has asked."""
        for one in self.often:
            if variable in one.question.parts:
                return one.reply[one.question.parts.index(variable)]
        return ""


def _named(subject: str) -> str:
    """A name with what it is in brackets, so that a sentence goes on behind it."""
    name, comma, what = subject.partition(", ")
    return f"{name} ({what})" if comma else name
