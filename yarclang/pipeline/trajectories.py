"""Find the files of timed trajectories, in the folder of the program or module that names them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from yarclang.diagnostics import Diagnostic, Result
from yarclang.memory import NO_MEMORY, Memory
from yarclang.pipeline.cells import file_of
from yarclang.pipeline.kept import Stamp, stamp_of, trajectory_kept
from yarclang.pipeline.sources import NO_TEXTS, read_source
from yarclang.semantics.motions.trajectory_file import SUFFIX, TrajectoryFile
from yarclang.source import SourceFile


class TrajectoryLoader:
    """Reader of the trajectory files that a program names. A file that has changed is read again.

    Args:
        folder: folder of the program.
        texts: files that are open in an editor; they replace the saved files.
        memory: cache of what was read.
    """

    def __init__(
        self, folder: Path, texts: Mapping[Path, SourceFile] = NO_TEXTS, memory: Memory = NO_MEMORY
    ) -> None:
        self._folder = folder
        self._texts = texts
        self._memory = memory
        self._known: dict[Path, tuple[Stamp, Result[TrajectoryFile]]] = {}

    def __call__(self, path: str, module: SourceFile | None) -> Result[TrajectoryFile]:
        """Read the trajectory file that a line names.

        Args:
            path: path in the line.
            module: module with the line; None: the program.

        Returns:
            None, with a finding that has no line yet, if the file isn't beside the program, or can't be read
            as text.
        """
        folder = self._folder if module is None else Path(module.name).parent
        refusal = _refusal(path, folder)
        if refusal is not None:
            return Result(None, (refusal,))
        place = folder / path
        stamp = stamp_of((place,))
        known = self._known.get(place)
        if known is not None and known[0] == stamp:
            return known[1]
        text = self._texts.get(place.absolute()) or self._texts.get(file_of(place))

        def read() -> Result[TrajectoryFile]:
            found = Result(text) if text is not None else read_source(str(place))
            return Result(None if found.value is None else TrajectoryFile(found.value), found.diagnostics)

        made = trajectory_kept(self._memory, place, None if text is None else text.text, read)
        self._known[place] = stamp, made
        return made


def _refusal(path: str, folder: Path) -> Diagnostic | None:
    """Return a finding unless a path names a trajectory file in the folder `folder` or below it."""
    if not path.lower().endswith(SUFFIX) or not path.isprintable():
        message = f"{path[-60:]!r} doesn't end in {SUFFIX}, as trajectory files do"
        return Diagnostic("Y1385", message, help='name a CSV file beside the program, for example "path.csv"')
    whole = file_of(folder)
    place = file_of(whole / path)
    if Path(path).is_absolute() or not place.is_relative_to(whole):
        message = f"{path[-60:]!r} isn't in the folder of the file that names it"
        return Diagnostic("Y1385", message, help=f'copy it there, and write "{place.name}"')
    return None
