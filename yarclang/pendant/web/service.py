"""State of a pendant that all requests share, such as accounts, robot and files, and the session to which
a request belongs.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from starlette.requests import HTTPConnection

from yarclang.pendant.accounts.accounts import Accounts, NotAllowed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.alarms.alarms import Alarms
from yarclang.pendant.backup.backups import Backups
from yarclang.pendant.calibrating.kept import Calibrations
from yarclang.pendant.calibrating.writing import Writing
from yarclang.pendant.filing import Filing
from yarclang.pendant.gate import Gate
from yarclang.pendant.health.sampling import Sampler
from yarclang.pendant.life import Descriptions, Life
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.runs.folders import LogFolders
from yarclang.pendant.runs.listing import Listing
from yarclang.pendant.runs.reading import Readings
from yarclang.pendant.scene.programs import ProgramScenes
from yarclang.pendant.scene.scenery import Scenery
from yarclang.pendant.seats import Attach, Seats
from yarclang.pendant.signals import Signals
from yarclang.pendant.watched import Watched
from yarclang.pendant.workspace.checks import Checks
from yarclang.pendant.workspace.workspace import Workspace
from yarclang.robot.model import Robot

COOKIE, DEVICE = "yarc_session", "yarc_device"


@dataclass(frozen=True, slots=True)
class Service:
    """State of a pendant that all requests share.

    Attributes:
        robot: the robot.
        accounts: the users and their sessions.
        seats: the sessions' clients of the coordinator.
        watched: shared client of the coordinator, with the robot's present state.
        gate: checks orders and lets the coordinator carry them out.
        files: files of the project, with the rights to change them.
        scenery: three-dimensional scene of the robot in its cell.
        program_scenes: three-dimensional scenes of loaded programs, each in its own cell.
        calibrations: running calibrations of all sessions.
        calibration_writing: writes results of calibrations.
        signals: values of inputs and outputs.
        workspace: zones and obstacles of the cell, and joint limits.
        checks: checks of the programs with a draft, that is, with unsaved changes of the workspace.
        alarms: alarms of the robot and the pendant.
        log_folders: folders of run logs.
        runs: list of run logs.
        readings: reader of the content of run logs.
        life: receiver of requests to end the process.
        descriptions: files that the process reads only when it starts.
        backups: backups of the project.
        sampler: regular measurements of the computer and the process.
        closing: functions that are called when a session ends, by the session's id.
    """

    robot: Robot
    accounts: Accounts
    seats: Seats
    watched: Watched
    gate: Gate
    files: Filing
    scenery: Scenery
    program_scenes: ProgramScenes
    calibrations: Calibrations
    calibration_writing: Writing
    signals: Signals
    workspace: Workspace
    checks: Checks
    alarms: Alarms
    log_folders: LogFolders
    runs: Listing
    readings: Readings
    life: Life
    descriptions: Descriptions
    backups: Backups
    sampler: Sampler
    closing: dict[str, set[Callable[[], object]]]

    @classmethod
    def opened(
        cls,
        robot: Robot,
        attach: Attach,
        folder: Path,
        database: Path,
        *,
        logs: Path | None = None,
        life: Life | None = None,
    ) -> Service:
        """Create the state of a pendant for a robot, and open its database.

        Args:
            robot: the robot.
            attach: attaches new clients to the robot's coordinator.
            folder: folder of the project.
            database: file with users, sessions, audit trail and alarms.
            logs: folder or file into which runs are logged; None if unknown.
            life: object that receives users' requests to end this process; None if users can't end it at the
                pendant.

        Raises:
            Trouble: the database can't be used.
        """
        seats = Seats(attach)
        closing: dict[str, set[Callable[[], object]]] = {}

        def ended(session: Session) -> None:
            seats.leave(session.id)
            program_scenes.forget(session.id)
            backups.session_ended(session.id)
            calibrations.forget(session.id)
            for close in closing.pop(session.id, set()):
                close()

        accounts = Accounts(database, ended)

        def audit() -> str:
            return "" if accounts.trouble is None else accounts.trouble.what

        watched = Watched(robot, attach, seats, audit)
        project = ProjectFolder(folder, database, (robot.folder,))
        scenery = Scenery(robot, watched.showing, lambda: watched.is_watched)
        program_scenes = ProgramScenes(robot, seats, lambda: scenery.drawn)
        signals = Signals(robot, time.monotonic)
        gate = Gate(accounts, seats, watched, project, time.monotonic, program_scenes.remember)
        files = Filing(accounts, project)
        backups = Backups(
            accounts, project, robot, database.resolve().parent, lambda: watched.showing.under_way
        )
        checks = Checks()
        workspace = Workspace(robot, watched, files, checks)
        watched.attend(scenery.watch, scenery.hear)
        watched.attend(signals.watch, signals.hear)
        alarms = Alarms(accounts.database, watched.showing, audit)
        watched.attend(alarms.watch, alarms.hear, alarms.lost)
        folders = LogFolders(project, logs, database)
        sampler = Sampler(accounts, watched, project.root, database, folders, time.monotonic)
        alarms.low = sampler.low
        calibrations = Calibrations(robot, watched)
        return cls(
            robot=robot,
            accounts=accounts,
            seats=seats,
            watched=watched,
            gate=gate,
            files=files,
            scenery=scenery,
            program_scenes=program_scenes,
            signals=signals,
            workspace=workspace,
            checks=checks,
            alarms=alarms,
            log_folders=folders,
            runs=Listing(folders),
            readings=Readings(),
            calibrations=calibrations,
            calibration_writing=Writing(robot, watched, files, calibrations),
            life=life or Life(),
            descriptions=Descriptions(robot, folder),
            backups=backups,
            sampler=sampler,
            closing=closing,
        )

    def session(self, connection: HTTPConnection, role: Role = Role.VIEWER, *, pin: bool = False) -> Session:
        """Return the session to which a request or a WebSocket belongs, according to its cookie. Check the
        user's rights.

        Args:
            connection: the request or WebSocket.
            role: role that the user needs.
            pin: True if the PIN must also have been entered recently.

        Raises:
            NotAllowed: nobody is logged in, or the role or the PIN is missing.
        """
        found = self.accounts.session_of(connection.cookies.get(cookie(connection, COOKIE), ""))
        if found is None:
            raise NotAllowed("nobody is logged in here", "log in", "login")
        self.accounts.check(found, role, pin=pin)
        return found


def cookie(connection: HTTPConnection, name: str) -> str:
    """Return the name of a cookie for a connection. With TLS the name gets the prefix `__Host-`, so that
    browsers accept the cookie only from this server.
    """
    return f"__Host-{name}" if is_secure(connection) else name


def is_secure(connection: HTTPConnection) -> bool:
    """Return True if a connection is encrypted."""
    return connection.url.scheme in ("https", "wss")


def address_of(connection: HTTPConnection) -> str:
    """Return the address from which a request comes."""
    return connection.client.host if connection.client else "unknown"
