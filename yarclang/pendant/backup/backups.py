"""Backups and restores that users request: rights, audit trail, and the uploaded backup that waits to be
restored. There is at most one such upload.
"""

from __future__ import annotations

import asyncio
import json
import os
import secrets
import tempfile
from collections.abc import AsyncIterator, Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from yarclang import __version__
from yarclang.pendant.accounts.accounts import Accounts
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.backup.applying import Applied, apply
from yarclang.pendant.backup.bounds import MOST_ZIP
from yarclang.pendant.backup.comparing import Judged, Plan, judged, plan_of
from yarclang.pendant.backup.writing import About, Selection, selected, zipped
from yarclang.pendant.filing import arriving
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.guarded import describes
from yarclang.pendant.project.places import said
from yarclang.pendant.project.room import check_room
from yarclang.pendant.project.trash import Deleted
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

KEPT = "before restore "
"""Beginning of the names of backups in the trash that undo a restore."""

_AT_ONCE = 2
"""Largest number of backups that are made at the same time."""
_WAITS = 900.0
"""Time for which an upload waits to be restored [s]."""
_NAME = "the backup"


@dataclass(slots=True)
class Upload:
    """An uploaded backup.

    Attributes:
        number: number of the upload.
        session: id of the session that has uploaded it.
        handle: descriptor of the uploaded file, which has no name; closed when the upload isn't needed any
            more.
        backup: content of the zip, which has been checked.
        plan: changes that a restore of this backup would make.
        size: size of the zip [bytes].
    """

    number: str
    session: str
    handle: int
    backup: Judged
    plan: Plan
    size: int


class Backups:
    """Backups of a project.

    Args:
        accounts: accounts of the pendant.
        folder: folder of the project.
        robot: robot of the project.
        data: the pendant's own folder, in which uploads are stored.
        doing: returns the name of the program or motion that the robot is executing; empty if the robot
            rests.
    """

    def __init__(
        self, accounts: Accounts, folder: ProjectFolder, robot: Robot, data: Path, doing: Callable[[], str]
    ) -> None:
        self.folder = folder
        self.robot = robot
        self._accounts = accounts
        self._data = data
        self._doing = doing
        self._making = 0
        self._busy = False
        self._waiting: Upload | None = None
        self._forgets: asyncio.TimerHandle | None = None

    # backups

    async def begin(
        self, session: Session, address: str, *, logs: bool
    ) -> tuple[Generator[bytes], Callable[[str], None], str]:
        """Begin a backup.

        Args:
            session: session of the user.
            address: address from which the request came.
            logs: True to include logs of runs.

        Returns:
            Three values: a generator of the zip's bytes (compute each piece in a thread), a function that
                must be called at the end with a text about the outcome (empty after success), and the file
                name of the backup.

        Raises:
            Trouble: the project is too large, or too many backups are being made.
        """
        self._accounts.check(session, Role.SERVICE)
        self._accounts.used(session)
        if self._making >= _AT_ONCE:
            what = f"{self._making} backups are being made"
            raise Trouble(what, "wait until one of them is done", "busy")
        self._making += 1
        try:
            selection = await asyncio.to_thread(lambda: selected(self.folder, logs=logs))
            about = self.about()
            detail = json.dumps(
                {"files": len(selection.files), "size": selection.size, "logs": logs}, sort_keys=True
            )
            deed = Deed(session.user, address, "backup", detail)
            await self._accounts.did(deed)
        except BaseException:
            self._making -= 1
            raise

        def ended(outcome: str) -> None:
            self._making -= 1
            if outcome:
                self._accounts.note(Deed(deed.user, address, deed.action, detail, outcome))

        stamp = about.made[:19].replace("T", " ").replace(":", ".")
        return zipped(self.folder, selection, about), ended, f"{self.robot.name} {stamp}.zip"

    def about(self) -> About:
        """Return the data about yarclang and the robot for a backup that is made now."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return About(__version__, self.robot.name, self.robot.fingerprint, now)

    def selection(self) -> Selection:
        """Return the files that a backup without run logs would contain. This is slow: call it in a thread.

        Raises:
            Trouble: the project is too large.
        """
        return selected(self.folder, logs=False)

    def undoable(self) -> tuple[Deleted, ...]:
        """Return the backups in the trash that undo restores, newest first. Waits for the disk."""
        return tuple(
            one for one in self.folder.trash.kept() if one.file.startswith(KEPT) and not one.is_folder
        )

    # restores

    async def upload(
        self, session: Session, address: str, length: int | None, stream: AsyncIterator[bytes]
    ) -> Upload:
        """Receive a backup and check it. Nothing is unpacked to the disk.

        Args:
            session: session of the user.
            address: address from which the request came.
            length: length of the zip that the client announces [bytes]; None if it announces none.
            stream: the bytes of the zip.

        Raises:
            Trouble: the upload is too large, too slow, or isn't a safe backup, or another upload or restore
                is running.
        """
        self._accounts.check(session, Role.SERVICE)
        self._accounts.used(session)
        if (length or 0) > MOST_ZIP:
            raise _too_large(length or 0)
        with self._alone():
            self.forget()
            handle = await asyncio.to_thread(self._unnamed_file, length or 0)
            try:
                size = 0
                async for piece in arriving(_NAME, stream):
                    size += len(piece)
                    if size > MOST_ZIP:
                        raise _too_large(size)
                    await asyncio.to_thread(_write, handle, piece)
                if length is not None and size != length:
                    raise Trouble(
                        f"the backup has {length:,} bytes, but {size:,} were received", "try again", ""
                    )
                return await self._take(session, address, handle, size)
            except OSError as error:
                raise said(error, _NAME) from None
            finally:
                if self._waiting is None or self._waiting.handle != handle:
                    os.close(handle)

    async def undo(self, session: Session, address: str, number: str) -> Upload:
        """Prepare to undo a restore. The backup of the files that the restore has replaced is loaded from the
        trash, as if it had been uploaded.

        Raises:
            Trouble: the files are no longer in the trash, or an upload or restore is running.
        """
        self._accounts.check(session, Role.SERVICE)
        self._accounts.used(session)
        with self._alone():
            self.forget()
            kept, handle = await asyncio.to_thread(self.folder.trash.open_kept, number)
            try:
                return await self._take(session, address, handle, kept.size)
            finally:
                if self._waiting is None or self._waiting.handle != handle:
                    os.close(handle)

    async def _take(self, session: Session, address: str, handle: int, size: int) -> Upload:
        try:
            backup = await asyncio.to_thread(judged, handle)
        except Trouble as trouble:
            deed = Deed(
                session.user, address, "restore", json.dumps({"size": size}), f"refused: {trouble.what}"[:500]
            )
            self._accounts.note(deed)
            raise
        plan = await asyncio.to_thread(plan_of, self.folder, backup)
        made = Upload(secrets.token_hex(8), session.id, handle, backup, plan, size)
        self._waiting = made
        self._forgets = asyncio.get_running_loop().call_later(_WAITS, self._forget_late, made)
        return made

    def waits(self, session: Session) -> bool:
        """Return True if an upload of a session waits to be restored."""
        return self._waiting is not None and self._waiting.session == session.id

    async def waiting(self, session: Session) -> Upload | None:
        """Return the session's upload that waits to be restored; None if no upload waits, or if an upload or
        restore is running. The plan of the upload has the changes that a restore would make now.
        """
        upload = self._waiting
        if upload is None or upload.session != session.id or self._busy:
            return None
        with self._alone():
            upload.plan = await asyncio.to_thread(plan_of, self.folder, upload.backup)
        return upload

    async def apply(
        self, session: Session, address: str, number: str, digest: str, *, remove: bool
    ) -> tuple[Applied, tuple[str, ...]]:
        """Restore the waiting upload.

        Args:
            session: session of a service user who has entered the PIN recently.
            address: address from which the request came.
            number: number of the upload.
            digest: digest of the list of changes that the user has seen.
            remove: True to remove files of the project that were created after the backup.

        Returns:
            The changes that were made, and the changed files that the pendant reads only when it starts.

        Raises:
            NotAllowed: the session lacks the role or the PIN.
            Trouble: the robot is executing something, the project has changed since the user saw the list,
                the disk has too little space, or a file can't be written.
        """
        self._accounts.check(session, Role.SERVICE, pin=True)
        self._accounts.used(session)
        with self._alone():
            upload = self._waiting
            if upload is None or upload.number != number or upload.session != session.id:
                raise Trouble("this backup no longer exists", "upload it again", "missing")
            if doing := self._doing():
                raise Trouble(f"{doing} is under way", "restore when the robot is at rest", "Y1601")
            detail = json.dumps({"digest": digest, "remove": remove, **_counted(upload)}, sort_keys=True)
            deed = Deed(session.user, address, "restore", detail)
            await self._accounts.did(deed)
            try:
                restored = await asyncio.to_thread(
                    lambda: apply(
                        self.folder, upload.handle, upload.backup, digest, session.user, self.about(),
                            remove=remove
                    )
                )  # fmt: skip
            except Trouble as trouble:
                outcome = f"refused: {trouble.what}"[:500]
                self._accounts.note(Deed(deed.user, address, deed.action, detail, outcome))
                raise
            self.forget()
        return restored, self.restarted((*restored.written, *restored.removed))

    def restarted(self, files: tuple[str, ...]) -> tuple[str, ...]:
        """Return those of the given files that the pendant reads only when it starts."""
        robot = self.robot.folder.resolve()
        return tuple(
            one
            for one in files
            if one == "yarc.toml" or (describes(one) and (self.folder.root / one).is_relative_to(robot))
        )

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Prevent other uploads and restores until the context ends.

        Raises:
            Trouble: another upload or restore is running.
        """
        if self._busy:
            raise Trouble("another backup is being uploaded or restored", "wait for its end", "busy")
        self._busy = True
        try:
            yield
        finally:
            self._busy = False

    def forget(self) -> None:
        """Discard the waiting upload."""
        if self._forgets is not None:
            self._forgets.cancel()
        found, self._waiting, self._forgets = self._waiting, None, None
        if found is not None:
            os.close(found.handle)

    def session_ended(self, session: str) -> None:
        """Discard the upload of a session that has ended."""
        if self._waiting is not None and self._waiting.session == session and not self._busy:
            self.forget()

    def _forget_late(self, upload: Upload) -> None:
        if self._waiting is upload:
            if self._busy:
                self._forgets = asyncio.get_running_loop().call_later(_WAITS, self._forget_late, upload)
            else:
                self.forget()

    def _unnamed_file(self, size: int) -> int:
        """Return the descriptor of a new file without a name. The file disappears when it is closed or
        this process ends.
        """
        try:
            check_room(os.statvfs(self._data), size, "the backup has")
            with tempfile.TemporaryFile(dir=self._data, prefix="restore-") as file:
                return os.dup(file.fileno())
        except OSError as error:
            raise said(error, _NAME) from None


def _counted(upload: Upload) -> dict[str, object]:
    plan = upload.plan
    counts = {"new": len(plan.new), "changed": len(plan.changed), "extra": len(plan.extra)}
    return {**counts, "size": upload.size}


def _write(handle: int, data: bytes) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(handle, view) :]


def _too_large(size: int) -> Trouble:
    return Trouble(
        f"the backup has {size:,} bytes or more, but at most {MOST_ZIP:,} are accepted",
        "copy the folder on the computer itself", "large",
    )  # fmt: skip
