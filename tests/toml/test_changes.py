"""Tests of changes of TOML texts: they change the given values, and leave all other text the same to the
byte.
"""

import copy
import difflib
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.source import SourceFile
from yarclang.toml.changes import ChangeError, printed, with_table, with_value, without

EXAMPLES = [path.read_text() for path in sorted(Path("examples").glob("*.toml"))]
ROBOTS = [path.read_text() for path in sorted(Path("stdlib/robots").glob("*/robot.toml"))]
LETTERS = st.characters(blacklist_categories=["Cs"])
VALUES = st.recursive(
    st.booleans()
    | st.integers(-(2**60), 2**60)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(LETTERS),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(LETTERS, max_size=8), inner, max_size=3)
    ),
    max_leaves=6,
)


def source(text):
    return SourceFile("cell.toml", text)


def kept(old, new):
    """Return the number of lines that both texts have, in the same order."""
    matcher = difflib.SequenceMatcher(None, old.split("\n"), new.split("\n"), autojunk=False)
    return sum(size for _, _, size in matcher.get_matching_blocks())


def comments(text):
    """Return the lines that are comments."""
    return [line for line in text.split("\n") if line.startswith("#")]


@given(VALUES)
def test_values_are_read_back(value):
    assert tomllib.loads(f"a = {printed(value)}")["a"] == value


@st.composite
def paths(draw, data, way=()):
    """Draw the path of a value in a document."""
    keys = list(data) if isinstance(data, dict) else list(range(len(data)))
    key = draw(st.sampled_from(keys))
    inner = data[key]
    if isinstance(inner, dict | list) and inner and draw(st.booleans()):
        return draw(paths(inner, (*way, key)))
    return (*way, key)


@given(st.data(), st.sampled_from(EXAMPLES + ROBOTS), st.sampled_from(["\n", "\r\n"]))
def test_one_thing_changes_and_all_else_stays(data, text, ending):
    text = text.replace("\n", ending)
    before = tomllib.loads(text)
    path = data.draw(paths(before))
    holder = before
    for key in path[:-1]:
        holder = holder[key]
    wanted = copy.deepcopy(before)
    place = wanted
    for key in path[:-1]:
        place = place[key]
    kind = data.draw(st.sampled_from(["value", "key", "gone"]))
    try:
        match kind:
            case "value":
                place[path[-1]] = value = data.draw(VALUES)
                new = with_value(source(text), path, value)
            case "key":
                place = wanted
                place["made"] = {"KEY": (value := data.draw(VALUES))}
                new = with_value(source(text), ("made", "KEY"), value)
            case _:
                del place[path[-1]]
                new = without(source(text), path)
                if not place and isinstance(path[-1], int):
                    return
    except ChangeError:
        return
    assert tomllib.loads(new) == wanted
    if kind != "gone":
        assert comments(new)[: len(comments(text))] == comments(text)


@pytest.mark.parametrize("text", EXAMPLES)
def test_what_people_change(text):
    """After an obstacle is added and removed again, the text is what it was before."""
    data = tomllib.loads(text)
    new = {"name": "NEW", "shape": "box", "frame": "B", "xyz": [1.5, 0, 0], "size": [1, 2, 3]}
    count = len(data.get("obstacles", []))
    added = with_table(source(text), ("obstacles", count), new)
    assert added.startswith(text)
    assert tomllib.loads(added)["obstacles"] == [*data.get("obstacles", []), new]
    assert without(source(added), ("obstacles", count)).rstrip("\n") == text.rstrip("\n")
    for number, one in enumerate(data.get("obstacles", [])):
        for key in ("xyz", "rpy", "margin"):
            value = [1, 2.25, 3] if key != "margin" else 12.5
            moved = with_value(source(text), ("obstacles", number, key), value)
            assert tomllib.loads(moved)["obstacles"][number][key] == value
            assert abs(len(moved.split("\n")) - len(text.split("\n"))) == (key not in one)
            assert kept(text, moved) >= len(text.split("\n")) - 1
        gone = without(source(text), ("obstacles", number))
        assert one["name"] not in [other["name"] for other in tomllib.loads(gone).get("obstacles", [])]


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ("a = { b = 1, c = 2 }\n", ("a", "b")),
        ("[a.b.c]\nx = 1\n", ("a", "b", "y")),
        ("a.b = 1\n", ("a", "c")),
    ],
)
def test_odd_forms_are_changed_rightly_or_refused(text, path):
    try:
        new = with_value(source(text), path, 7)
    except ChangeError:
        return
    found = tomllib.loads(new)
    for key in path:
        found = found[key]
    assert found == 7


def test_what_isnt_there_cant_go():
    with pytest.raises(ChangeError, match=r"obstacles\.3"):
        without(source(EXAMPLES[0]), ("obstacles", 3))
