"""HTTP routes for backups of the project: download, upload, check, restore and undo."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Generator

from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from yarclang.coordinator.messages.replies import Done
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.backup.backups import Backups, Upload
from yarclang.pendant.backup.bounds import MOST_ZIP
from yarclang.pendant.messages.backup import (
    ApplyRestore,
    BackupShown,
    FileAndWhy,
    KeptRestore,
    PlannedFile,
    Restored,
    RestorePlan,
    UndoRestore,
)
from yarclang.pendant.project.trash import Deleted
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.files import disposition
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service, address_of
from yarclang.runtime.actions import Trouble

_MOST_SHOWN = 2000
_SILENCE = 30.0
"""Longest time that a client may take to accept the next piece of a download [s]. After it the download is
aborted, so that a client that stops reading doesn't block other backups.
"""


class _Zip(StreamingResponse):
    """HTTP response with a backup as a zip. It calls `ended` at the end, with an empty text if the client
    has received the whole zip.
    """

    def __init__(self, pieces: Generator[bytes], ended: Callable[[str], None], name: str) -> None:
        headers = {"content-disposition": disposition(name), "cache-control": "no-store"}
        super().__init__(_taken_pieces(pieces), headers=headers, media_type="application/zip")
        self._pieces = pieces
        self._told_end = ended

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        outcome = "broken off"

        async def sent(message: dict[str, object]) -> None:
            nonlocal outcome
            await asyncio.wait_for(send(message), _SILENCE)
            if message["type"] == "http.response.body" and not message.get("more_body"):
                outcome = ""

        try:
            # After a timeout the response stays incomplete, so the server closes the connection.
            with contextlib.suppress(TimeoutError):
                await super().__call__(scope, receive, sent)  # type: ignore[arg-type]  # a message is a dict
        finally:
            self._told_end(outcome)
            with contextlib.suppress(ValueError):  # a thread is still reading; it ends by itself
                self._pieces.close()


async def _taken_pieces(pieces: Generator[bytes]) -> AsyncIterator[bytes]:
    end = b"end"
    while (piece := await asyncio.to_thread(next, pieces, end)) is not end:
        if piece:
            yield piece


async def _backup(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    logs = request.query_params.get("logs") == "1"
    return _Zip(*await service.backups.begin(session, address_of(request), logs=logs))


async def _about(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    backups = service.backups
    waits = backups.waits(session)

    def looked() -> BackupShown:
        undo = tuple(_kept_restore(one) for one in backups.undoable())
        notes = _outside(service)
        try:
            selection = backups.selection()
        except Trouble as trouble:
            return BackupShown(
                robot=backups.robot.name, files=0, size=0, logs=0, logs_size=0,
                    trouble=f"{trouble.what}: {trouble.remedy}",
                left_out=(), notes=notes, undo=undo, waits=waits,
            )  # fmt: skip
        return BackupShown(
            robot=backups.robot.name,
            files=len(selection.files),
            size=selection.size,
            logs=len(selection.skipped),
            logs_size=sum(one.size for one in selection.skipped),
            trouble="",
            left_out=tuple(FileAndWhy(file=one.file, why=one.why) for one in selection.left_out[:100]),
            notes=notes,
            undo=undo,
            waits=waits,
        )

    return answer(await asyncio.to_thread(looked))


def _outside(service: Service) -> tuple[str, ...]:
    """Return the names of files that no backup contains, in words."""
    root, notes = service.files.folder.root, []
    if not service.robot.folder.resolve().is_relative_to(root):
        notes.append(
            f"The folder of the robot {service.robot.name} isn't in the project, and so not in the "
            f"backup: it is part of yarclang, or kept elsewhere"
        )
    logs = service.log_folders.folder
    if logs and service.log_folders.is_elsewhere:
        notes.append(
            "Motions are logged in a folder outside of the project: the backup doesn't include these logs"
        )
    notes.append("The backup doesn't include users, the audit trail, alarms and hidden files (such as .git)")
    return tuple(notes)


def _kept_restore(deleted: Deleted) -> KeptRestore:
    return KeptRestore(number=deleted.number, user=deleted.user, made=deleted.deleted, size=deleted.size)


async def _upload(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    told = request.headers.get("content-length", "")
    length = int(told) if told.isascii() and told.isdigit() and len(told) < 16 else None
    try:
        made = await service.backups.upload(session, address_of(request), length, request.stream())
    except ClientDisconnect:
        raise Trouble("the upload was interrupted", "try again", "") from None
    return answer(shown(service.backups, made))


async def _plan(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    found = await service.backups.waiting(session)
    if found is None:
        raise Trouble("you have no uploaded backup to restore", "upload one", "missing")
    return answer(shown(service.backups, found))


async def _forget(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    service.backups.session_ended(session.id)
    return answer(Done())


async def _apply(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    asked = await body(request, ApplyRestore)
    done, restart = await service.backups.apply(
        session, address_of(request), asked.number, asked.digest, remove=asked.remove
    )
    return answer(
        Restored(written=len(done.written), removed=len(done.removed), undo=done.undo, restart=restart)
    )


async def _undo(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE)
    asked = await body(request, UndoRestore)
    made = await service.backups.undo(session, address_of(request), asked.number)
    return answer(shown(service.backups, made))


def shown(backups: Backups, upload: Upload) -> RestorePlan:
    """Return the message for a waiting upload."""
    plan, manifest = upload.plan, upload.backup.manifest
    rows = [PlannedFile(file=one.file, what="conflict", size=0, why=one.why) for one in plan.conflicts]
    for what, names in (("changed", plan.changed), ("extra", plan.extra), ("new", plan.new)):
        for name in names[: _MOST_SHOWN - min(len(rows), _MOST_SHOWN)]:
            entry = upload.backup.files.get(name)
            size = plan.sizes[name] if entry is None else entry.size
            rows.append(PlannedFile(file=name, what=what, size=size))  # type: ignore[arg-type]  # one of the three
    return RestorePlan(
        number=upload.number,
        digest=plan.digest,
        size=upload.size,
        robot="" if manifest is None else manifest.head.robot,
        made="" if manifest is None else manifest.head.made,
        new=len(plan.new),
        changed=len(plan.changed),
        same=plan.same,
        extra=len(plan.extra),
        conflicts=len(plan.conflicts),
        files=tuple(rows[:_MOST_SHOWN]),
        notes=_notes(backups, upload),
        restart=backups.restarted((*plan.new, *plan.changed)),
        undoes=manifest is not None and manifest.head.part,
    )


def _notes(backups: Backups, upload: Upload) -> tuple[str, ...]:
    """Return the remarks about a backup, in sentences."""
    manifest, edited, notes = upload.backup.manifest, upload.backup.edited, []
    if manifest is None:
        return ("The backup has no file list: it wasn't made by System > Backup, or the list was removed",)
    if manifest.head.robot != backups.robot.name:
        notes.append(
            f"The backup is of the robot {manifest.head.robot}, and this pendant has {backups.robot.name}"
        )
    elif manifest.head.fingerprint != backups.robot.fingerprint:
        notes.append(f"{manifest.head.robot} has changed since the backup was made")
    if edited:
        more = f" and {len(edited) - 1} others" if len(edited) > 1 else ""
        notes.append(f"{edited[0]}{more} has changed since the backup was made: the zip was edited")
    if manifest.left_out:
        notes.append(
            f"{len(manifest.left_out)} files couldn't be backed up, such as {manifest.left_out[0].file}"
        )
    if changing := [one.file for one in manifest.files if one.changing]:
        notes.append(f"{changing[0]} was being changed during the backup")
    return tuple(notes)


ROUTES = (
    Route("GET", "/api/backup", _backup,
        "Return a zip of the project to be saved; `?logs=1`: with logs of runs.", None, None, "service"),
    Route("GET", "/api/backup/about", _about,
        "Return what a backup would have, and which restores can be undone.", None, BackupShown, "service"),
    Route("POST", "/api/backup/upload", _upload,
        "Take a zip as the body, judge it and return what restoring it would change; nothing is changed "
        "yet.", None, RestorePlan, "service", MOST_ZIP),
    Route("GET", "/api/backup/plan", _plan, "Return what the zip that waits would change now.", None,
        RestorePlan, "service"),
    Route("POST", "/api/backup/forget", _forget, "Forget the zip that waits.", None, Done, "service"),
    Route("POST", "/api/backup/restore", _apply,
        "Restore the zip that waits. What is replaced or deleted is kept.", ApplyRestore, Restored,
            "service, PIN"),
    Route("POST", "/api/backup/undo", _undo, "Take what a restore has replaced as the zip that waits.",
        UndoRestore, RestorePlan, "service"),
)  # fmt: skip
"""All routes of this file."""
