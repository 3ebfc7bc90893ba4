"""Parsing of texts as messages, and conversion of errors to messages."""

from __future__ import annotations

from typing import TypeVar

from pydantic import ValidationError

from yarclang.coordinator.messages.message import Message
from yarclang.runtime.actions import Trouble

M = TypeVar("M", bound=Message)


class Malformed(Trouble):
    """Raised if the body of a request doesn't have the documented form."""


def read(text: bytes | str, kind: type[M]) -> M:
    """Return the message that a text contains.

    Raises:
        Malformed: the text isn't a message of this kind.
    """
    try:
        return kind.model_validate_json(text or b"{}")
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(str(one) for one in first["loc"]) or "the body"
        raise Malformed(f"{place[:80]}: {first['msg'].lower()}", "see the API's page", "") from None
    except RecursionError:
        raise Malformed("the body can't be read", "see the API's page", "") from None
