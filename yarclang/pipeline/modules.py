"""Find modules: beside the program, or else in the standard library."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

from yarclang.consulted import modules_in
from yarclang.diagnostics import Diagnostic, Result
from yarclang.pipeline.sources import NO_TEXTS, read_source
from yarclang.robot.library import stdlib_folder
from yarclang.source import SourceFile
from yarclang.subjects import unknown
from yarclang.syntax.ast import Module
from yarclang.syntax.parse import parse

SUFFIX = ".yarc"


def loader(folder: Path, texts: Mapping[Path, SourceFile] = NO_TEXTS) -> Callable[[str], Result[Module]]:
    """Return a function that reads the modules of a program in `folder`.

    The function takes a module's name in upper case; the name of the file may be in any case. It returns the
    parsed module, or a finding that lists the modules that exist. `texts` are files that are open in an
    editor, by their absolute paths: they take precedence over saved files.
    """

    @cache  # for one check: files that appear later don't count
    def library() -> list[Path]:
        return modules_in(library_folder())

    unsaved = [path for path in texts if path.parent == folder.absolute() and path.suffix == SUFFIX]

    def load(name: str) -> Result[Module]:
        for path in (*unsaved, *modules_in(folder, name), *library()):
            if path.stem.upper() == name:
                text, findings = texts.get(path.absolute()), tuple[Diagnostic, ...]()
                if text is None:
                    read = read_source(str(path))
                    text, findings = read.value, read.diagnostics
                if text is None:
                    return Result(None, findings)
                return parse(replace(text, module=name, is_installed=path in library()))
        known = sorted({path.stem.upper() for path in library()})
        subject = unknown(name, [path.stem.upper() for path in (*unsaved, *modules_in(folder), *library())])
        listed = ", ".join(known) or "none"
        help_ = (
            subject.question or f"a module is a file beside the program; the standard library has {listed}"
        )
        return Result(None, (Diagnostic("Y0213", f"no module is named {name}", help=help_, subject=subject),))

    return load


def library_folder() -> Path:
    """Return the folder of the standard library's modules."""
    return stdlib_folder() / "modules"
