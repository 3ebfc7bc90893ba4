"""Calls of the program git in which the repository can't make git execute code. Hooks, filters, file system
monitors, pagers, converters and transports are switched off.
"""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import threading
from contextlib import suppress
from pathlib import Path

from yarclang.pendant.project.names import quoted
from yarclang.runtime.actions import Trouble

_LONGEST = 10.0
"""Longest time of one call [s]."""
_MOST_ANSWER = 32 << 20
_MOST_MEMORY = 2 << 30

_SETTINGS = (
    "core.fsmonitor=false",
    "core.hooksPath=/dev/null",
    "core.pager=cat",
    "core.untrackedCache=false",
    "core.sshCommand=false",
    "core.askPass=false",
    "core.gitProxy=",
    "core.alternateRefsCommand=",
    "diff.external=",
    "log.showSignature=false",
    "protocol.allow=never",
    "credential.helper=",
    "gc.auto=0",
    "maintenance.auto=false",
    "submodule.recurse=false",
    "safe.bareRepository=explicit",
)

_ENVIRONMENT = {
    "GIT_ALLOW_PROTOCOL": "none",
    "GIT_ATTR_NOSYSTEM": "1",
    "GIT_CONFIG_NOSYSTEM": "1",
    "GIT_LITERAL_PATHSPECS": "1",
    "GIT_NO_LAZY_FETCH": "1",
    "GIT_NO_REPLACE_OBJECTS": "1",
    "GIT_OPTIONAL_LOCKS": "0",
    "GIT_PAGER": "cat",
    "GIT_TERMINAL_PROMPT": "0",
    "LC_ALL": "C.UTF-8",
}
_KEPT = ("PATH", "HOME", "XDG_CONFIG_HOME", "LD_LIBRARY_PATH")
"""Environment variables that git inherits. With them, git finds the user's settings, which say which folders
of other users git may read.
"""


class Missing(Exception):  # noqa: N818 - it is an answer
    """Raised if git has no answer, because there is no repository or no commit."""


def ask(folder: Path, *words: str, most: int = _MOST_ANSWER) -> bytes:
    """Call git and return its output. Use only commands that don't read the content of files in the work
    tree. Otherwise git would run filters that the repository defines.

    Args:
        folder: folder in the work tree of a repository.
        *words: git command and its arguments.
        most: longest allowed output [bytes].

    Raises:
        Missing: there is no repository or no commit.
        Trouble: git isn't installed, refuses the folder, takes too long, or its output is too long.
    """
    program = shutil.which("git")
    if program is None:
        raise Trouble("the program git isn't installed here", "install it to see what has changed", "git")
    settings = [word for one in _SETTINGS for word in ("-c", one)]
    environment = {name: os.environ[name] for name in _KEPT if name in os.environ} | _ENVIRONMENT
    process = subprocess.Popen(
        [program, "--no-pager", *settings, "-C", str(folder), *words],
        env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        start_new_session=True,
    )  # fmt: skip
    with suppress(OSError):  # the process has ended
        resource.prlimit(process.pid, resource.RLIMIT_AS, (_MOST_MEMORY, _MOST_MEMORY))
    late = threading.Event()

    def end() -> None:
        late.set()
        _kill(process)

    timer = threading.Timer(_LONGEST, end)
    timer.start()
    try:
        output, refused = _read(process, most)
    finally:
        timer.cancel()
        _kill(process)
        process.wait()
        for stream in (process.stdout, process.stderr):
            if stream is not None:
                stream.close()
    if late.is_set() or len(output) > most:
        much = f"takes more than {_LONGEST:.0f} s" if late.is_set() else f"outputs more than {most:,} bytes"
        raise Trouble(f"git {words[0]} {much} here", "use git on the pendant's computer", "git")
    if process.returncode:
        raise _refusal(folder, refused.decode(errors="replace"))
    return output


def _read(process: subprocess.Popen[bytes], most: int) -> tuple[bytes, bytes]:
    """Return the output of a process, up to about `most` bytes, and the beginning of its error output."""
    assert process.stdout is not None
    assert process.stderr is not None
    complaints: list[bytes] = []
    stderr = process.stderr

    def listen() -> None:
        complaints.append(stderr.read(10_000))
        while stderr.read(1 << 16):
            pass

    listening = threading.Thread(target=listen, daemon=True)
    listening.start()
    output = process.stdout.read(most + 1)
    if len(output) > most:
        _kill(process)
    process.wait()
    listening.join(1.0)
    return output, b"".join(complaints)


def _kill(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL)


def _refusal(folder: Path, output: str) -> Exception:
    if "dubious ownership" in output:
        return Trouble(
            f"{quoted(str(folder))} belongs to another user than the one that runs the pendant, so git "
            "refuses it",
            f"if you trust the folder: git config --global --add safe.directory {folder}", "git",
        )  # fmt: skip
    if not output.strip() or "safe.bareRepository" in output or "not a git repository" in output:
        return Missing(output)
    first = next((line for line in output.splitlines() if line.startswith(("fatal:", "error:"))), "")
    if "Needed a single revision" in output or "unknown revision" in output or "bad revision" in output:
        return Missing(output)
    return Trouble(f"git can't read this repository: {first[:200] or 'it gives no reason'}",
        "use git on the pendant's computer", "git")  # fmt: skip
