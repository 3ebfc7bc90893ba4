"""Carry out CALL: find the SUB and bind its parameters to the arguments."""

from __future__ import annotations

from dataclasses import dataclass, field

from yarclang.diagnostics import Collector
from yarclang.semantics.control.arguments import Given
from yarclang.semantics.control.parameters import bind, given_by
from yarclang.semantics.files import File, Sub, values_of
from yarclang.semantics.names.scope import KINDS, Library, Routine, Scope
from yarclang.source import Span
from yarclang.subjects import unknown
from yarclang.syntax.ast import Statement, Word


@dataclass(slots=True)
class Calls:
    """The SUBs that are being carried out, from the outermost to the innermost, and their arguments."""

    _subs: list[Sub] = field(default_factory=list)
    _given: list[Given] = field(default_factory=list)

    @property
    def given(self) -> Given:
        """Arguments of the innermost SUB; empty outside of SUBs."""
        return self._given[-1] if self._given else {}

    def begin(self, statement: Statement, file: File, scope: Scope) -> tuple[Sub, Scope] | None:
        """Enter the SUB of a CALL; `end` leaves it again.

        Args:
            statement: the CALL.
            file: the file of the CALL.
            scope: the names in scope at the CALL.

        Returns:
            The SUB, and the scope of its body with its parameters; None with a finding if the CALL is wrong.
        """
        sub = self._meant(statement, file, scope)
        if sub is None:
            return None
        inner = bind(statement, scope, file.findings, sub)
        if inner is None:
            return None
        head, source = sub.block.head, sub.file.findings.source
        self._subs.append(sub)
        self._given.append(given_by(statement, file.findings.source, head, source, self.given))
        return sub, inner

    def end(self) -> None:
        """Leave the innermost SUB."""
        self._given.pop()
        self._subs.pop().file.findings.place = ""

    def _meant(self, statement: Statement, file: File, scope: Scope) -> Sub | None:
        findings = file.findings
        values = values_of(statement)
        if not values or not isinstance(word := values[0], Word):
            findings.add(
                "Y0401",
                "CALL needs the name of a SUB",
                statement.whole_span,
                "for example CALL DRILL {HOLE} 20",
            )
            return None
        found = scope.name(word.name)
        span = statement.span(word.place)
        if not isinstance(found, Routine) or not isinstance(sub := found.sub, Sub):
            if found is not None:
                findings.add("Y0209", f"{word.text} is {KINDS[type(found)]}, not a SUB", span)
            elif any(one.name == word.name and one.file is file for one in self._subs):
                self._refuse_recursion(word, span, findings)
            else:
                known = sorted(set(scope.names_with_modules(Routine)))
                subject = unknown(word.text, known)
                module, dot, _ = word.name.rpartition(".")
                help_ = subject.question or (
                    f"there are {', '.join(known)}" if known else f"write SUB {word.name}, its lines and END"
                )
                if dot and not subject.question and not isinstance(scope.name(module), Library):
                    help_ = f"write USE {module} above if it is a module"
                findings.add("Y0210", f"no SUB is named {word.text}", span, help_, subject=subject)
            return None
        if sub in self._subs:
            self._refuse_recursion(word, span, findings)
            return None
        return sub

    def _refuse_recursion(self, word: Word, span: Span, findings: Collector) -> None:
        names = [one.name for one in self._subs]
        through = names[names.index(word.name.rpartition(".")[2]) + 1 :]
        how = f"{word.text} calls itself" + (f" through {', '.join(through)}" if through else "")
        findings.add("Y0212", how, span, "a SUB must end: write its repeated lines in a REPEAT")
