"""Reuse of earlier results, as long as everything on which they depend is unchanged.

The key of a result describes the work: its kind, its options, the path as given, and the installed yarclang.
The work reads files only through consulted.py, as questions with answers. The answers are stored with the
result. The result is reused if all questions have the same answers now. A result that contains the path of
the working directory is reused only in this directory.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable
from functools import partial
from pathlib import Path
from typing import Any

from yarclang.consulted import CHANGED, Answers, Question, answer_now, digest
from yarclang.fleet.installation import stamp, this_installation
from yarclang.fleet.packing import packed, unpacked
from yarclang.fleet.store import Store

_MOST_ENTRIES = 8
"""Largest number of a key's entries that are compared with the present files. Further entries are dropped."""


_HELD = 100_000
"""Size above which a found result isn't kept in memory, but read from the store again when it is needed
[bytes].
"""


class Found:
    """An earlier result that may be reused."""

    def __init__(self, body: bytes, again: Callable[[], bytes | None]) -> None:
        self._body = body if len(body) <= _HELD else None
        self._again = again

    def load(self) -> tuple[Any] | None:
        """Return the result, in a tuple; None if the store has dropped it since it was found."""
        body = self._again() if self._body is None else self._body
        return None if body is None else (unpacked(body),)


class Reuse:
    """Finds and stores results of earlier work.

    Args:
        store: the store of the results.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._installed = ""
        self._answers: dict[Question, str] = {}

    def find(self, work: Hashable) -> Found | None:
        """Return an earlier result that may be reused; None if there is none.

        Args:
            work: key of the work. Its `repr` must contain everything that distinguishes the work from other
                work.
        """
        key = self._key(work)
        here = str(Path.cwd())
        for count, (number, value) in enumerate(self._store.get(key)):
            if count == _MOST_ENTRIES:
                self._store.drop(number)
                continue
            head, _, body = value.partition(b"\n")
            data = json.loads(head)
            if data["here"] in ("", here) and all(
                self._now(Question(kind, path)) == said for kind, path, said in data["answers"]
            ):
                self._store.use(number)
                return Found(body, partial(self._again, key, number))
        return None

    def keep(self, work: Hashable, answers: Answers, result: Any) -> None:
        """Store a result with the answers on which it depends, unless a file was changed during the work."""
        if CHANGED in answers.values():
            return
        body = packed(result)
        here = str(Path.cwd())
        head = {
            # A result may contain the folder's path only by chance. Then it is reused only in this folder,
            # which is harmless.
            "here": here if here.encode() in body else "",
            "answers": [[*question, answer] for question, answer in answers.items()],
        }
        self._store.put(self._key(work), json.dumps(head).encode() + b"\n" + body)

    def _again(self, key: str, number: int) -> bytes | None:
        return next((value.partition(b"\n")[2] for one, value in self._store.get(key) if one == number), None)

    def _key(self, work: Hashable) -> str:
        if not self._installed:
            self._installed = self._installation()
        return digest(f"{self._installed}\n{work!r}".encode())

    def _installation(self) -> str:
        """Return the digest of the installed yarclang. The files of the package are read only if one of them
        has been written since the last time.
        """
        now = f"installation {stamp()}"
        for _, value in self._store.get(now):
            return value.decode()
        made = this_installation().digest
        self._store.put(now, made.encode())
        return made

    def _now(self, question: Question) -> str:
        """Return the disk's answer to a question. Each question is asked only once."""
        answer = self._answers.get(question)
        if answer is None:
            answer = self._answers[question] = answer_now(question)
        return answer
