"""HTTP routes for the files of the project: their list, reading and saving texts, uploads and downloads,
and the changes since the last git commit.
"""

from __future__ import annotations

import asyncio
import os
import re
from collections.abc import AsyncIterator
from contextlib import ExitStack
from pathlib import PurePosixPath
from typing import Literal
from urllib.parse import quote

from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response, StreamingResponse

from yarclang.backend import suffixes
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.filing import MOST_UPLOADED
from yarclang.pendant.messages.files import (
    DeletedList,
    DeletedShown,
    Difference,
    FileList,
    FileShown,
    FileText,
    FileWritten,
    GitState,
    OnePath,
    OtherContent,
    Restore,
    SaveFile,
    TwoPaths,
)
from yarclang.pendant.messages.reading import Malformed, read
from yarclang.pendant.project.folder import MOST_TEXT, Changed, Written
from yarclang.pendant.project.git import text_of
from yarclang.pendant.project.trash import Deleted
from yarclang.pendant.project.tree import Entry
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service, address_of
from yarclang.runtime.actions import Trouble

_MOST_LISTED = 10_000
_MOST_SAVED = 6 * MOST_TEXT + 1000
"""Longest body of a request that saves a text [bytes]. JSON may need six bytes for one byte of the text."""
_PIECE = 1 << 18

_Kind = Literal["folder", "program", "text", "picture", "other"]
_KINDS: dict[str, _Kind] = {
    ".yarc": "program",
    **dict.fromkeys((".png", ".jpg", ".jpeg", ".gif", ".webp", ".bmp", ".tif", ".tiff"), "picture"),
    **dict.fromkeys(
        (".toml", ".txt", ".md", ".csv", ".urdf", ".srdf", ".xml", ".json", ".yaml", ".yml", ".ini", ".py",
            ".svg"),
        "text",
    ),
}  # fmt: skip


async def _list(service: Service, request: Request) -> Response:
    service.session(request)

    def listed() -> Response:
        found, cut = service.files.folder.entries(_MOST_LISTED)
        files = tuple(_file_shown(one) for one in found)
        return answer(FileList(folder=str(service.files.folder.root), files=files, cut=cut))

    return await asyncio.to_thread(listed)


def _file_shown(entry: Entry) -> FileShown:
    suffix = PurePosixPath(entry.file).suffix.lower()
    kind: _Kind = "program" if suffix in suffixes() else _KINDS.get(suffix, "other")
    return FileShown(
        file=entry.file,
        size=entry.size,
        changed=entry.changed,
        kind="folder" if entry.is_folder else kind,
    )


async def _text(service: Service, request: Request) -> Response:
    service.session(request)

    def opened() -> Response:
        file = request.path_params["path"]
        content, told = service.files.folder.read(file)
        text = text_of(file, content)
        return answer(FileText(file=file, text=text, sha256=told.sha256, changed=told.changed))

    return await asyncio.to_thread(opened)


async def _download(service: Service, request: Request) -> Response:
    service.session(request)
    opening = ExitStack()
    file = request.path_params["path"]
    handle, status, name = await asyncio.to_thread(opening.enter_context, service.files.folder.opened(file))
    headers = {
        "content-disposition": disposition(name),
        "content-length": str(status.st_size),
        "cache-control": "no-store",
    }
    content = pieces(opening, handle, status.st_size)
    return StreamingResponse(content, headers=headers, media_type="application/octet-stream")


async def pieces(opening: ExitStack, handle: int, size: int) -> AsyncIterator[bytes]:
    """Yield the first `size` bytes of a file, then close it. If the file has become shorter, the connection
    ends, so that the browser reports an error.

    Args:
        opening: context that closes the file.
        handle: descriptor of the open file.
        size: number of bytes to send.
    """
    with opening:
        left = size
        while left > 0 and (data := await asyncio.to_thread(os.read, handle, min(_PIECE, left))):
            left -= len(data)
            yield data


def disposition(name: str) -> str:
    """Return the Content-Disposition header that makes a browser save a file under its name, which may
    contain any Unicode characters.
    """
    plain = re.sub(r"[^A-Za-z0-9._ ()-]", "_", name)
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"


async def _save(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    raw = await request.body()
    asked = await asyncio.to_thread(read, raw, SaveFile)
    file = request.path_params["path"]
    try:
        made = await service.files.save(session, address_of(request), file, asked.text, asked.known)
    except Changed as changed:
        return other(changed)
    return answer(_written(made))


async def _upload(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    known_hash = request.query_params.get("known")
    if known_hash is not None and not re.fullmatch("[0-9a-f]{64}", known_hash):
        raise Malformed("known isn't a SHA-256 in hexadecimal digits", "see the API's page", "")
    told = request.headers.get("content-length", "")
    length = int(told) if told.isascii() and told.isdigit() and len(told) < 16 else None
    file = request.path_params["path"]
    stream = request.stream()
    try:
        written = await service.files.upload(session, address_of(request), file, known_hash, length, stream)
    except Changed as changed:
        return other(changed)
    except ClientDisconnect:
        raise Trouble("the upload was interrupted", "try again", "") from None
    return answer(_written(written))


def other(changed: Changed) -> Response:
    """Return the HTTP response for a file that isn't the version that the client has read before."""
    return answer(
        OtherContent(error=changed.what, help=changed.remedy, code=changed.code, sha256=changed.sha256), 409
    )


def _written(written: Written) -> FileWritten:
    return FileWritten(file=written.file, size=written.size, sha256=written.sha256, changed=written.changed)


async def _copy(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, TwoPaths)
    return answer(_written(await service.files.copy(session, address_of(request), asked.file, asked.to)))


async def _rename(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, TwoPaths)
    await service.files.rename(session, address_of(request), asked.file, asked.to)
    return answer(OnePath(file=asked.to))


async def _folder(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, OnePath)
    await service.files.make_folder(session, address_of(request), asked.file)
    return answer(asked)


async def _delete(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, OnePath)
    return answer(_deleted(await service.files.delete(session, address_of(request), asked.file)))


async def _restore(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, Restore)
    return answer(OnePath(file=await service.files.restore(session, address_of(request), asked.number)))


async def _trash(service: Service, request: Request) -> Response:
    service.session(request)
    kept = await asyncio.to_thread(service.files.folder.trash.kept)
    return answer(DeletedList(deleted=tuple(_deleted(one) for one in kept)))


def _deleted(deleted: Deleted) -> DeletedShown:
    return DeletedShown(
        number=deleted.number,
        file=deleted.file,
        size=deleted.size,
        deleted=deleted.deleted,
        user=deleted.user,
        folder=deleted.is_folder,
    )


async def _git(service: Service, request: Request) -> Response:
    service.session(request)
    return answer(await service.files.changed())


async def _difference(service: Service, request: Request) -> Response:
    service.session(request)
    file = request.path_params["path"]
    base, text = await service.files.difference(file)
    return answer(Difference(file=file, base=base, text=text))


ROUTES = (
    Route("GET", "/api/files", _list, "Return the files and folders of the project.", None, FileList,
        "viewer"),
    Route("GET", "/api/files/{path:path}", _text, "Return a text of the project, up to 1 MiB in UTF-8.", None,
        FileText, "viewer"),
    Route("PUT", "/api/files/{path:path}", _save,
        "Save a text: 409 with the code `changed` and the present hash if it isn't as it was opened.",
            SaveFile, FileWritten, "programmer", _MOST_SAVED),
    Route("POST", "/api/files/copy", _copy, "Copy a file to a path that is free.", TwoPaths, FileWritten,
        "programmer"),
    Route("POST", "/api/files/rename", _rename, "Give a file or folder another path, which must be free.",
        TwoPaths, OnePath, "programmer"),
    Route("POST", "/api/files/folder", _folder, "Make a folder.", OnePath, OnePath, "programmer"),
    Route("POST", "/api/files/delete", _delete, "Delete a file or folder; it can be brought back.", OnePath,
        DeletedShown, "programmer"),
    Route("POST", "/api/files/restore", _restore, "Restore a deleted file; return its present path.", Restore,
        OnePath, "programmer"),
    Route("GET", "/api/trash", _trash, "Return what was deleted and can be brought back.", None, DeletedList,
        "viewer"),
    Route("POST", "/api/upload/{path:path}", _upload,
        "Write the body, up to 100 MB of any kind, to a new file; `?known=` SHA-256 of the one that it "
        "replaces.", None, FileWritten, "programmer", MOST_UPLOADED),
    Route("GET", "/api/download/{path:path}", _download, "Return a file to be saved, never shown.", None,
        None, "viewer"),
    Route("GET", "/api/git", _git,
        "Return what has changed since the last commit, and who did so at the pendant.", None, GitState,
            "viewer"),
    Route("GET", "/api/git/difference/{path:path}", _difference,
        "Return a text as of the last commit and as it is now.", None, Difference, "viewer"),
)  # fmt: skip
"""All routes of this file."""
