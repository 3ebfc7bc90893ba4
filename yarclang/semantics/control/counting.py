"""Count the commands of loops and calls, and the rounds of loops, before they are carried out.

If all rounds of a loop are alike, one round is counted, and the count is multiplied by the number of rounds.
A SUB is counted once for all calls with equal arguments. Rounds that differ are counted one by one until the
limit is exceeded. Before that, a lower bound for one round is multiplied by the number of rounds. If this
product exceeds the limit, the rounds aren't counted.
"""

from __future__ import annotations

from collections.abc import Iterator

from yarclang.decisions import Register
from yarclang.diagnostics import Collector, FindingError
from yarclang.frozen import frozen
from yarclang.progress import tell
from yarclang.semantics.control.arguments import names_in
from yarclang.semantics.control.conditional import KnownBehind
from yarclang.semantics.control.matching import arguments_by_name
from yarclang.semantics.control.parameters import bind_some
from yarclang.semantics.control.repeats import AT_MOST, MOST_COMMANDS, MOST_ROUNDS, counted, repeats
from yarclang.semantics.files import File, Sub, values_of
from yarclang.semantics.names.scope import Routine, Scope
from yarclang.semantics.values.amounts import Amount
from yarclang.semantics.values.evaluate import EvaluationError, evaluate
from yarclang.source import SourceFile
from yarclang.syntax.ast import Block, Computed, Node, Statement, Word
from yarclang.syntax.words import DECLARATIONS

MOST_LINES = 2 * MOST_COMMANDS
"""Largest number of lines that a program carries out, including declarations; a long line counts as several.
"""

LINE = 120
"""Number of characters that count as one line."""

DEEPEST = 150
"""Largest depth of nested blocks and calls."""

_EVERY = 1000
"""Number of rounds after which the limit is checked again and progress is reported."""

_FAULTS = 20
"""Number of mistakes after which counting stops. The mistakes are reported when the lines are carried out."""


@frozen
class Count:
    """Numbers of commands, lines and rounds of loops when a group of lines is carried out."""

    commands: int = 0
    lines: int = 0
    rounds: int = 0

    @property
    def is_too_much(self) -> bool:
        """True if a count exceeds its limit for a whole program."""
        return self.commands > MOST_COMMANDS or self.rounds > MOST_ROUNDS or self.lines > MOST_LINES

    def __add__(self, other: Count) -> Count:
        return Count(self.commands + other.commands, self.lines + other.lines, self.rounds + other.rounds)

    def __rmul__(self, number: int) -> Count:
        return Count(number * self.commands, number * self.lines, number * self.rounds)


_Tally = tuple[int, int, int, int]
"""Commands, lines, rounds, and the depth of nested blocks and calls."""

_NOTHING = (0, 0, 0, 0)


class TooMuch(FindingError):  # noqa: N818 - ends the counting, and becomes a finding
    """The error that a program exceeds a limit on commands, lines or rounds.

    Attributes:
        file: the file of `statement`.
        statement: the line that the finding is about.
        code: code of the finding.
        message: message of the finding.
        help: remedy.
    """

    def __init__(self, file: File, statement: Statement, code: str, message: str, help_: str) -> None:
        super().__init__(code, message, help_)
        self.file = file
        self.statement = statement


class Counter:
    """Counter of the commands, lines and rounds of a program's blocks and calls.

    Args:
        most: largest number of rounds that are counted one by one; None: no limit.
    """

    def __init__(self, most: int | None = None) -> None:
        self._most = most
        self._one_by_one = 0
        self._differing = 0
        """Number of loops around the current line whose rounds differ."""
        self._sizes: dict[int, int] = {}
        self._read: dict[int, frozenset[str]] = {}
        self._subs: dict[tuple[Sub, tuple[object, ...]], _Tally] = {}
        self._inside: list[Sub] = []
        self._reading = 0
        self._faults = 0
        self._behind = KnownBehind()

    def count(self, node: Node, file: File, scope: Scope, depth: int) -> Count:
        """Count the commands, lines and rounds of a block or a CALL.

        Args:
            node: the block or CALL.
            file: file of the block or CALL.
            scope: the names in scope there.
            depth: number of blocks and calls around it.

        Returns:
            The count. Lines with mistakes count as nothing.

        Raises:
            TooMuch: the count exceeds a limit of programs.
            Uncounted: there are too many mistakes, or too many differing rounds.
        """
        self._faults = self._differing = 0
        self._inside.clear()
        commands, lines, rounds, _ = self._node(node, file, scope, depth, self._needed((node,), scope))
        return Count(commands, lines, rounds)

    def size(self, statement: Statement, source: SourceFile) -> int:
        """Return the number of lines for which a statement counts: one more for every `LINE` characters."""
        size = self._sizes.get(id(statement))
        if size is None:
            first = statement.line - 1
            characters = sum(map(len, source.lines[first : first + statement.rows]))
            size = self._sizes[id(statement)] = 1 + characters // LINE
        return size

    def _nodes(
        self, nodes: tuple[Node, ...], file: File, scope: Scope, depth: int, needed: frozenset[str]
    ) -> _Tally:
        commands, lines, rounds, deepest = 0, 0, 0, 0
        source = file.findings.source
        for node in nodes:
            if isinstance(node, Statement):
                if node.index is None and node.name.name in DECLARATIONS:
                    lines += self.size(node, source)
                    self._declare(node, scope, needed)
                    continue
                if node.name.name != "CALL":
                    commands, lines = commands + 1, lines + self.size(node, source)
                    continue
            more = self._node(node, file, scope, depth, needed)
            commands, lines, rounds = commands + more[0], lines + more[1], rounds + more[2]
            deepest = max(deepest, more[3])
            if commands > MOST_COMMANDS or lines > MOST_LINES or rounds > MOST_ROUNDS:
                raise _too_many_together(file, _head(node), Count(commands, lines, rounds))
        return commands, lines, rounds, deepest

    def _node(self, node: Node, file: File, scope: Scope, depth: int, needed: frozenset[str]) -> _Tally:
        """Count a block or a CALL that is nested in `depth` others."""
        if depth >= DEEPEST:
            raise too_deep(file, _head(node))
        head = _head(node)
        size = self.size(head, file.findings.source)
        if isinstance(node, Statement):
            commands, lines, rounds, deepest = self._call(node, file, scope, depth)
            return commands + 1, lines + size, rounds, deepest + 1
        match head.name.name:
            case "REPEAT":
                commands, lines, rounds, deepest = self._repeat(node, file, scope, depth, needed)
            case "IF":
                commands, lines, rounds, deepest = self._if(node, file, scope, depth, needed)
            case "WHEN" | "CASE" | "LOOP" | "WHILE" | "WAIT" | "OFFSET" | "KEEP" as word:
                both = (*node.body, *(node.otherwise or ()))
                commands, lines, rounds, deepest = self._nodes(both, file, Scope(scope), depth + 1, needed)
                commands += _ofs(node) if word == "CASE" else int(word != "KEEP")
            case _:
                return _NOTHING
        return commands, lines + size, rounds, deepest + 1

    def _if(self, block: Block, file: File, scope: Scope, depth: int, needed: frozenset[str]) -> _Tally:
        assert block.head.expression is not None
        try:
            holds = bool(evaluate(block.head.expression, scope).value)
        except EvaluationError:
            return self._fault()
        chosen = block.body if holds else block.otherwise
        if not chosen:
            return _NOTHING
        inner = Scope(scope)
        tally = self._nodes(chosen, file, inner, depth + 1, needed)
        scope.take_over(inner, self._behind.of(block))
        return tally

    def _repeat(self, block: Block, file: File, scope: Scope, depth: int, needed: frozenset[str]) -> _Tally:
        head = block.head
        word, values = counted(head)
        if word is not None and not values and isinstance(scope.name(word.name), Register):
            commands, lines, rounds, deepest = self._nodes(block.body, file, Scope(scope), depth + 1, needed)
            return commands + 1, lines, rounds, deepest
        number = repeats(head, values, scope, Collector(file.findings.source))
        if number is None:
            return self._fault()
        if not number:
            return _NOTHING
        inner = Scope(scope)
        if word is None or word.name not in self._needed(block.body, scope):
            if word is not None:
                inner.declare(word.name, Amount(0.0))
            commands, lines, rounds, deepest = self._nodes(block.body, file, inner, depth + 1, needed)
            one = Count(max(1, commands), lines + 1, rounds + 1)
            if (number * one).is_too_much:
                raise _too_many_alike(file, head, number, one)
            return number * one.commands, number * one.lines, number * one.rounds, deepest
        if not self._differing and (number * (least := self._least_round(block, file, scope))).is_too_much:
            raise _too_many_alike(file, head, number, least, "at least ")
        self._differing += 1
        commands, lines, rounds, deepest = 0, 0, 0, 0
        for done in range(number):
            inner = Scope(scope)
            inner.declare(word.name, Amount(float(done)))
            more = self._nodes(block.body, file, inner, depth + 1, needed)
            commands, lines, rounds = commands + (more[0] or 1), lines + more[1] + 1, rounds + more[2] + 1
            deepest = max(deepest, more[3])
            if commands > MOST_COMMANDS or lines > MOST_LINES or rounds > MOST_ROUNDS:
                raise _too_many_rounds(file, head, done + 1, number, Count(commands, lines, rounds))
            self._one_by_one += 1
            if self._one_by_one % _EVERY == 0:
                self._look()
        self._differing -= 1
        return commands, lines, rounds, deepest

    def _least_round(self, block: Block, file: File, scope: Scope) -> Count:
        """Return a lower bound for the commands and lines of one round of a REPEAT. Only names in scope
        before the REPEAT are used.
        """
        least = self._least(block.body, file, scope) + Count(lines=1, rounds=1)
        return least if least.commands else least + Count(commands=1)

    def _least(self, nodes: tuple[Node, ...], file: File, scope: Scope) -> Count:
        """Return a lower bound for the commands of a group of lines. A CALL, and a loop whose number of
        rounds isn't known yet, count as one line.
        """
        total, source = Count(), file.findings.source
        for node in nodes:
            head = _head(node)
            word = head.name.name
            is_command = isinstance(node, Statement) and (head.index is not None or word not in DECLARATIONS)
            total += Count(int(is_command), self.size(head, source))
            if not isinstance(node, Block):
                continue
            if word == "IF":
                ways = [self._least(way, file, scope) for way in (node.body, node.otherwise or ())]
                total += Count(
                    min(way.commands for way in ways),
                    min(way.lines for way in ways),
                    min(way.rounds for way in ways),
                )
            elif word == "REPEAT":
                number = repeats(head, counted(head)[1], scope, Collector(source))
                total += (number or 0) * self._least_round(node, file, scope)
            elif word in ("WHEN", "CASE", "LOOP", "WHILE", "WAIT", "OFFSET", "KEEP"):
                total += Count(_ofs(node) if word == "CASE" else int(word != "KEEP")) + self._least(
                    (*node.body, *(node.otherwise or ())), file, scope
                )
        return total

    def _look(self) -> None:
        if self._most is not None and self._one_by_one > self._most:
            raise Uncounted
        tell("counting the rounds of loops", self._one_by_one)

    def _call(self, statement: Statement, file: File, scope: Scope, depth: int) -> _Tally:
        values = values_of(statement)
        found = scope.name(values[0].name) if values and isinstance(values[0], Word) else None
        sub = found.sub if isinstance(found, Routine) else None
        if not isinstance(sub, Sub) or sub in self._inside:
            return self._fault()
        needed = self._needed(sub.block.body, sub.scope)
        bound = bind_some(statement, scope, file.findings.source, sub, needed)
        if bound is None:
            return self._fault()
        inner, given = bound
        tally = self._subs.get((sub, given))
        if tally is None:
            self._inside.append(sub)
            before = self._faults
            tally = self._nodes(sub.block.body, sub.file, inner, depth + 1, needed)
            self._inside.pop()
            if self._faults == before:  # don't cache a count with mistakes: it may depend on the callers
                self._subs[sub, given] = tally
        if depth + tally[3] >= DEEPEST:
            raise too_deep(file, statement)
        return tally

    def _declare(self, statement: Statement, scope: Scope, needed: frozenset[str]) -> None:
        """Carry out a LET if a number of rounds depends on its value."""
        if statement.name.name != "LET" or statement.expression is None:
            return
        (word,) = values_of(statement)
        if isinstance(word, Word) and word.name in needed:
            try:
                scope.declare(word.name, evaluate(statement.expression, scope))
            except EvaluationError:
                scope.declare(word.name, Amount(1.0))  # the value that `declare_number` gives to a wrong LET

    def _fault(self) -> _Tally:
        """Count a line with a mistake as nothing.

        Raises:
            Uncounted: there are too many mistakes.
        """
        self._faults += 1
        if self._faults > _FAULTS:
            raise Uncounted
        return _NOTHING

    def _needed(self, nodes: tuple[Node, ...], scope: Scope) -> frozenset[str]:
        """Return the names that determine how many commands a group of lines carries out."""
        key = id(nodes) if len(nodes) != 1 else id(nodes[0])
        found = self._read.get(key)
        if found is None:
            if self._reading > DEEPEST:  # the calls are nested too deep: the count ends with an error anyway
                return frozenset()
            self._read[key] = frozenset()  # ends the recursion of a SUB that calls itself
            self._reading += 1
            found = self._read[key] = self._names(nodes, scope)
            self._reading -= 1
        return found

    def _names(self, nodes: tuple[Node, ...], scope: Scope) -> frozenset[str]:
        names: set[str] = set()
        # Go backwards: the names in a LET are needed only if the name that the LET declares is needed further
        # down.
        for node in _backwards(nodes):
            word = node.name.name
            if word in ("REPEAT", "IF"):
                names.update(_names_in(node))
            elif word == "CALL":
                names.update(self._names_given(node, scope))
            elif (
                word == "LET"
                and node.index is None
                and any(one.text.upper() in names for one in values_of(node))
            ):
                names.update(_names_in(node))
        return frozenset(names)

    def _names_given(self, statement: Statement, scope: Scope) -> Iterator[str]:
        """Yield the names in those arguments of a CALL on which the number of commands in its SUB depends."""
        values = values_of(statement)
        found = scope.name(values[0].name) if values and isinstance(values[0], Word) else None
        if not isinstance(found, Routine) or not isinstance(sub := found.sub, Sub):
            return
        needed = self._needed(sub.block.body, sub.scope)
        for name, value in arguments_by_name(statement, sub.block.head).items():
            if name in needed and isinstance(value, Computed):
                yield from names_in(value.expression)


class Uncounted(Exception):  # noqa: N818 - ends the counting
    """The error that counting was given up: there are too many mistakes, or too many differing rounds."""


def _ofs(case: Block) -> int:
    """Return the number of OF lines of a CASE."""
    return sum(isinstance(one, Statement) and one.name.name == "OF" for one in case.body)


def _head(node: Node) -> Statement:
    return node.head if isinstance(node, Block) else node


def _backwards(nodes: tuple[Node, ...]) -> Iterator[Statement]:
    """Yield the statements of a group of lines and of the blocks in it, from the last to the first."""
    for node in reversed(nodes):
        if isinstance(node, Block):
            yield from _backwards(node.otherwise or ())
            yield from _backwards(node.body)
            yield node.head
        else:
            yield node


def _names_in(statement: Statement) -> Iterator[str]:
    """Yield the names in the expressions of a REPEAT, IF or LET."""
    if statement.expression is not None:
        yield from names_in(statement.expression)
    for value in values_of(statement):
        if isinstance(value, Computed):
            yield from names_in(value.expression)


def _too_many_together(file: File, statement: Statement, count: Count) -> TooMuch:
    """Return the error that a loop or SUB exceeds a limit with its lines up to a statement."""
    what, most = _excess(count)
    message = f"with this {statement.name.name} the lines around it make {what}; {most}"
    return TooMuch(file, statement, "Y1004", message, SHORTER)


def _too_many_alike(file: File, head: Statement, number: int, one: Count, about: str = "") -> TooMuch:
    """Return the error that a REPEAT whose rounds are all alike exceeds a limit.

    Args:
        file: the file.
        head: the REPEAT line.
        number: number of rounds.
        one: count of one round.
        about: words before the counts, such as "at least ".
    """
    what, most = _excess(number * one)
    fit = min(MOST_COMMANDS // one.commands, MOST_LINES // one.lines, MOST_ROUNDS // one.rounds)
    help_ = f"at most {fit:,} round{'s fit' if fit != 1 else ' fits'}: {SHORTER}"
    if (number * one).commands > MOST_COMMANDS:
        each = f" of {about}{_number(one.commands, 'command')}"
    elif (number * one).rounds > MOST_ROUNDS:
        each = f", each around {about}{_number(one.rounds - 1, 'other')},"
    else:
        each = f" of {about}{_number(one.lines, 'line')}"
    message = f"{number:,} rounds{each} are {about}{what}; {most}"
    return TooMuch(file, head, "Y1004", message, help_)


def _too_many_rounds(file: File, head: Statement, done: int, number: int, count: Count) -> TooMuch:
    """Return the error that a REPEAT exceeds a limit in round `done` of `number`."""
    what, most = _excess(count)
    message = f"up to round {done:,} of {number:,} this loop makes {what}; {most}"
    return TooMuch(file, head, "Y1004", message, SHORTER)


def too_much_so_far(file: File, statement: Statement, count: Count) -> TooMuch | None:
    """Return the error that the program from its beginning to a line exceeds a limit; None if it is within
    all limits.
    """
    if not count.is_too_much:
        return None
    what, most = _excess(count)
    message = f"with this {statement.name.name} the program makes {what}; {most}"
    return TooMuch(file, statement, "Y1004", message, SHORTER)


def too_deep(file: File, statement: Statement) -> TooMuch:
    """Return the error that blocks and calls are nested too deep."""
    message = f"more than {DEEPEST} blocks and CALLs are nested here"
    return TooMuch(file, statement, "Y0112", message, "call the inner SUBs from the program itself")


def _excess(count: Count) -> tuple[str, str]:
    """Return words for a count that is too large, and for the limit that it exceeds."""
    if count.commands > MOST_COMMANDS:
        return _number(count.commands, "command"), f"a program has at most {MOST_COMMANDS:,} commands"
    if count.rounds > MOST_ROUNDS:
        return _number(count.rounds, "round"), f"{AT_MOST} {MOST_ROUNDS:,} rounds"
    return _number(count.lines, "line"), f"a program carries out at most {MOST_LINES:,} lines"


def _number(number: int, word: str) -> str:
    return f"{number:,} {word}{'s' * (number != 1)}"


SHORTER = "shorten the loops, or divide the program"
"""Remedy if a program has too many commands."""
