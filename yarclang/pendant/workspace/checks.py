"""Checks of all programs of the project with a draft (unsaved changes of the workspace). A check runs in a
process with low priority, limited memory and limited time. Only one check runs at a time, for all sessions
together.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from asyncio.subprocess import Process
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from yarclang.files import reason_of
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.apart import begun, command_of
from yarclang.pendant.messages.workspace import CheckShown, JudgedProgram
from yarclang.runtime.actions import Trouble

MOST_MEMORY = 3 << 30
"""Largest address space of the checking process [bytes]. The compiler with its libraries alone takes 1
GiB.
"""
MOST_EACH = 120.0
"""Longest time for one program [s]."""
MOST_IN_ALL = 1800.0
"""Longest time for all programs [s]."""
_MOST_FILES = 1000
_MOST_TIMES = 5
"""Largest number of starts of the checking process in one check. If the process ends or takes too long at a
program, it is started again for the remaining programs.
"""
_LARGEST = 1 << 20


@dataclass(frozen=True, slots=True)
class Question:
    """Input of a check.

    Attributes:
        folder: folder of the project.
        files: programs to check, as paths in the project.
        robot: folder or name of the robot's description.
        cell: path of the session's cell; None without a cell.
        drafts: changed texts that are used instead of files, by the files' absolute paths.
        joints: present joint positions (n,) [rad or m]; None if unknown.
        digest: digest of the drafts.
    """

    folder: Path
    files: tuple[str, ...]
    robot: str
    cell: str | None
    drafts: Mapping[str, str]
    joints: tuple[float, ...] | None
    digest: str


@dataclass(slots=True)
class _Check:
    session: str
    user: str
    question: Question
    state: str = "running"
    at: int = 0
    what: str = ""
    standing: tuple[str, ...] = ()
    programs: list[JudgedProgram] = field(default_factory=list)
    task: asyncio.Task[None] | None = None


class Checks:
    """Checks of programs on a pendant. The result of the last check is kept.

    Args:
        command: command that starts the process; None for the ordinary checking process with limited memory.
    """

    def __init__(self, command: tuple[str, ...] | None = None) -> None:
        self._command = command or command_of("yarclang.pendant.workspace.judging", (), MOST_MEMORY, nice=15)
        self._last: _Check | None = None

    @property
    def is_busy(self) -> bool:
        """True while a check is running."""
        return self._last is not None and self._last.state == "running"

    def begin(self, session: Session, question: Question) -> None:
        """Begin a check of programs. A running check of the same session is cancelled.

        Raises:
            Trouble: the check of another session is running.
        """
        last = self._last
        if last is not None and last.state == "running":
            if last.session != session.id:
                raise Trouble(
                    f"{last.user} is already checking programs", "wait until that check is done", "busy"
                )
            self.cancel(session.id)
        self._last = made = _Check(session.id, session.user, question)
        made.task = asyncio.ensure_future(self._run(made))

    def cancel(self, session: str) -> None:
        """End the running check of a session, if it has one."""
        last = self._last
        if last is not None and last.session == session and last.state == "running":
            last.state = "cancelled"
            if last.task is not None:
                last.task.cancel()

    async def close(self) -> None:
        """End the running check."""
        if self._last is not None and self._last.task is not None:
            self.cancel(self._last.session)
            with contextlib.suppress(asyncio.CancelledError):
                await self._last.task

    def outcome(self, digest: str) -> str:
        """Return the outcome of the last check of a draft, in words for the audit trail."""
        last = self._last
        if last is None or last.question.digest != digest or last.state != "done":
            return "programs not checked"
        return (
            f"{_broken(last)} of {len(last.programs)} programs can no longer be proved, "
            f"{_unjudged(last)} not checked"
        )

    def shown(self, session: Session) -> CheckShown:
        """Return the progress of the last check."""
        last = self._last
        if last is None:
            return CheckShown(
                state="none", by="", mine=False, done=0, of=0, file="", broken=0, unjudged=0,
                programs=(), standing=(), what="", digest="",
            )  # fmt: skip
        files = last.question.files
        order = sorted(
            last.programs, key=lambda one: (one.holds is not False or not one.held, one.holds is True)
        )
        return CheckShown.model_validate(
            {
                "state": last.state,
                "by": last.user,
                "mine": last.session == session.id,
                "done": last.at,
                "of": len(files),
                "file": files[last.at] if last.state == "running" and last.at < len(files) else "",
                "broken": _broken(last),
                "unjudged": _unjudged(last),
                "programs": tuple(order),
                "standing": last.standing,
                "what": last.what,
                "digest": last.question.digest,
            }
        )

    async def _run(self, check: _Check) -> None:
        try:
            async with asyncio.timeout(MOST_IN_ALL):
                for _ in range(_MOST_TIMES):
                    if await self._listen(check):
                        check.state = "done"
                        return
                    await self._leave_out(check)
                    if check.at >= len(check.question.files):
                        check.state = "done"
                        return
            check.what = f"the process that checks has ended {_MOST_TIMES} times"
        except TimeoutError:
            check.what = f"it took longer than {MOST_IN_ALL / 60:.0f} min"
        except OSError as error:
            check.what = f"it can't be started: {reason_of(error)}"
        finally:
            if check.state == "running":  # a check that counts as running would block all others
                check.state = "failed"

    async def _listen(self, check: _Check) -> bool:
        """Start the checking process for the remaining programs, and receive its results. Return True if
        it has checked them all.
        """
        process = await begun(self._command, limit=_LARGEST)
        try:
            await _ask(process, check)
            assert process.stdout is not None
            first = check.at
            while True:
                async with asyncio.timeout(MOST_EACH):
                    line = await process.stdout.readline()
                if not line:
                    return False
                told = json.loads(line)
                if told.get("done"):
                    check.at = len(check.question.files)
                    return True
                _take(check, told, first)
        except (TimeoutError, ValueError, KeyError, TypeError):
            return False
        finally:
            await _end(process)

    async def _leave_out(self, check: _Check) -> None:
        """Leave out the current program, at which the checking process has ended or has taken too long."""
        files = check.question.files
        if check.at < len(files):
            message = f"it couldn't be checked within {MOST_EACH:.0f} s and {MOST_MEMORY >> 30} GiB"
            check.programs.append(JudgedProgram(file=files[check.at], held=None, holds=None, message=message))
            check.at += 1
        await asyncio.sleep(0.1)


def _take(check: _Check, answer: Mapping[str, Any], first: int) -> None:
    if "standing" in answer:
        check.standing = tuple(str(one)[:300] for one in answer["standing"][:50])
    elif "at" in answer:
        check.at = first + int(answer["at"])
    elif "holds" in answer:
        check.programs.append(JudgedProgram.model_validate(dict(answer)))


async def _ask(process: Process, check: _Check) -> None:
    question = check.question
    asked = {
        "folder": str(question.folder),
        "files": question.files[check.at : _MOST_FILES],
        "robot": question.robot,
        "cell": question.cell,
        "drafts": dict(question.drafts),
        "joints": question.joints,
    }
    assert process.stdin is not None
    with contextlib.suppress(ConnectionError):
        process.stdin.write(json.dumps(asked).encode())
        await process.stdin.drain()
        process.stdin.close()


async def _end(process: Process) -> None:
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
    with contextlib.suppress(TimeoutError):
        await asyncio.wait_for(process.wait(), 5.0)


def _broken(check: _Check) -> int:
    return sum(one.holds is False and one.held is True for one in check.programs)


def _unjudged(check: _Check) -> int:
    return sum(one.holds is None or (one.holds is False and not one.held) for one in check.programs)
