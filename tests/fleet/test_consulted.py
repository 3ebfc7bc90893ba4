"""Tests of recording the inputs of a check: the record is complete, and suffices to repeat the check
elsewhere.
"""

import os
import shutil
import sys
from pathlib import Path

import pytest

import yarclang
from yarclang.consulted import (
    CHANGED,
    CONTENT,
    Bundle,
    NotBundledError,
    Question,
    answer_now,
    bundled,
    content_now,
    recorded,
)
from yarclang.files import cache_folder, read_whole
from yarclang.pipeline.checking import check_file
from yarclang.pipeline.inputs import Options
from yarclang.signing import secret_file

EXAMPLES = sorted(Path("examples").glob("*.yarc"))
OURS = [
    Path(yarclang.__file__).parent,
    Path("stdlib").resolve(),
    Path(sys.prefix),
    Path(sys.base_prefix),
    Path("/usr"),
    Path("/proc"),
    Path("/sys"),
    Path("/etc"),
]


def options_of(example):
    return Options(robot=None if "\nROBOT" in f"\n{example.read_text()}" else "INDUSTRIAL6")


OPENED: list[str] = []


def _hear(event, arguments):
    if event == "open" and isinstance(arguments[0], str):
        OPENED.append(arguments[0])


@pytest.fixture(scope="module")
def hook():
    sys.addaudithook(_hear)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_each_file_that_a_check_opens_is_recorded(example, hook):
    OPENED.clear()
    with recorded() as answers:
        check_file(str(example), options_of(example))
    known = {str(Path(question.path).resolve()) for question in answers if question.kind == CONTENT}
    opened = {Path(one).resolve() for one in OPENED}
    strange = [
        one for one in opened if str(one) not in known and not any(one.is_relative_to(here) for here in OURS)
    ]
    # the cache needs no record of its own: its entries are found by recorded content, and are signed
    kept = cache_folder()
    ours = (secret_file().parent, *([kept.resolve()] if kept is not None else []))
    strange = [one for one in strange if not any(one.is_relative_to(here) for here in ours)]
    assert [one for one in strange if one.suffix != ".pyc"] == []
    assert str(example.resolve()) in known


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_a_bundle_of_what_was_recorded_is_enough_in_another_folder(example, tmp_path, monkeypatch):
    there = check_file(str(example), options_of(example))
    options = options_of(example)
    with recorded() as answers:
        check_file(str(example), options)
    contents = {}
    for question in answers:
        if question.kind == CONTENT:
            answer, content = content_now(Path(question.path))
            contents[answer] = content
    monkeypatch.chdir(tmp_path)
    with bundled(Bundle(answers, contents)):
        here = check_file(str(example), options)
    assert here.diagnostics == there.diagnostics
    assert (here.compiled is None) == (there.compiled is None)
    if here.compiled is not None:
        assert here.compiled.text == there.compiled.text


def test_meshes_and_robots_of_ones_own_come_with_a_bundle(tmp_path, monkeypatch):
    shutil.copytree("stdlib/robots/industrial6", tmp_path / "ours")
    (tmp_path / "block.stl").write_text(_block())
    (tmp_path / "cell.toml").write_text(
        'units = "mm,deg"\n'
        "[[obstacles]]\n"
        'name = "BLOCK"\n'
        'shape = "mesh"\n'
        'file = "block.stl"\n'
        'frame = "B"\n'
        "xyz = [2000, 0, 0]\n"
    )
    (tmp_path / "way.yarc").write_text('CELL "cell.toml"\nP0010 MOVEJ 10 0 0 0 0 0 [MIN] (deg,s)\n')
    monkeypatch.chdir(tmp_path)
    options = Options(robot="ours")
    with recorded() as answers:
        there = check_file("way.yarc", options)
    read = {question.path for question in answers if question.kind == CONTENT}
    assert {"way.yarc", "cell.toml", "block.stl", "ours/robot.toml"} <= read
    assert there.compiled is not None, there.diagnostics
    contents = dict(content_now(Path(question.path)) for question in answers if question.kind == CONTENT)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    with bundled(Bundle(answers, contents)):
        here = check_file("way.yarc", options)
    assert here.diagnostics == there.diagnostics


def test_what_a_bundle_lacks_is_asked_for_and_taken_for_no_bug():
    with pytest.raises(NotBundledError) as caught, bundled(Bundle({}, {})):
        check_file("examples/01_listing4.yarc", Options(robot="INDUSTRIAL6"))
    assert caught.value.question == Question(CONTENT, "examples/01_listing4.yarc")


def test_a_file_that_changes_between_two_readings_holds_for_nothing(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text("a = 1")
    with recorded() as answers:
        read_whole(path, 100)
        path.write_text("a = 2")
        read_whole(path, 100)
    assert CHANGED in answers.values()


def test_files_that_arent_there_are_recorded_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("way.yarc").write_text("USE TOOLS\nP0010 MOVEJ 10 0 0 0 0 0 [MIN] (deg,s)\n")
    with recorded() as before:
        check_file("way.yarc", Options(robot="INDUSTRIAL6"))
    assert {question for question in before if answer_now(question) != before[question]} == set()
    Path("tools.yarc").write_text("SUB A\nEND\n")
    changed = {question.kind for question in before if answer_now(question) != before[question]}
    assert changed == {"modules TOOLS", "modules *"}
    Path("tools.yarc").unlink()
    Path("yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    changed = {question.kind for question in before if answer_now(question) != before[question]}
    assert changed == {"nearest yarc.toml"}


def test_paths_are_recorded_as_seen_from_the_working_directory(tmp_path, monkeypatch):
    inside, outside = tmp_path / "in", tmp_path / "out.toml"
    inside.mkdir()
    (inside / "a.toml").write_text("")
    outside.write_text("")
    monkeypatch.chdir(inside)
    with recorded() as answers:
        read_whole(inside / "a.toml", 10)
        read_whole(Path("../out.toml"), 10)
    assert {question.path for question in answers} == {"a.toml", str(outside)}


def test_a_pipe_holds_for_nothing(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert answer_now(Question(CONTENT, str(tmp_path / "pipe"))) == CHANGED


def _block():
    corners = [(0, 0, 0), (100, 0, 0), (0, 100, 0), (0, 0, 100)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = ["solid block"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex {} {} {}".format(*corners[one]) for one in face]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid block"]) + "\n"
