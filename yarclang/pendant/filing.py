"""Changes of the project's files by users: rights, audit trail, and uploads."""

from __future__ import annotations

import asyncio
import hashlib
import json
from collections.abc import AsyncIterator, Callable
from contextlib import ExitStack
from dataclasses import asdict, replace
from typing import Any, TypeVar

from yarclang.pendant.accounts.accounts import Accounts, NotAllowed
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.messages.files import ChangeShown, CommitShown, GitState
from yarclang.pendant.project.authors import PREFIX, Authors, authors_of
from yarclang.pendant.project.draft import Draft
from yarclang.pendant.project.folder import MOST_TEXT, ProjectFolder, Written
from yarclang.pendant.project.git import Git, State
from yarclang.pendant.project.names import quoted
from yarclang.pendant.project.places import said
from yarclang.pendant.project.trash import Deleted
from yarclang.runtime.actions import Trouble

T = TypeVar("T")

MOST_UPLOADED = 100_000_000
"""Largest file that is uploaded [bytes]."""

_AT_ONCE, _OF_ONE = 4, 2
"""Largest number of uploads at the same time: of all sessions together, and of each session."""
_PIECE = 1 << 18
"""Size of the pieces in which an upload is written [bytes]."""
_SILENCE = 20.0
"""Longest time without data in an upload [s]."""
_START, _SLOWEST = 30.0, 10_000
"""Longest time of an upload: `_START` [s], plus its size divided by `_SLOWEST` [bytes/s]."""
_MOST_DEEDS = 20_000
_MOST_HASHED = 200
_LARGEST_HASHED = 16_000_000
_MOST_CHANGES = 2000


class Filing:
    """Access to the project's files for users.

    Args:
        accounts: accounts of the pendant.
        folder: files of the project.
    """

    def __init__(self, accounts: Accounts, folder: ProjectFolder) -> None:
        self.folder = folder
        self._accounts = accounts
        self._git = Git(folder)
        self._asking = asyncio.Lock()
        self._uploads: list[str] = []

    async def save(
        self, session: Session, address: str, file: str, text: str, known_hash: str | None
    ) -> Written:
        """Save the text of a file that a user has edited.

        Args:
            session: session of the user.
            address: address from which the request came.
            file: path in the project.
            text: the new text.
            known_hash: SHA-256 of the version that was edited; None if the file doesn't exist yet.

        Raises:
            Trouble: the file is no longer the version that was edited, or can't be written.
        """
        data = text.encode()
        if len(data) > MOST_TEXT:
            raise Trouble(
                f"{quoted(file)} would have {len(data):,} bytes, but at most {MOST_TEXT:,} can be saved here",
                "divide it, or upload it", "large",
            )  # fmt: skip

        detail = {
            "file": file,
            "size": len(data),
            "sha256": hashlib.sha256(data).hexdigest(),
            "new": known_hash is None,
        }
        return await self._done(
            session, address, "save", detail, lambda: self.folder.write(file, data, known_hash)
        )

    async def change(
        self, session: Session, address: str, file: str, text: str, known_hash: str, description: str
    ) -> Written:
        """Change a file that describes the robot or its cell. The old version is kept in the trash.

        Args:
            session: session of a service user who has entered the PIN recently.
            address: address from which the request came.
            file: path in the project.
            text: the new text.
            known_hash: SHA-256 of the version that was edited.
            description: description of the change, in words.

        Raises:
            NotAllowed: the session lacks the role or the PIN.
            Trouble: the file is no longer the version that was edited, or can't be written.
        """
        self.check_service(session)
        data = text.encode()
        detail = {
            "file": file,
            "size": len(data),
            "sha256": hashlib.sha256(data).hexdigest(),
            "what": description,
        }
        return await self._done(
            session,
            address,
            "change",
            detail,
            lambda: self.folder.change(file, data, known_hash, session.user),
        )

    async def upload(
        self, session: Session, address: str, file: str, known_hash: str | None, length: int | None,
            stream: AsyncIterator[bytes]
    ) -> Written:  # fmt: skip
        """Write an uploaded file while it arrives. If the upload is interrupted, no part of the file is left.

        Args:
            session: session of the user.
            address: address from which the request came.
            file: path in the project.
            known_hash: SHA-256 of the version that is replaced; None if the file doesn't exist yet.
            length: length of the file that the client announces [bytes]; None if it announces none.
            stream: the bytes of the file.

        Raises:
            Trouble: the upload is too large or too slow, there are too many uploads, or the file can't be
                written.
        """
        self._accounts.check(session, Role.PROGRAMMER)
        if (length or 0) > MOST_UPLOADED:
            raise _too_large(file, length or 0)
        if len(self._uploads) >= _AT_ONCE or self._uploads.count(session.id) >= _OF_ONE:
            raise Trouble(
                f"{len(self._uploads)} files are being uploaded, but at most {_OF_ONE} by one person",
                "try again when one of them is done", "busy",
            )  # fmt: skip
        self._uploads.append(session.id)
        drafting = ExitStack()
        try:
            draft = await asyncio.to_thread(drafting.enter_context, self.folder.draft(file, length or 0))
            async for piece in arriving(file, stream):
                await asyncio.to_thread(draft.write, piece)
                if draft.size > MOST_UPLOADED:
                    raise _too_large(file, draft.size)
            if length is not None and draft.size != length:
                raise Trouble(
                    f"{quoted(file)} has {length:,} bytes, but {draft.size:,} were received", "try again", ""
                )
            detail = {"file": file, "size": draft.size, "sha256": draft.sha256, "new": known_hash is None}
            return await self._done(
                session, address, "upload", detail, lambda: self.folder.stand(draft, file, known_hash)
            )
        except OSError as error:
            raise said(error, file) from None
        finally:
            self._uploads.remove(session.id)
            await asyncio.to_thread(drafting.close)

    async def copy(self, session: Session, address: str, file: str, to: str) -> Written:
        """Copy a file to an unused path. See `ProjectFolder.copy`."""
        read = await asyncio.to_thread(self.folder.sha256, file)
        detail = {"file": to, "from": file, "sha256": read}

        def copied() -> Written:
            def check(draft: Draft) -> None:
                if draft.sha256 != read:
                    raise Trouble(f"{quoted(file)} is being changed", "try again", "")

            return self.folder.copy(file, to, check)

        return await self._done(session, address, "copy", detail, copied)

    async def rename(self, session: Session, address: str, file: str, to: str) -> None:
        """Move a file or folder to another path. See `ProjectFolder.rename`."""
        detail = {"file": to, "from": file}
        guarded = self.folder.guarded
        await self._done(
            session,
            address,
            "rename",
            detail,
            lambda: self.folder.rename(file, to),
            lambda: guarded.objection(file, to),
        )

    async def make_folder(self, session: Session, address: str, file: str) -> None:
        """Create a folder. See `ProjectFolder.make_folder`."""
        await self._done(session, address, "folder", {"file": file}, lambda: self.folder.make_folder(file))

    async def delete(self, session: Session, address: str, file: str) -> Deleted:
        """Move a file or folder to the trash. See `ProjectFolder.delete`."""
        return await self._done(
            session, address, "delete", {"file": file}, lambda: self.folder.delete(file, session.user)
        )

    async def restore(self, session: Session, address: str, number: str) -> str:
        """Restore a file or folder from the trash. See `ProjectFolder.restore`."""
        kept = await asyncio.to_thread(self.folder.trash.kept)
        file = next((one.file for one in kept if one.number == number), "")

        def objection() -> str:
            content = self.folder.trash.content(number)
            return "" if content is None else self.folder.guarded.objection_to_kept(content, file)

        detail = {"file": file, "number": number}
        return await self._done(
            session, address, "restore", detail, lambda: self.folder.restore(number), objection
        )

    async def _done(
        self,
        session: Session,
        address: str,
        action: str,
        detail: dict[str, Any],
        do: Callable[[], T],
        objection: Callable[[], str] | None = None,
    ) -> T:
        """Carry out an action that changes files, in a thread. The action is written to the audit trail
        first, and its failure afterwards.

        Args:
            session: session of the user.
            address: address from which the request came.
            action: name of the action.
            detail: details for the audit trail; the key `file` has the path that is changed.
            do: function that carries out the action.
            objection: function that returns the reason why only service users may carry out the action, or an
                empty text if programmers may, too. None to decide by the path in `detail`.
        """
        self._accounts.check(session, Role.PROGRAMMER)
        self._accounts.used(session)
        objects = objection or (lambda: self.folder.guarded.objection(detail["file"]))
        deed = Deed(
            session.user, address, f"{PREFIX}{action}", json.dumps(detail, ensure_ascii=False, sort_keys=True)
        )

        def check() -> None:
            reason = objects()
            if reason:
                self._check_service(session, reason)

        def checked() -> T:
            # Lock the folder. Otherwise another request could change the target of a link between the check
            # and the action.
            with self.folder.unchanged():
                check()
                return do()

        try:
            await asyncio.to_thread(check)
        except NotAllowed as refused:
            if refused.code != "pin":
                self._accounts.note(replace(deed, outcome=f"refused: {refused.what}"[:500]))
            raise
        await self._accounts.did(deed)
        try:
            return await asyncio.to_thread(checked)
        except Trouble as trouble:
            self._accounts.note(
                Deed(deed.user, address, deed.action, deed.detail, f"refused: {trouble.what}"[:500])
            )
            raise

    def check_service(self, session: Session) -> None:
        """Check that a session may change a file that describes the robot or its cell.

        Raises:
            NotAllowed: the user has no service role, or hasn't entered the PIN recently.
        """
        self._accounts.check(session, Role.SERVICE, pin=True)

    def _check_service(self, session: Session, reason: str) -> None:
        try:
            self._accounts.check(session, Role.SERVICE, pin=True)
        except NotAllowed as refused:
            raise NotAllowed(f"{reason}: {refused.what}", refused.remedy, refused.code) from None

    # since the last commit

    async def changed(self) -> GitState:
        """Return the changes since the last commit, and the users who made them."""
        async with self._asking:
            try:
                state = await asyncio.to_thread(self._git.state)
            except Trouble as trouble:
                what = f"{trouble.what}: {trouble.remedy}"
                return GitState(there=False, what=what, commit=None, changes=(), cut=False)
        if state is None:
            what = "the project's folder is in no git repository"
            return GitState(there=False, what=what, commit=None, changes=(), cut=False)
        since = state.commit.when if state.commit else ""
        deeds = await self._accounts.deeds_since(PREFIX, since, _MOST_DEEDS)
        return await asyncio.to_thread(self._detail_text, state, [deed for _, deed in deeds])

    async def difference(self, file: str) -> tuple[str, str]:
        """Return the text of a file in the last commit, and its present text. See `Git.difference`."""
        async with self._asking:
            return await asyncio.to_thread(self._git.difference, file)

    def _detail_text(self, state: State, deeds: list[Deed]) -> GitState:
        authors = authors_of(deeds)
        shown_detail = []
        for count, (file, kind) in enumerate(list(state.changes.items())[:_MOST_CHANGES]):
            found = authors.get(file, Authors())
            outside = found.sha256 is None
            if not outside and count < _MOST_HASHED and found.sha256 != "?":
                outside = found.sha256 != self._present(file)
            shown_detail.append(ChangeShown(file=file, kind=kind, by=tuple(found.users), outside=outside))
        commit = None if state.commit is None else CommitShown(**asdict(state.commit))
        cut = state.cut or len(state.changes) > _MOST_CHANGES
        return GitState(there=True, what="", commit=commit, changes=tuple(shown_detail), cut=cut)

    def _present(self, file: str) -> str:
        try:
            return self.folder.read(file, _LARGEST_HASHED)[1].sha256
        except Trouble:
            return ""


async def arriving(file: str, stream: AsyncIterator[bytes]) -> AsyncIterator[bytes]:
    """Yield the data of an upload, joined to pieces that are large enough to write efficiently.

    Args:
        file: name of the file, for error messages.
        stream: the received data.

    Raises:
        Trouble: the data arrives too slowly.
    """
    clock = asyncio.get_running_loop().time
    begun, received = clock(), 0
    waiting: list[bytes] = []
    size = 0
    while True:
        try:
            data = await asyncio.wait_for(anext(stream, None), _SILENCE)
        except TimeoutError:
            raise _too_slow(file) from None
        if data is None:
            break
        received += len(data)
        if clock() - begun > _START + received / _SLOWEST:
            raise _too_slow(file)
        waiting.append(data)
        size += len(data)
        if size >= _PIECE:
            yield b"".join(waiting)
            waiting, size = [], 0
    if waiting:
        yield b"".join(waiting)


def _too_large(file: str, size: int) -> Trouble:
    return Trouble(
        f"{quoted(file)} has {size:,} bytes or more, but at most {MOST_UPLOADED:,} can be uploaded",
        "copy it on the computer itself", "large",
    )  # fmt: skip


def _too_slow(file: str) -> Trouble:
    return Trouble(f"{quoted(file)} is transferred too slowly", "check the network, and try again", "")
