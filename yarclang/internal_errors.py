"""Convert exceptions that are no fault of the user to findings with a report to copy."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from yarclang.diagnostics import Diagnostic
from yarclang.source import SourceFile, Span

_FRAMES = 6
"""Number of innermost calls in a report."""

_LONGEST = 200
"""Largest number of characters of a line, and of an exception's text, in a report."""

_PACKAGE = Path(__file__).parent


def internal_error(
    error: BaseException, source: SourceFile | None = None, span: Span | None = None
) -> Diagnostic:
    """Convert an exception (a bug of the compiler) to a finding.

    Args:
        error: the caught exception.
        source: the file being processed, if there is one.
        span: the place in the file, if it is known.

    Raises:
        KeyboardInterrupt: the caught exception wraps a KeyboardInterrupt. Python wraps any exception in
            `__set_name__` while it creates a class.
    """
    if isinstance(error.__cause__, KeyboardInterrupt):
        raise error.__cause__
    if isinstance(error, MemoryError):
        help_ = "divide the program, or give the computer more memory"
        return Diagnostic("Y2003", "there was not enough memory for this program", source, span, help_)
    name = type(error).__name__
    message = f"internal error: {name}{': ' * bool(str(error))}{_short(str(error))}"
    return Diagnostic("Y2001", message, source, span, _report(error, source, span))


def _report(error: BaseException, source: SourceFile | None, span: Span | None) -> str:
    """Return a report for a developer. It contains no names of folders."""
    import platform
    import traceback

    lines = [
        "this is a bug of yarclang, not of the program: please report it with these lines",
        (
            f"yarclang {_version()}, Python {platform.python_version()}, {platform.system()} "
            f"{platform.machine()}"
        ),
        traceback.format_exception_only(type(error), error)[-1].strip()[:_LONGEST],
    ]
    calls = list(frames_of(error))
    if len(calls) > _FRAMES:
        lines.append(f"  ... {len(calls) - _FRAMES:,} more calls")
    lines += [f"  {_file(frame)}:{line} in {frame.f_code.co_name}" for frame, line in calls[-_FRAMES:]]
    if source is not None and span is not None:
        lines.append(f"statement: {_short(source.line(span.line).strip())}")
    return "\n    ".join(_plain(line) for line in lines)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(_PACKAGE.name)
    except PackageNotFoundError:  # the package was never installed
        return "of unknown version"


def frames_of(error: BaseException) -> Iterator[tuple[FrameType, int]]:
    """Yield the calls at the time of an exception with their lines, the outermost first."""
    import traceback

    yield from traceback.walk_tb(error.__traceback__)


def _file(frame: FrameType) -> str:
    """Return the path of a call's module, relative to the package."""
    path = Path(frame.f_code.co_filename)
    return str(path.relative_to(_PACKAGE.parent) if path.is_relative_to(_PACKAGE) else Path(*path.parts[-2:]))


def _short(text: str) -> str:
    """Return the first line of a text, shortened if it is long."""
    first = text.partition("\n")[0]
    return first if len(first) <= _LONGEST else first[: _LONGEST - 1] + "…"


def _plain(text: str) -> str:
    """Return a text with escapes for characters that can't be written everywhere."""
    return "".join(one if one.isprintable() else f"\\u{ord(one):04x}" for one in text)
