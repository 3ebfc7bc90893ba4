"""Filter for the messages between a page and its analyst, a language server (LSP). No I/O.

A page knows the files of the project as `yarc:///folder/name.yarc`. No message of a page is passed on
unchanged. Each is parsed as one of the allowed types of messages, and written anew with the real URI of a
file that the page has open.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar
from urllib.parse import unquote, urlsplit

from pydantic import BaseModel, ConfigDict, Field

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.messages.reading import Malformed, read

SCHEME = "yarc"
MOST_OPEN = 8
"""Largest number of files that a page may have open."""

MOST_ASKED = 64
"""Largest number of requests of a page that may be waiting for a reply."""

_LARGEST = 1 << 30
_SUFFIX = ".yarc"
_NOT_FOUND = -32601

Text = Annotated[str, Field(max_length=1 << 20)]
Uri = Annotated[str, Field(max_length=4000)]
Count = Annotated[int, Field(ge=0, le=_LARGEST)]
Id = Annotated[int, Field(ge=0, le=_LARGEST)]


class Named(Message):
    """Parameter that names a file (LSP TextDocumentIdentifier)."""

    uri: Uri


class Versioned(Named):
    """Parameter that names a file and its version."""

    version: Count


class Opened(Versioned):
    """Parameter that contains a file with its text."""

    text: Text


class Position(Message):
    """A place in a text: line, and column in UTF-16 code units, both from 0."""

    line: Count
    character: Count


class Range(Message):
    """A range of a text."""

    start: Position
    end: Position


class Change(Message):
    """Replacement of a range of a text."""

    range: Range
    text: Text


class Open(Message):
    """Parameters of a notification that a file was opened."""

    textDocument: Opened  # noqa: N815 - the protocol's


class Edited(Message):
    """Parameters of a notification that a text has changed. Each change refers to the text after the
    previous one.
    """

    textDocument: Versioned  # noqa: N815 - the protocol's
    contentChanges: Annotated[tuple[Change, ...], Field(max_length=20_000)]  # noqa: N815 - the protocol's


class Whole(Message):
    """Parameters of a request about a whole text."""

    textDocument: Named  # noqa: N815 - the protocol's


class Place(Whole):
    """Parameters of a request about a place in a text."""

    position: Position


class Stretch(Whole):
    """Parameters of a request about a range of a text."""

    range: Range


class Cancelled(Message):
    """Parameters of a notification that a request is cancelled."""

    id: Id


class Nothing(Message):
    """No parameters."""


P = TypeVar("P", bound=Message)


class _Said(Message, Generic[P]):
    jsonrpc: Literal["2.0"] = "2.0"
    method: str
    params: P


class _Asked(_Said[P]):
    id: Id


class _Method(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True)

    method: Annotated[str, Field(max_length=100)]


REQUESTS: Mapping[str, type[Message]] = {
    "initialize": Nothing,
    "textDocument/completion": Place,
    "textDocument/hover": Place,
    "textDocument/signatureHelp": Place,
    "textDocument/codeAction": Stretch,
    "textDocument/formatting": Whole,
    "textDocument/semanticTokens/full": Whole,
    "textDocument/semanticTokens/range": Stretch,
}
"""Requests that pages may send, with the types of their parameters."""

NOTIFICATIONS: Mapping[str, type[Message]] = {
    "initialized": Nothing,
    "textDocument/didOpen": Open,
    "textDocument/didChange": Edited,
    "textDocument/didClose": Whole,
    "$/cancelRequest": Cancelled,
}
"""Notifications that pages may send, with the types of their parameters."""

_TYPES: dict[str, type[_Said[Any]]] = {
    **{name: _Asked[kind] for name, kind in REQUESTS.items()},  # type: ignore[valid-type]
    **{name: _Said[kind] for name, kind in NOTIFICATIONS.items()},  # type: ignore[valid-type]
}

_PLAIN = {"documentationFormat": ["plaintext"]}
_CAPABILITIES = {
    "general": {"positionEncodings": ["utf-16"]},
    "textDocument": {
        "publishDiagnostics": {"versionSupport": True},
        "hover": {"contentFormat": ["plaintext"]},
        "completion": {"completionItem": {"snippetSupport": False, **_PLAIN}},
        "signatureHelp": {"signatureInformation": _PLAIN},
        "codeAction": {"codeActionLiteralSupport": {"codeActionKind": {"valueSet": ["quickfix"]}}},
    },
}


class Passing:
    """Filter for the messages between a page and its analyst.

    Args:
        folder: folder of the project.
        inside: returns the absolute path of a file of the project, or raises `Trouble` if the project has no
            such file.
    """

    def __init__(self, folder: Path, inside: Callable[[str], Path]) -> None:
        self._folder = folder
        self._inside = inside
        self._files: dict[str, str] = {}
        self._asked: dict[int, str] = {}

    def again(self) -> None:
        """Forget all state. Called when the analyst has been restarted."""
        self._files.clear()
        self._asked.clear()

    # messages from the page

    def to_analyst(self, text: str) -> dict[str, Any]:
        """Convert a message from the page to a message for the analyst. Reads the project's folder if the
        message opens a file.

        Raises:
            Malformed: pages may not send this message, it names a file that isn't open, or too many requests
                wait.
            Trouble: the message opens a file that isn't in the project.
        """
        name = read(text, _Method).method if text else ""  # type: ignore[type-var]  # reads any model
        if name not in _TYPES:
            raise Malformed(f"{name[:40]!r} isn't accepted from pages", "see the API's page", "")
        message = read(text, _TYPES[name])
        message_made: dict[str, Any] = {
            "jsonrpc": "2.0",
            "method": name,
            "params": self._params(name, message.params),
        }
        if isinstance(message, _Asked):
            if len(self._asked) >= MOST_ASKED or message.id in self._asked:
                raise Malformed("too many requests are pending", "wait, or cancel some", "")
            self._asked[message.id] = name
            message_made["id"] = message.id
        return message_made

    def _params(self, name: str, params: Message) -> dict[str, Any]:
        if name == "initialize":
            return {
                "processId": None,
                "rootUri": self._folder.as_uri(),
                "capabilities": _CAPABILITIES,
                "initializationOptions": {"showDocuments": False},
            }
        content = params.model_dump(mode="json")
        if isinstance(params, Open):
            content["textDocument"] |= {"uri": self._open(params.textDocument.uri), "languageId": "yarc"}
        elif isinstance(params, Edited | Whole):
            content["textDocument"]["uri"] = self._name_of(params.textDocument.uri)
        if name == "textDocument/didClose":
            self._files.pop(content["textDocument"]["uri"], None)
        elif name == "textDocument/codeAction":
            content["context"] = {"diagnostics": [], "only": ["quickfix"]}
        elif name == "textDocument/formatting":
            content["options"] = {"tabSize": 2, "insertSpaces": True}
        return content

    def _open(self, uri: str) -> str:
        try:
            parts = urlsplit(uri)
            path = unquote(parts.path, errors="strict")
        except ValueError:
            raise Malformed("the URI can't be read", "name a file as yarc:///NAME.yarc", "") from None
        if parts.scheme != SCHEME or parts.netloc or parts.query or parts.fragment or path[:1] != "/":
            raise Malformed(
                f"{uri[:80]!r} isn't a file of the project", "name a file as yarc:///NAME.yarc", ""
            )
        if not path.lower().endswith(_SUFFIX):
            raise Malformed(f"{path[1:81]!r} is no program", f"open a file with the extension {_SUFFIX}", "")
        if len(self._files) >= MOST_OPEN:
            raise Malformed(f"{MOST_OPEN} files are open", "close one", "")
        place = self._inside(path[1:]).as_uri()
        if place in self._files:
            raise Malformed(f"{path[1:81]!r} is open", "close it first", "")
        self._files[place] = uri
        return place

    def _name_of(self, uri: str) -> str:
        for place, name in self._files.items():
            if name == uri:
                return place
        raise Malformed(f"{uri[:80]!r} isn't open", "open it first", "")

    # messages from the analyst

    def to_page(self, message: dict[str, Any]) -> dict[str, Any] | None:
        """Convert a message from the analyst to a message for the page. Return None if the message isn't
        meant for pages.
        """
        if "method" in message:
            if message["method"] == "textDocument/publishDiagnostics" and "id" not in message:
                return self._findings(message["params"])
            return None
        name = self._asked.pop(message.get("id", -1), None)
        if name is None:
            return None
        message_made: dict[str, Any] = {"jsonrpc": "2.0", "id": message["id"]}
        if "error" in message:
            return message_made | {
                "error": {"message": self._short(str(message["error"].get("message", "")))}
            }
        result = message.get("result")
        if name == "initialize":
            result = {}
        elif name == "textDocument/codeAction":
            result = [one for each in result or () if (one := self._action(each)) is not None]
        elif name == "textDocument/hover" and result:
            result["contents"]["value"] = self._short(result["contents"]["value"])
        return message_made | {"result": result}

    def reply(self, message: dict[str, Any]) -> dict[str, Any] | None:
        """Return the reply to a request of the analyst; None if the message isn't a request. The reply is
        always an error, because pages can't serve requests.
        """
        if "method" not in message or "id" not in message:
            return None
        return {"jsonrpc": "2.0", "id": message["id"], "error": {"code": _NOT_FOUND, "message": "not here"}}

    def _findings(self, params: dict[str, Any]) -> dict[str, Any] | None:
        uri = self._files.get(params["uri"])
        if uri is None:
            return None
        shown_findings = [
            {key: one.get(key) for key in ("range", "severity", "code", "tags")}
            | {"message": self._short(one["message"])}
            for one in params["diagnostics"]
        ]
        told = {"uri": uri, "version": params.get("version"), "diagnostics": shown_findings}
        return {"jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": told}

    def _action(self, action: dict[str, Any]) -> dict[str, Any] | None:
        """Return a code action restricted to edits of texts that the page has open."""
        edit = action.get("edit") or {}
        changes = edit.get("changes")
        if "command" in action or edit.keys() != {"changes"} or not changes:
            return None
        if not all(place in self._files for place in changes):
            return None
        return {
            "title": action["title"],
            "kind": action.get("kind"),
            "isPreferred": bool(action.get("isPreferred")),
            "about": [
                {"code": one.get("code"), "range": one["range"]} for one in action.get("diagnostics") or ()
            ],
            "edit": {"changes": {self._files[place]: edits for place, edits in changes.items()}},
        }

    def _short(self, text: str) -> str:
        """Return a text with absolute paths of the project's files replaced by paths relative to
        the project.
        """
        return text.replace(f"{self._folder}/", "")


def written(message: Mapping[str, Any]) -> bytes:
    """Return a message in the wire format of an analyst."""
    body = json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n%s" % (len(body), body)
