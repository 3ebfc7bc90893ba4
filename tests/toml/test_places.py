"""Tests of the places of keys and values in a TOML text."""

from __future__ import annotations

import json
import tomllib

from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.source import SourceFile
from yarclang.toml.places import find_places


def test_places_of_keys_and_values() -> None:
    text = (
        "a.b = 1 # one\r\n"
        '"x y" = [ 1,\n  [2, "]"], # two\n  {p = 3, q.r = [4]},\n]\n'
        's = """\n[no]\\"""x\n""""\n'
        "t = '''#'''\n"
        "[c . 'd']\ne = true\n[[f]]\ng=1\n[[f]]\ng=2\n[f.h]\ni = 1979-05-27 07:32:00"
    )
    assert tomllib.loads(text)["f"][1]["h"]
    places = find_places(SourceFile("t", text))
    lines = {path: span.line for path, span in places.values.items()}
    assert lines[("a", "b")] == 1
    assert lines[("x y", 1, 1)] == 3
    assert lines[("x y", 2, "q", "r", 0)] == 4
    assert lines[("t",)] == 9
    assert lines[("c", "d", "e")] == 11
    assert lines[("f", 0, "g")] == 13
    assert lines[("f", 1, "g")] == 15
    assert lines[("f", 1, "h", "i")] == 17
    span = places.of_value(("x y", 2, "p"))
    assert text.replace("\r", "").split("\n")[span.line - 1][span.column - 1 : span.end_column - 1] == "3"
    assert places.of_value(("c", "d", "missing")).line == 10
    assert places.of_key(("nothing",)).line == 1


KEYS = st.text("ab.", min_size=1, max_size=3)
VALUES: st.SearchStrategy[object] = st.recursive(
    st.one_of(st.integers(-99, 99), st.booleans(), st.text("ab]}#'=, ", max_size=5)),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(KEYS, inner, max_size=3)),
    max_leaves=8,
)


def written(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f'"{key}" = {written(item)}' for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[ # ]\n" + ", ".join(written(item) for item in value) + "\n]"
    return str(value).lower() if isinstance(value, bool) else json.dumps(value)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(data=st.dictionaries(KEYS, VALUES, max_size=5))
def test_every_value_has_its_place(data: dict[str, object]) -> None:
    text = "\n".join(f'"{key}" = {written(value)}' for key, value in data.items())
    values = find_places(SourceFile("t", text)).values

    def check(path: tuple[str | int, ...], value: object) -> None:
        assert path in values
        items = (
            value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        )
        for key, item in items:
            check((*path, key), item)

    parsed = tomllib.loads(text)
    assert parsed == data
    for key, value in parsed.items():
        check((key,), value)
