"""Read YAML and JSON texts as plain data: mappings, lists, texts and numbers.

YAML is read event by event, without recursion. Aliases and tags are refused. A file therefore can't run code,
and a small file can't expand to large data.
"""

from __future__ import annotations

import json
from typing import Any

from yarclang.diagnostics import Collector
from yarclang.source import SourceFile

_DEEPEST = 60


def read_json(source: SourceFile, findings: Collector) -> list[Any] | None:
    """Return the values of a JSON text; None, with a finding, if the text isn't JSON. Several values may
    follow each other directly, or be separated by `---`.
    """
    decoder = json.JSONDecoder()
    text, at = source.text, 0
    documents: list[Any] = []
    try:
        while at < len(text):
            if text[at].isspace():
                at += 1
            elif text.startswith("---", at):
                at += 3
            else:
                value, at = decoder.raw_decode(text, at)
                documents.append(value)
    except json.JSONDecodeError as error:
        message = f"this is not JSON: {error.msg}, at column {error.colno}"
        span = source.whole_line(error.lineno)
        findings.add("Y1507", message, span, "correct the text here, or check if the file was cut off")
        return None
    except RecursionError:
        findings.add("Y1508", "brackets are nested too deep", None, "check which file was given")
        return None
    except ValueError:  # an integer with thousands of digits
        findings.add("Y1507", "a number has too many digits", None, "check which file was given")
        return None
    return documents


def read_yaml(source: SourceFile, findings: Collector) -> list[Any] | None:
    """Return the documents of a YAML stream; None, with a finding, if it can't be read.

    Scalars become texts, except that empty scalars and nulls become None.
    """
    import yaml

    documents: list[Any] = []
    stack: list[Any] = []
    keys: list[Any] = []
    empty = object()

    def put(value: Any) -> None:
        """Add a value to the innermost open mapping or list."""
        if not stack:
            documents.append(value)
        elif isinstance(stack[-1], list):
            stack[-1].append(value)
        elif keys[-1] is empty:
            keys[-1] = value if isinstance(value, str) else repr(value)
        else:
            stack[-1][keys[-1]] = value
            keys[-1] = empty

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        for event in yaml.parse(source.text, Loader=loader):
            refusal = ""
            if isinstance(event, yaml.AliasEvent):
                refusal = f"*{event.anchor} is an alias of another part of the file"
            elif getattr(event, "tag", None) is not None and not event.tag.startswith(
                "tag:yaml.org,2002:str"
            ):
                refusal = f"the tag {event.tag} asks for more than plain data"
            elif len(stack) > _DEEPEST:
                refusal = f"it is nested more than {_DEEPEST} deep"
            if refusal:
                span = source.whole_line(event.start_mark.line + 1)
                findings.add("Y1508", refusal, span, "write plain mappings, lists, numbers and texts")
                return None
            match event:
                case yaml.ScalarEvent():
                    plain = event.style is None
                    put(None if plain and event.value in {"", "~", "null", "Null", "NULL"} else event.value)
                case yaml.MappingStartEvent():
                    stack.append({})
                    keys.append(empty)
                case yaml.SequenceStartEvent():
                    stack.append([])
                    keys.append(empty)
                case yaml.MappingEndEvent() | yaml.SequenceEndEvent():
                    keys.pop()
                    put(stack.pop())
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = min(mark.line + 1, max(len(source.lines), 1)) if mark else 1
        problem = getattr(error, "problem", None) or str(error)
        message = f"this is not YAML: {problem}"
        findings.add(
            "Y1507",
            message,
            source.whole_line(line),
            "correct the text here, or check if the file was cut off",
        )
        return None
    return documents
