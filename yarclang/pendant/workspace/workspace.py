"""The workspace around the robot: zones and obstacles of the session's cell, and joint limits. It is shown,
changed by drafts, and saved by service users. The present distances between bodies are computed as well.
"""

from __future__ import annotations

import asyncio
from pathlib import Path

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.zones.watched import tool_frame
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.replies import Surroundings
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.filing import Filing
from yarclang.pendant.messages.files import FileWritten
from yarclang.pendant.messages.workspace import (
    CheckShown,
    Distances,
    DistanceShown,
    Proposed,
    SavedWorkspace,
    WorkspaceDraft,
    WorkspaceShown,
)
from yarclang.pendant.project.folder import Written
from yarclang.pendant.watched import Watched
from yarclang.pendant.workspace.around import (
    Around,
    around_of,
    check_known,
    digest_of,
    proposed_of,
    shown_of,
)
from yarclang.pendant.workspace.changing import with_entries
from yarclang.pendant.workspace.checks import Checks, Question
from yarclang.pendant.workspace.distances import Near, nearest
from yarclang.pendant.workspace.reading import (
    Text,
    cell_of,
    text_in,
)
from yarclang.pipeline.project import FILE_NAME
from yarclang.robot.library import DESCRIPTION
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.toml.changes import ChangeError, with_value
from yarclang.units import MM

_PROGRAM = ".yarc"
_MOST_PROGRAMS = 1000
_EACH = 1.0
"""Time between two checks for changes of the files from which distances are computed [s]."""
_LONGEST = 30_000
"""Longest cell.toml for which distances are computed with a draft [characters]. With a longer file the draft
is ignored, because its text is parsed several times a second.
"""
_NEW_CELL = 'units = "mm,deg,s"\n'
_NOW = "It applies to offers, jogs and programs that are loaded from now on. "
_RESTART = (
    "robot.toml takes effect when the robot is served again and its settings are sent (System > Controller). "
)


class Workspace:
    """The workspace of a pendant.

    Args:
        robot: robot of the pendant.
        watched: shared client of the coordinator, with the robot's present state.
        filing: the files of the project.
        checks: checks of programs.
    """

    def __init__(self, robot: Robot, watched: Watched, filing: Filing, checks: Checks) -> None:
        self._robot = robot
        self._watched = watched
        self._filing = filing
        self._checks = checks
        self._measuring = asyncio.Lock()
        self._cells: tuple[str, Cell | None] = ("", None)
        self._around_at: tuple[float, Around] | None = None
        self._measured: tuple[tuple[object, bytes], tuple[Near, ...]] | None = None

    async def shown(self) -> WorkspaceShown:
        """Return the message that shows the workspace, as described by its files.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        return await asyncio.to_thread(shown_of, self._robot, await self._asked())

    async def proposed(self, draft: WorkspaceDraft) -> Proposed:
        """Return the files that a draft changes, with their texts before and after the change. Nothing is
        written.

        Raises:
            Trouble: the files have changed since the draft was begun (code "changed"), or the pendant can't
                change them.
        """
        return Proposed(files=await asyncio.to_thread(proposed_of, self._robot, await self._asked(), draft))

    async def save(self, session: Session, address: str, draft: WorkspaceDraft) -> SavedWorkspace:
        """Write the files with the changes of a draft.

        Args:
            session: session of a service user who has entered the PIN recently.
            address: address from which the request came.
            draft: the changes.

        Raises:
            NotAllowed: the session lacks the role or the PIN.
            Trouble: the robot moves, a file is no longer the version that was edited or would become invalid,
                the draft changes nothing, or a file can't be written.
        """
        self._filing.check_service(session)
        files = await asyncio.to_thread(proposed_of, self._robot, await self._asked(), draft)
        if not files:
            raise Trouble("nothing is changed", "change something first", "")
        for file in files:
            if file.refused:
                raise Trouble(f"{file.file} isn't saved: {file.refused}", "correct the draft", "")
        outcome = self._checks.outcome(digest_of(files))
        written: list[Written] = []
        self._around_at = None
        for file in files:
            what = f"{file.what} ({outcome})"
            try:
                self._check_rest()
                written.append(
                    await self._filing.change(session, address, file.file, file.after, file.known, what)
                )
            except Trouble as trouble:
                if not written:
                    raise
                half = f"{written[0].file} is saved, and {file.file} isn't: {trouble.what}"
                raise Trouble(half, "open the page again", "changed") from None
        told = "".join(
            _RESTART if Path(file.file).name.lower() == DESCRIPTION else f"{file.file} is saved. {_NOW}"
            for file in files
        )
        return SavedWorkspace(files=tuple(_written(file) for file in written), told=told.strip())

    async def make(self, session: Session, address: str, file: str) -> SavedWorkspace:
        """Create the cell.toml of a project that has no cell, and name the new file in yarc.toml.

        Raises:
            NotAllowed: the session lacks the role or the PIN.
            Trouble: the robot moves, there is already a cell or a file of this name, or the new file or
                yarc.toml can't be written.
        """
        self._filing.check_service(session)
        self._check_rest()
        if (await self._asked()).cell is not None:
            raise Trouble("the robot has a cell already", "open the page again", "")
        if not file.lower().endswith(".toml"):
            raise Trouble(f"{file[:80]} doesn't end in .toml", "choose another name", "")
        folder = self._filing.folder

        def project() -> tuple[str, Text | None]:
            path = folder.root / FILE_NAME
            before = text_in(folder, path) if path.exists() else None
            source = SourceFile(FILE_NAME, "" if before is None else before.text)
            try:
                text = with_value(source, ("cell",), file)
            except ChangeError as error:
                raise Trouble(
                    f"{FILE_NAME} can't be changed here: {error}",
                    f'write cell = "{file}" into it by hand', "",
                ) from None  # fmt: skip
            return ("" if before is None else before.mark) + text, before

        text, before = await asyncio.to_thread(project)
        written = [await self._filing.save(session, address, file, _NEW_CELL, None)]
        if before is None:
            written.append(await self._filing.save(session, address, FILE_NAME, text, None))
        else:
            what = f"cell from none to {file}"
            written.append(await self._filing.change(session, address, FILE_NAME, text, before.known, what))
        return SavedWorkspace(files=tuple(map(_written, written)), told=f"{file} is made. {_NOW}".strip())

    # programs

    async def check(self, session: Session, draft: WorkspaceDraft) -> CheckShown:
        """Begin to check which programs have errors with a draft.

        Raises:
            Trouble: the check of another session is running, or the draft doesn't fit the files.
        """
        around = await self._asked()
        files = await asyncio.to_thread(proposed_of, self._robot, around, draft)
        folder = self._filing.folder
        programs_found, _ = await asyncio.to_thread(folder.programs, _MOST_PROGRAMS)
        q = self._watched.showing.joints
        root = folder.root
        drafts = {str(root / file.file): file.after for file in files}
        for file in files:  # the process of the checks may open robot.toml by another path
            if Path(file.file).name == DESCRIPTION:
                drafts[str((self._robot.folder / DESCRIPTION).absolute())] = file.after
        question = Question(
            root,
            tuple(file.file for file in programs_found if file.file.lower().endswith(_PROGRAM)),
            str(self._robot.folder),
            None if around.cell is None else str(around.cell),
            drafts,
            None if q is None else tuple(q.tolist()),
            digest_of(files),
        )
        self._checks.begin(session, question)
        return self._checks.shown(session)

    # distances

    async def distances(self, draft: WorkspaceDraft | None) -> Distances:
        """Return the smallest distances between bodies, and to the borders of zones, at the robot's present
        position. Only one computation runs at a time.

        Raises:
            Trouble: the draft doesn't fit the files.
        """
        q = self._watched.showing.joints
        if q is None:
            return Distances(pairs=(), what="the robot's position is unknown")
        async with self._measuring:
            cell = await self._cell_with(draft)
            key = (cell, np.round(q, 4).tobytes())
            if self._measured is None or self._measured[0] != key:
                found = await asyncio.to_thread(nearest, self._robot, cell, tool_frame(self._robot), q)
                self._measured = key, found
            text = (await self._lately()).text
            is_long = draft is not None and text is not None and len(text.text) > _LONGEST
            what = "the file is too long to check while editing: these are the distances for the saved file"
            return Distances(pairs=tuple(map(_near_shown, self._measured[1])), what=what * is_long)

    async def _cell_with(self, draft: WorkspaceDraft | None) -> Cell | None:
        """Return the cell with the changes of a draft; None without a cell. As long as the text of the cell
        with the draft doesn't change, the same object is returned.
        """
        around = await self._lately()

        def read() -> tuple[str, Cell | None]:
            path = around.cell
            if path is None:
                return "", None
            text = around.text
            source = SourceFile(str(path), path.read_text("utf-8-sig")) if text is None else text.placed
            if draft is not None and draft.entries and text is not None and len(text.text) <= _LONGEST:
                check_known(text, draft.known)
                source = SourceFile(str(path), with_entries(text.source, draft.entries)[0])
            key = f"{path}\n{source.text}"
            if key == self._cells[0]:
                return self._cells
            return key, cell_of(source, path.parent, self._robot)[0]

        try:
            self._cells = await asyncio.to_thread(read)
        except (OSError, UnicodeDecodeError):
            return None
        return self._cells[1]

    # files

    async def _lately(self) -> Around:
        """Return the files of the workspace. They are read at most once a second, because the coordinator has
        to ask the controller for each reading.
        """
        now = asyncio.get_running_loop().time()
        if self._around_at is None or now - self._around_at[0] > _EACH:
            self._around_at = now, await self._asked()
        return self._around_at[1]

    async def _asked(self) -> Around:
        told: Surroundings = await self._watched.attached.ask(orders.AskSurroundings())
        return await asyncio.to_thread(around_of, self._filing.folder, told)

    def _check_rest(self) -> None:
        doing = self._watched.showing.under_way
        if doing:
            raise Trouble(f"{doing} is under way", "save when the robot is at rest", "Y1601")


def _written(written: Written) -> FileWritten:
    return FileWritten(file=written.file, size=written.size, sha256=written.sha256, changed=written.changed)


def _near_shown(near: Near) -> DistanceShown:
    points = () if near.points is None else tuple(np.round(near.points, 5).ravel().tolist())
    return DistanceShown(
        first=near.first,
        second=near.second,
        distance=round(near.distance / MM, 2),
        margin=round(near.margin / MM, 2),
        points=points,
    )
