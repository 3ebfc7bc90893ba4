"""Record which files a piece of work (such as a check) reads. Or let the work read a bundle of files that was
sent with it, instead of the disk.

Everything that a check reads, searches or lists is requested through this module or `files.read_whole`. So
the files on which a result depends can be recorded (`recorded`), and the result can be reused as long as they
are unchanged. A process on another machine can do the same work with a bundle of these files (`bundled`).

The files that belong to this installation are always read from the disk, even for work with a bundle. If the
same bundle gives different results on two installations, the installations differ.
"""

from __future__ import annotations

import errno
import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import NamedTuple

_PACKAGE = Path(__file__).resolve().parent
_OURS = tuple(f"{folder}{os.sep}" for folder in (_PACKAGE, _PACKAGE.parent / "stdlib"))


class Question(NamedTuple):
    """A question to the file system about a path, such as the content of a file or whether it exists.

    Attributes:
        kind: one of the kinds below.
        path: path relative to the working directory if it is inside, otherwise absolute.
    """

    kind: str
    path: str


CONTENT = "content"
"""Question for the content of a file. The answer is its digest, or the reason why it can't be read."""

_FILE, _FOLDER = "file", "folder"
"""Questions whether a file or a folder exists. The answer is `yes` or `no`."""

_NEAREST = "nearest "
"""Prefix of a question; the name of a file follows. The question asks for the nearest folder with a file of
this name, beginning at the path and going up. The answer is the number of steps up, or `none`.
"""

_MODULES = "modules "
"""Prefix of a question; the name of a module in upper case follows, or `*` for any module. The question asks
which files of a folder may be this module. The answer is the names of these files in order.
"""

CHANGED = "changed while the work went on"
"""Answer that prevents the result from being stored for reuse. A question gets it if it had two different
answers, or if it asks for the content of a pipe or a device.
"""

Answers = dict[Question, str]


@contextmanager
def recorded() -> Iterator[Answers]:
    """Record which files the work in this `with` block reads. Work in other processes isn't recorded."""
    record: Answers = {}
    token = _RECORD.set(record)
    try:
        yield record
    finally:
        _RECORD.reset(token)


_RECORD: ContextVar[Answers | None] = ContextVar("record", default=None)


class Bundle(NamedTuple):
    """Files that were sent with the work that reads them.

    Attributes:
        answers: answers to the file system questions that are expected.
        contents: contents of files, by their digests.
    """

    answers: Mapping[Question, str]
    contents: Mapping[str, bytes]


class NotBundledError(BaseException):
    """A question about a file that the bundle doesn't answer. It isn't an `Exception`, so that no stage of
    the compiler treats it as a bug.

    Attributes:
        question: the question.
    """

    def __init__(self, question: Question) -> None:
        super().__init__(f"{question.kind}: {question.path}")
        self.question = question


@contextmanager
def bundled(bundle: Bundle) -> Iterator[None]:
    """Restrict the work inside this `with` block to the files of a bundle.

    Raises:
        NotBundledError: the work needs a file that isn't in the bundle.
    """
    token = _BUNDLE.set(bundle)
    try:
        yield
    finally:
        _BUNDLE.reset(token)


_BUNDLE: ContextVar[Bundle | None] = ContextVar("bundle", default=None)


def is_file(path: Path) -> bool:
    """Return True if there is a file at a path."""
    return _asked(_FILE, path, lambda: _yes(path.is_file())) == "yes"


def is_folder(path: Path) -> bool:
    """Return True if there is a folder at a path."""
    return _asked(_FOLDER, path, lambda: _yes(path.is_dir())) == "yes"


def nearest_folder(folder: Path, name: str) -> Path | None:
    """Return the nearest folder, from a folder upwards, that has a file of this name; None without one."""
    steps = _asked(_NEAREST + name, folder, lambda: _steps_up(folder, name))
    if steps == "none":
        return None
    return folder if steps == "0" else folder.parents[int(steps) - 1]


def modules_in(folder: Path, name: str = "*") -> list[Path]:
    """Return the files of a folder that may be a module of a program, in order; empty if the folder can't be
    read.

    Args:
        folder: the folder.
        name: the module's name in upper case; `*` for all modules.
    """
    names = _asked(_MODULES + name, folder, lambda: _module_names(folder, name))
    return [folder / one for one in names.split("\0") if one]


def content_of(path: Path, read: Callable[[], bytes]) -> bytes:
    """Return the content of a file from the bundle, or else from `read`, which reads it from the disk.

    Raises:
        OSError: the file can't be read.
    """
    bundle, record = _BUNDLE.get(), _RECORD.get()
    if record is None if bundle is None else _is_ours(path):
        return read()
    question = question_of(CONTENT, path)
    if bundle is not None:
        answer = _bundled(bundle, question)
        _note(record, question, answer)
        if answer.startswith(_NO):
            number, _, reason = answer.removeprefix(_NO).partition(" ")
            raise OSError(int(number), reason, str(path))
        return bundle.contents[answer]
    try:
        content = read()
    except OSError as error:
        _note(record, question, _unreadable(error))
        raise
    _note(record, question, digest(content))
    return content


@contextmanager
def on_disk(path: Path, content: bytes) -> Iterator[Path]:
    """Yield the path of a file on the disk with a given content, for libraries that open files themselves.

    The file is `path` itself, or a temporary copy if the content comes from a bundle.
    """
    if _BUNDLE.get() is None or _is_ours(path):
        yield path
        return
    handle, name = tempfile.mkstemp(suffix=path.suffix)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        yield Path(name)
    finally:
        with suppress(OSError):
            Path(name).unlink()


def question_of(kind: str, path: Path) -> Question:
    """Return a question about a path in the form in which it is recorded."""
    whole, here = _whole(path), str(Path.cwd())
    inside = whole == here or whole.startswith(here.rstrip(os.sep) + os.sep)
    return Question(kind, os.path.relpath(whole, here) if inside else whole)


def answer_now(question: Question) -> str:
    """Return the answer to a question from the disk as it is now."""
    kind, path = question.kind, Path(question.path)
    if kind == CONTENT:
        return content_now(path)[0]
    if kind == _FILE:
        return _yes(path.is_file())
    if kind == _FOLDER:
        return _yes(path.is_dir())
    if kind.startswith(_NEAREST):
        return _steps_up(Path(_whole(path)), kind.removeprefix(_NEAREST))
    return _module_names(path, kind.removeprefix(_MODULES))


def content_now(path: Path) -> tuple[str, bytes]:
    """Return the answer to the question for a file's content, and the content (empty if the file can't be
    read).
    """
    try:
        if path.exists() and not path.is_file():
            return CHANGED, b""  # a pipe or a device: its content can't be read again
        content = path.read_bytes()
    except OSError as error:
        return _unreadable(error), b""
    return digest(content), content


def digest(content: bytes) -> str:
    """Return the digest of some content, as 64 hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


_NO = "no: "


def _unreadable(error: OSError) -> str:
    return f"{_NO}{error.errno or errno.EIO} {error.strerror or error}"


def _asked(kind: str, path: Path, answer: Callable[[], str]) -> str:
    bundle, record = _BUNDLE.get(), _RECORD.get()
    if record is None if bundle is None else _is_ours(path):
        return answer()
    question = question_of(kind, path)
    given = answer() if bundle is None else _bundled(bundle, question)
    _note(record, question, given)
    return given


def _bundled(bundle: Bundle, question: Question) -> str:
    answer = bundle.answers.get(question)
    if answer is None:
        raise NotBundledError(question)
    return answer


def _note(record: Answers | None, question: Question, answer: str) -> None:
    if record is not None:
        record[question] = answer if record.get(question, answer) == answer else CHANGED


def _is_ours(path: Path) -> bool:
    return (_whole(path) + os.sep).startswith(_OURS)


def _whole(path: Path) -> str:
    """Return an absolute path without `..`. Links aren't resolved."""
    return os.path.abspath(path)  # noqa: PTH100 (resolve follows links)


def _yes(is_so: bool) -> str:
    return "yes" if is_so else "no"


def _steps_up(folder: Path, name: str) -> str:
    found = (steps for steps, above in enumerate((folder, *folder.parents)) if (above / name).is_file())
    return str(next(found, "none"))


def _module_names(folder: Path, name: str) -> str:
    try:
        named = [one for one in folder.iterdir() if one.suffix == ".yarc" and name in ("*", one.stem.upper())]
        return "\0".join(sorted(one.name for one in named if one.is_file()))
    except OSError:
        return ""
