"""Tests of docs/coordinator.md: it lists all messages as their types define them, and its example runs."""

import json
import re
import types
import typing
from pathlib import Path

import pytest

from yarclang.coordinator.messages import courses, events, orders, replies, wants
from yarclang.coordinator.messages.lines import read_order
from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Denied

PAGE = Path(__file__).resolve().parents[2] / "docs" / "coordinator.md"
EVENTS = typing.get_args(typing.get_args(events.Event)[0])
NAMES = {str: "text", float: "number", int: "integer", bool: "true or false", type(None): "null"}


def type_text(annotation):
    """Return a type in words."""
    if annotation in NAMES:
        return NAMES[annotation]
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return type_text(arguments[0])
    if origin in (typing.Union, types.UnionType):
        return " or ".join(map(type_text, arguments))
    if origin is typing.Literal:
        return " or ".join(json.dumps(one) for one in arguments)
    if origin is tuple:
        return f"list of {type_text(arguments[0])}"
    if origin is dict:
        return f"object of {type_text(arguments[1])} by name"
    if isinstance(annotation, type) and issubclass(annotation, Message):
        return annotation.__name__
    return annotation.__name__


def fields_of(kind, without):
    """Return a line for each field of an order: name, type and default."""
    found = []
    for name, field in kind.model_fields.items():
        if name in without:
            continue
        text = (
            f"`{name}`: "
            f"{field.description if issubclass(kind, orders.Order) else type_text(field.annotation)}"
        )
        if not field.is_required() and issubclass(kind, orders.Order):
            text += f" ({json.dumps(field.default)})"
        found.append(text)
    return "; ".join(found)


def said(kind):
    return " ".join(kind.__doc__.split())


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def tables():
    own = [
        one
        for module in (replies, courses)
        for one in vars(module).values()
        if isinstance(one, type) and issubclass(one, Message) and one.__module__ == module.__name__
        if one is not replies.Reply
    ]
    return {
        "events": table(
            ("event", "what", "fields"),
            [
                (f"`{kind.model_fields['event'].default}`", said(kind), fields_of(kind, ("event", "time_s")))
                for kind in EVENTS
            ],
        ),
        "orders": table(
            ("order", "what", "fields (default)", "answer"),
            [
                (
                    f"`{kind.model_fields['order'].default}`",
                    said(kind),
                    fields_of(kind, ("order",)),
                    kind.answer.__name__,
                )
                for kind in orders.KINDS
            ],
        ),
        "wants": table(
            ("key", "what", "fields (default)", "answer"),
            [
                (f"`{kind.key}`", said(kind), fields_of(kind, ()), kind.answer.__name__)
                for kind in wants.KINDS
            ],
        ),
        "answers": table(
            ("answer", "what", "fields"),
            [(kind.__name__, said(kind), fields_of(kind, ("ok",))) for kind in own],
        ),
    }


@pytest.mark.parametrize("name", ["events", "orders", "wants", "answers"])
def test_the_tables_are_those_of_the_types(name, rewrite_golden):
    text = PAGE.read_text(encoding="utf-8")
    place = re.compile(rf"(?<=<!-- {name} -->\n).*?(?=<!-- /{name} -->)", re.DOTALL)
    wanted = tables()[name] + "\n"
    (shown,) = place.findall(text)
    if rewrite_golden:
        PAGE.write_text(place.sub(lambda _: wanted, text), encoding="utf-8")
        shown = wanted
    assert shown == wanted


def test_the_lines_that_are_shown_are_orders():
    text = PAGE.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if re.match(r'\{("id": \d+, )?"order"', line)]
    assert len(lines) >= 4
    assert not [line for line in lines if isinstance(read_order(line.encode()).what, Denied)]


def test_the_examples_can_be_compiled():
    text = PAGE.read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) >= 3
    for block in blocks:
        if "await" not in block or "async def" in block:
            compile(block, str(PAGE), "exec")
