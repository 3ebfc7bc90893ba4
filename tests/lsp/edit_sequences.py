"""Random sequences of edits with requests in between, as people and tools make them, and worse ones."""

import asyncio
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from floors import Tally
from lsprotocol import converters

from tests.lsp.wire import ROBOT, Wire
from yarclang.diagnostics import has_errors
from yarclang.lsp.documents import Document
from yarclang.lsp.translation import diagnostic_of
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TEXTS = [path.read_text() for path in sorted(EXAMPLES.glob("*.yarc"))]
QUICK = [text for text in TEXTS if "PATTERN" not in text and "WEAVE" not in text]
"""The examples that are planned in less than a second."""

EVERY = 25
"""Number of edits between two comparisons with a fresh check."""

UNDONE = {10, EVERY - 1}
"""Edits of a mild sequence, counted from the last comparison, that mostly restore its first text. Without
them, nearly all texts would have errors.
"""

LONGEST = 120.0
"""Time without an answer after which the server counts as hanging [s]."""

ALLOWED = {-32800, -32801, -32803}
"""Error codes of the protocol that are allowed: a request was cancelled, its text has changed, or it is
refused.
"""

PIECES = [
    "P9000 MOVEJ HOME\n",
    "P9001 MOVEL 0 1000 1000 -90 0 0 [2]\n",
    "REPEAT I 3\n",
    "REPEAT 99999\n",
    "REPEAT K 2000000\n",
    "IF I % 2 = 0\n",
    "ELSE\n",
    "END\n",
    "SUB S A (mm)\n",
    "P9002 CALL S 5\n",
    "LET N = N + 1\n",
    "FRAME {T} 1 2 3 0 0 0 {B}\n",
    "USE PALLET\n",
    'CELL "cell.toml"\n',
    "WHEN DOOR ON\n",
    "DEFAULT {TCP} [1] (mm,deg,s) {B}\n",
    "ROBOT INDUSTRIAL6\n",
    "! yarc: ignore[Y0601]\n",
    "\n\n\n",
    " BLEND 5",
    " [MIN]",
    " [V 100]",
    "_TOPP",
    "é😀",
    "{",
    "$(",
    '"',
    ";",
]

QUESTIONS = (
    "hover",
    "completion",
    "signatureHelp",
    "definition",
    "references",
    "documentHighlight",
    "prepareRename",
    "rename",
    "codeAction",
    "formatting",
    "rangeFormatting",
    "inlayHint",
    "semanticTokens/full",
    "documentSymbol",
    "foldingRange",
    "codeLens",
)

TO_JSON = converters.get_converter()


@dataclass
class Sequence:
    """One text that is edited.

    Args:
        seed: seed of the random edits.
        is_heavy: True for edits as by tools and pasting, with blocks and random characters; False for edits
            as by typing.
        folder: the folder of the text's file. The text isn't saved.
    """

    seed: int
    is_heavy: bool
    folder: Path
    text: str = ""
    version: int = 1
    longest: float = 0.0
    """The longest time from a request to its answer [s]."""
    done: Tally = field(default_factory=Tally)
    """Shares of edits that changed the text, of requests (by name) that got an answer, and of comparisons;
    also of comparisons with texts that had errors or were planned.
    """
    _pending: list[tuple[str, asyncio.Future[Any], float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.chance = random.Random(f"{self.seed}{self.is_heavy}")
        self.text = self.chance.choice(TEXTS if self.is_heavy else QUICK)
        self.first = self.text
        self.before = [self.text]
        self.path = self.folder / f"{'heavy' if self.is_heavy else 'mild'}{self.seed}.yarc"
        self._typed: Iterator[tuple[int, int, str]] = iter(())

    @property
    def uri(self) -> str:
        return self.path.as_uri()

    async def run(self, wire: Wire, edits: int) -> None:
        """Open the text, edit it, and close it."""
        item = {"uri": self.uri, "languageId": "yarc", "version": 1, "text": self.text}
        wire.tell("textDocument/didOpen", {"textDocument": item})
        for number in range(1, edits + 1):
            self._edit(wire, is_undone=number % EVERY in UNDONE and self.chance.random() < 0.9)
            for _ in range(self.chance.choice((0, 0, 1, 3))):
                self._ask(wire)
            if self.chance.random() < 0.3:
                await asyncio.sleep(self.chance.choice((0.0, 0.01, 0.1, 0.5)))
            if number % EVERY == 0:
                await self._answered()
                await self._compare(wire)
        await self._answered()
        wire.tell("textDocument/didClose", {"textDocument": {"uri": self.uri}})
        wire.findings.pop(self.uri, None)

    # edits

    def _edit(self, wire: Wire, *, is_undone: bool) -> None:
        if is_undone and not self.is_heavy:
            self._typed = iter(())
            self.text = self.first
            changes = [{"text": self.text}]
        elif self.is_heavy and self.chance.random() < 0.08:
            self.text = self.chance.choice([*TEXTS, *self.before[-3:]])
            changes = [{"text": self.text}]
        else:
            count = self.chance.choice((1, 1, 1, 3)) if self.is_heavy else 1
            changes = [
                self._changed(*(self._heavy() if self.is_heavy else self._mild())) for _ in range(count)
            ]
        self.version += 1
        self.done.count("edit", self.text != self.before[-1])
        self.before = [*self.before[-5:], self.text]
        document = {"uri": self.uri, "version": self.version}
        wire.tell("textDocument/didChange", {"textDocument": document, "contentChanges": changes})

    def _mild(self) -> tuple[int, int, str]:
        """Return an edit as by typing: start and end of the replaced text, and the new text."""
        chance, text = self.chance, self.text
        typed = next(self._typed, None)
        if typed is not None:
            return typed
        lines = [at for at, letter in enumerate(text) if letter == "\n"] or [0]
        begin = chance.choice(lines) + 1
        end = text.find("\n", begin) + 1 or len(text)
        kind = 0.0 if text == self.first else chance.random()
        if kind < 0.35:  # a digit
            digits = [at for at, letter in enumerate(text) if letter.isdigit()] or [0]
            at = chance.choice(digits)
            return at, at + 1, str(chance.randrange(10))
        if kind < 0.55:  # a line is typed, letter by letter
            written = text[begin:end] if chance.random() < 0.5 else chance.choice(PIECES)
            self._typed = iter([(begin + n, begin + n, letter) for n, letter in enumerate(written)])
            return next(self._typed, (begin, begin, "\n"))
        if kind < 0.65:
            return begin, end, ""
        if kind < 0.75:
            return begin, begin, text[begin:end]
        if kind < 0.85:
            return begin, begin, "! " if text[begin : begin + 2] != "! " else ""
        at = chance.randrange(len(text) + 1)
        return (at, min(at + 1, len(text)), "") if kind < 0.95 else (at, at, chance.choice("0 A{}[]!;.$"))

    def _heavy(self) -> tuple[int, int, str]:
        """Return an edit as by tools, pasting and mistyped keys."""
        chance, text = self.chance, self.text
        at = chance.randrange(len(text) + 1)
        other = min(len(text), at + int(chance.expovariate(1 / 60)))
        kind = chance.random()
        if kind < 0.3:
            return at, other, ""
        if kind < 0.5:
            piece = chance.choice(PIECES)
            at = text.rfind("\n", 0, at) + 1 if piece.endswith("\n") else at
            return at, at, piece
        if kind < 0.65:
            source = chance.choice(TEXTS)
            begin = chance.randrange(len(source))
            return at, at, source[begin : begin + int(chance.expovariate(1 / 300))]
        if kind < 0.8:
            return (
                at,
                at,
                "".join(chance.choice(' \nP01{}[]();!$%.,-_"EI') for _ in range(chance.randrange(12))),
            )
        if kind < 0.9:
            return at, other, text[at:other] * 2
        numbers = [place for place, letter in enumerate(text) if letter.isdigit()] or [0]
        place = chance.choice(numbers)
        return place, place + 1, chance.choice(("99999", "-1", "1e9", "0", "7"))

    def _changed(self, begin: int, end: int, put: str) -> dict[str, Any]:
        begin, end = min(begin, len(self.text)), min(end, len(self.text))
        range_ = {"start": self._position(begin), "end": self._position(end)}
        if len(self.text) < 20_000 or not put:
            self.text = self.text[:begin] + put + self.text[end:]
        else:
            put = self.text[begin:end]
        return {"range": range_, "text": put}

    def _position(self, place: int) -> dict[str, int]:
        before = self.text[:place]
        row = before.rpartition("\n")[2]
        return {"line": before.count("\n"), "character": len(row.encode("utf-16-le")) // 2}

    # questions

    def _ask(self, wire: Wire) -> None:
        what = self.chance.choice(QUESTIONS)
        at = self._position(self.chance.randrange(len(self.text) + 1))
        if what == "definition" and self.chance.random() < 0.6:
            # choose a name, because most places of a text have no definition
            names = [found.start() for found in re.finditer(r"(?<=[{$])[A-Za-z_]", self.text)] or [0]
            at = self._position(self.chance.choice(names))
        whole = {"start": {"line": 0, "character": 0}, "end": {"line": 10_000, "character": 0}}
        params: dict[str, Any] = {"textDocument": {"uri": self.uri}}
        match what:
            case "codeAction":
                # from here to the end of the text, because a single place rarely has an action
                params |= {"range": {"start": at, "end": whole["end"]}, "context": {"diagnostics": []}}
            case "formatting" | "rangeFormatting":
                params |= {"range": whole, "options": {"tabSize": 2, "insertSpaces": True}}
            case "inlayHint":
                params |= {"range": whole}
            case "rename":
                params |= {"position": at, "newName": "RENAMED"}
            case "references":
                params |= {"position": at, "context": {"includeDeclaration": True}}
            case "semanticTokens/full" | "documentSymbol" | "foldingRange" | "codeLens":
                pass
            case _:
                params |= {"position": at}
        if what == "formatting":
            params.pop("range")
        answer = wire.ask(f"textDocument/{what}", params)
        self._pending.append((what, answer, asyncio.get_running_loop().time()))
        if self.chance.random() < 0.1:
            wire.cancel()

    async def _answered(self) -> None:
        """Wait for the answers to all pending requests."""
        for what, answer, asked in self._pending:
            said = await asyncio.wait_for(answer, LONGEST)
            self.longest = max(self.longest, asyncio.get_running_loop().time() - asked)
            error = said.get("error")
            self.done.count("question", error is None)
            self.done.count(what, bool(said.get("result")))
            assert error is None or error["code"] in ALLOWED, (self.path.name, self.version, what, error)
        self._pending.clear()

    # findings

    async def _compare(self, wire: Wire) -> None:
        """Compare the server's findings with those of a fresh check."""
        params = {"textDocument": {"uri": self.uri}}
        said = await asyncio.wait_for(wire.ask("textDocument/diagnostic", params), LONGEST)
        assert "error" not in said, (self.path.name, self.version, said)
        document = Document(self.uri, self.version, self.text)
        checked = check_text(
            SourceFile(document.source.name, document.source.text), self.folder, Options(robot=ROBOT)
        )
        fresh = [TO_JSON.unstructure(diagnostic_of(document, one, "utf-16")) for one in checked.diagnostics]
        found = said["result"]["items"]
        if found != fresh:
            more, less = (
                [one for one in found if one not in fresh],
                [one for one in fresh if one not in found],
            )
            raise AssertionError(
                f"{self.path.name} {self.version}: only the server finds {more}, only a fresh check {less}\n"
                f"{self.text!r}"
            )
        self.done.count("comparison")
        self.done.count("comparison of a program that can be carried out", checked.compiled is not None)
        self.done.count("comparison of a program with errors", has_errors(checked.diagnostics))


PULLS = {
    "textDocument": {
        "diagnostic": {},
        "hover": {"contentFormat": ["markdown"]},
        "completion": {"completionItem": {"snippetSupport": True}},
        "codeAction": {"codeActionLiteralSupport": {"codeActionKind": {"valueSet": []}}},
    }
}
"""A client that requests findings, and that the server can't ask to request them again. So each answer must
have all findings.
"""
