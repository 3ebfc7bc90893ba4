"""Conversion between messages and lines of JSON. Reading raises no exception, whatever the line contains.
No I/O.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, TypeAlias, TypeVar

from pydantic import TypeAdapter, ValidationError

from yarclang.coordinator.messages import orders, wants
from yarclang.coordinator.messages.events import Event
from yarclang.coordinator.messages.message import VERSION, Message
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Denied, Reply
from yarclang.runtime.actions import Trouble

R = TypeVar("R", bound=Reply)

MOST_LINE: Final = 1 << 22
"""Longest line of an order, including its newline [bytes]."""

MOST_ANSWER: Final = 1 << 26
"""Longest line of a reply [bytes]."""

_SHOWN = 40
_HTTP = re.compile(rb"[A-Z]+ \S+ HTTP/")
"""Pattern that recognizes the first line of a browser's request (HTTP)."""

Id: TypeAlias = int | str | None
"""Identifier of an order, chosen by the sender. The reply has the same identifier."""

_ORDERS: dict[str, type[Order[Any]]] = {one.model_fields["order"].default: one for one in orders.KINDS}
_WANTS: dict[str, type[Order[Any]]] = {one.key: one for one in wants.KINDS}  # type: ignore[attr-defined]


@dataclass(frozen=True, slots=True)
class Asked:
    """The order on a line, with its `id`.

    `ends` is True if the line isn't a JSON object: then the connection must be closed. The caller uses
    another protocol, and one of its later lines might look like an order by chance.
    """

    what: Order[Any] | Denied
    id: Id = None
    ends: bool = False


def too_long(most: int) -> Denied:
    """Return the reply to a line that is too long. The caller's next lines can't be read any more."""
    size = f"{most >> 20} MiB" if most >= 1 << 20 else f"{most >> 10} KiB"
    return Denied(error=f"a line is longer than {size}")


def read_order(line: bytes, most: int = MOST_LINE) -> Asked:
    """Return the order on a line."""
    content = _object_in(line, most)
    if isinstance(content, Denied):
        return Asked(content, ends=True)
    id_ = content.pop("id", None)
    if isinstance(id_, bool) or not isinstance(id_, int | str | None):
        return Asked(Denied(error=f'"id" is {_value_text(id_)}; it must be an integer or a text'))
    return Asked(_order_in(content), id_)


def write_order(order: Order[Any], id_: Id = None) -> bytes:
    """Return the line of an order."""
    content = order.to_json()
    return _line(content if id_ is None else {"id": id_, **content})


def write_answer(answer: Reply | Denied, id_: Id = None) -> bytes:
    """Return the line of a reply."""
    content = answer.model_dump(mode="json", exclude_none=isinstance(answer, Denied))
    return _line(content if id_ is None else {"id": id_, **content})


def write_event(event: Message) -> bytes:
    """Return the line of an event."""
    return _line(event.to_json())


def read_answer(content: dict[str, Any], kind: type[R]) -> R | Denied:
    """Return the reply to an order, as a value of type `kind`. A malformed reply is returned as `Denied`."""
    rest = {key: value for key, value in content.items() if key != "id"}
    try:
        if rest.get("ok") is True:
            return kind.model_validate_json(json.dumps(rest))
        return Denied.model_validate_json(json.dumps(rest))
    except (ValidationError, ValueError, RecursionError):
        return Denied(error="the reply can't be read: is it another version of yarc?")


def read_event(content: dict[str, Any]) -> Event | None:
    """Return the event that an object describes; None if this kind of event isn't known."""
    try:
        event: Event = _events().validate_json(json.dumps(content))
    except (ValidationError, ValueError, RecursionError):
        return None
    return event


def read_object(line: bytes, most: int = MOST_ANSWER) -> dict[str, Any] | Denied:
    """Return the JSON object of a line."""
    return _object_in(line, most)


def name_of(order: Order[Any]) -> str:
    """Return the word that names an order in JSON, such as hold or resume. For a target of a live motion,
    return its key.
    """
    return getattr(order, "order", "") or getattr(order, "key", "")


@cache
def _events() -> TypeAdapter[Event]:
    return TypeAdapter(Event)


def _order_in(content: dict[str, Any]) -> Order[Any] | Denied:
    word = content.get("order")
    if "order" in content:
        kind = _ORDERS.get(word) if isinstance(word, str) else None
        if kind is None:
            return Denied(error=f'"order" is {_value_text(word)}; it may be {", ".join(_ORDERS)}')
        if kind is orders.Hello and (other := _other_version(content)) is not None:
            return other
        return _read(content, kind, str(word))
    keys = [key for key in _WANTS if key in content]
    if len(keys) == 1:
        return _read(content, _WANTS[keys[0]], keys[0])
    if keys:
        return Denied(error=f"one of {', '.join(_WANTS)} is allowed per line, not {len(keys)}")
    known = f"{', '.join(_ORDERS)}; or {', '.join(_WANTS)} for a live motion"
    return Denied(error=f'there is no "order"; it may be {known}')


def _other_version(content: dict[str, Any]) -> Denied | None:
    """Return a denial if a message has another version of the protocol. This is checked before everything
    else, since another version may cause all kinds of errors.
    """
    version = content.get("version", VERSION)
    if version == VERSION:
        return None
    return Denied(
        error=f"version {_value_text(version)} of the protocol isn't supported; this is version {VERSION}",
        help="use a client of the same version of yarclang",
    )


def _read(content: dict[str, Any], kind: type[Order[Any]], word: str) -> Order[Any] | Denied:
    try:
        return kind.model_validate_json(json.dumps(content))
    except ValidationError as error:
        return Denied(error=_mistake(word, kind, error))
    except (ValueError, RecursionError):
        return Denied(error=f"{word} can't be read")


def _mistake(word: str, kind: type[Order[Any]], error: ValidationError) -> str:
    """Return the first error of a message, in words."""
    first = error.errors(include_url=False, include_context=False, include_input=False)[0]
    path = [str(one) for one in first["loc"] if isinstance(one, int | str)]
    if not path:
        return f"{word} can't be read"
    key = path[0]
    if first["type"] == "extra_forbidden":
        return f"{word} has no field {_value_text(key)}"
    field = kind.model_fields.get(key)
    what = field.description if field is not None and field.description else "another value"
    return f'{word} needs "{key}", {what}' if key != word else f"{word} is {what}"


def _object_in(line: bytes, most: int) -> dict[str, Any] | Denied:
    if len(line) > most:
        return too_long(most)
    if _HTTP.match(line):
        return Denied(error="this isn't a web server: a web page can't steer a robot")
    try:
        content = json.loads(line)
    except (ValueError, RecursionError):
        return Denied(error=f"{_value_text(line[:200].decode(errors='replace').strip())} isn't JSON")
    if not isinstance(content, dict):
        return Denied(error=f"{_value_text(content)} isn't a JSON object")
    return content


def _line(content: dict[str, Any]) -> bytes:
    return json.dumps(content).encode() + b"\n"


def _value_text(value: object) -> str:
    """Return a value as text for messages, shortened if it is long."""
    match value:
        case str():
            return json.dumps(value if len(value) <= _SHOWN else value[:_SHOWN] + "...")
        case list():
            return "a list"
        case dict():
            return "an object"
        case _:
            return json.dumps(value)[:_SHOWN]


def denied(trouble: Trouble) -> Denied:
    """Return a `Trouble` as a reply."""
    return Denied(error=trouble.what, help=trouble.remedy or None, code=trouble.code or None)
