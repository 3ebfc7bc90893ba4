"""Writing of a calibration's result to a file. The new text is first proposed to the user. When it is
written, the old version of the file is saved.
"""

from __future__ import annotations

import asyncio
from pathlib import Path

from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import finding_message
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.calibrating.kept import Calibration, Calibrations
from yarclang.pendant.calibrating.texts import Made, in_cell, in_program, in_robot
from yarclang.pendant.filing import Filing
from yarclang.pendant.messages.calibration import (
    CalibrationProposal,
    CalibrationWritten,
    ProposeCalibration,
    WriteCalibration,
)
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.git import text_of
from yarclang.pendant.project.names import quoted
from yarclang.pendant.watched import Watched
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile

ROLES = {"robot": Role.SERVICE, "cell": Role.SERVICE, "program": Role.PROGRAMMER}
"""Role that a user needs to write a result to each kind of file. For robot and cell files the user needs
the PIN as well.
"""

_MOST = 2_000_000
"""Longest robot or cell file that is changed [bytes]."""
_SUFFIX = ".yarc"


class Writing:
    """Writer of calibration results.

    Args:
        robot: robot that was calibrated.
        watched: client of the coordinator, which knows the session's cell and its frames.
        files: files of the project.
        calibrations: running calibrations of all sessions.
    """

    def __init__(self, robot: Robot, watched: Watched, files: Filing, calibrations: Calibrations) -> None:
        self._robot = robot
        self._watched = watched
        self._files = files
        self._kept = calibrations

    async def propose(self, session: Session, request: ProposeCalibration) -> CalibrationProposal:
        """Return the text of a file with the result, without writing it.

        Raises:
            Trouble: there is no result, or it can't be put into that file.
        """
        calibration = self._result(session, request)
        place, file = await self._place(request)
        await self._check_free(calibration, request)
        if file is None:
            before = await asyncio.to_thread(_read, place)
        else:
            before, known_hash = await asyncio.to_thread(_text, self._files.folder, file)
        made_texts = await asyncio.to_thread(self._made_texts, before, place, calibration, request)
        obstacle = ""
        if file is None:
            known_hash = ""
            obstacle = (
                f"{place} isn't in the project, so the pendant can't change it: copy its folder "
                f"into the project, "
                "and start the pendant with --robot and that path"
            )
        return CalibrationProposal(
            file=file or str(place),
            before=before,
            after=made_texts.text,
            known=known_hash,
            findings=tuple(map(finding_message, made_texts.findings)),
            what=made_texts.what,
            then=made_texts.then,
            obstacle=obstacle,
        )

    async def write(self, session: Session, address: str, request: WriteCalibration) -> CalibrationWritten:
        """Write a proposed result.

        Args:
            session: session of the user.
            address: address from which the request came.
            request: file for the result, and the hash of the proposed text that the user has seen.

        Raises:
            Trouble: the file has changed since the proposal, or the result can't be written to it.
        """
        calibration = self._result(session, request)
        place, file = await self._place(request)
        if file is None:
            raise Trouble(f"{place} isn't in the project", "copy its folder into the project", "outside")
        await self._check_free(calibration, request)
        before, hash_now = await asyncio.to_thread(_text, self._files.folder, file)
        if hash_now != request.known:
            raise Trouble(f"{quoted(file)} has changed meanwhile", "review the difference again", "changed")
        made_texts = await asyncio.to_thread(self._made_texts, before, place, calibration, request)
        self._kept.going_on(session, request.version)
        if request.to == "program":
            written = await self._files.save(session, address, file, made_texts.text, hash_now)
        else:
            written = await self._files.change(
                session, address, file, made_texts.text, hash_now, f"calibration: {made_texts.what}"
            )
        return CalibrationWritten(file=written.file, sha256=written.sha256, then=made_texts.then)

    def _result(self, session: Session, request: ProposeCalibration) -> Calibration:
        found = self._kept.going_on(session, request.version)
        if not found.touching.result_text():
            raise Trouble("there is no result yet", found.touching.next_step(), "result")
        return found

    async def _place(self, request: ProposeCalibration) -> tuple[Path, str | None]:
        """Return two values: the absolute path of the file for the result, and the file's path in the
        project (None if the file is outside of the project).
        """
        folder = self._files.folder
        if request.to == "program":
            if not request.file.lower().endswith(_SUFFIX):
                problem = f"{quoted(request.file)} is no program"
                raise Trouble(problem, f"choose a file with the extension {_SUFFIX}", "file")
            return await asyncio.to_thread(folder.path, request.file), request.file
        if request.to == "robot":
            place = self._robot.file
        else:
            cell = (await self._watched.attached.ask(orders.AskStatus())).cell
            if cell is None:
                problem = "the robot has no cell: yarc.toml names none"
                raise Trouble(problem, "write the frame into a program, or enter a cell in yarc.toml", "cell")
            place = Path(cell)
        place = await asyncio.to_thread(place.resolve)
        inside = place.relative_to(folder.root).as_posix() if place.is_relative_to(folder.root) else None
        return place, inside

    async def _check_free(self, calibration: Calibration, request: ProposeCalibration) -> None:
        """Check that the name of a new tool in robot.toml isn't already that of a frame of the cell or the
        session.
        """
        name = calibration.touching.name
        if request.to == "robot" and calibration.kind == "tip" and name not in self._robot.flange_from_frame:
            frames = (await self._watched.attached.ask(orders.AskFrames())).frames
            if any(one.name.upper() == f"{{{name}}}" for one in frames):
                what = f"{{{name}}} is a frame of the cell or of this session already"
                raise Trouble(what, "choose another name", "name")

    def _made_texts(
        self, text: str, place: Path, calibration: Calibration, request: ProposeCalibration
    ) -> Made:
        source, touching = SourceFile(str(place), text), calibration.touching
        match request.to:
            case "robot":
                return in_robot(source, place, self._robot, touching, replace=request.replace)
            case "cell":
                return in_cell(source, place, self._robot, touching, request.parent, replace=request.replace)
            case "program":
                return in_program(source, place, self._robot, touching, replace=request.replace)


def _text(folder: ProjectFolder, file: str) -> tuple[str, str]:
    data, told = folder.read(file)
    return text_of(file, data), told.sha256


def _read(place: Path) -> str:
    """Return the text of a robot.toml or cell.toml outside of the project."""
    try:
        with place.open("rb") as file:
            return file.read(_MOST).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Trouble(f"{place} can't be read: {error}", "look at the file", "") from None
