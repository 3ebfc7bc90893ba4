"""Tests of a campaign's state file: it is intact after any interruption, and used by no other campaign."""

import json
import os
import resource
import subprocess
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.campaign.pieces import Find, Piece, Worst, lost_piece, piece_of
from yarclang.campaign.report import summed
from yarclang.campaign.state import State, StateError, missing

WHAT = {"seed": 0, "robots": ["INDUSTRIAL6 abc"], "cell": None, "installation": "1234"}


def piece(first, count=10):
    return Piece(
        first, count, 5, {"Y0601": 4}, {"line": 7}, {"line": 3}, 1_000_001 + first,
        {"path": Worst(0.5 + first / 1000, first)}, [Find(first, "ARM", ("bad",))], 1, 0.25,
    )  # fmt: skip


def kept(path):
    with State(path, WHAT) as state:
        return state.pieces


@pytest.fixture
def file(tmp_path):
    with State(tmp_path / "s", WHAT) as state:
        for first in (0, 20, 10):
            state.keep(piece(first))
    return tmp_path / "s"


def test_what_is_kept_is_there_again(file):
    assert kept(file) == [piece(0), piece(20), piece(10)]


def test_a_file_that_ends_anywhere_has_all_whole_lines_before(file):
    content = file.read_bytes()
    ends = [place for place, byte in enumerate(content) if byte == 10]
    for size in range(len(content)):
        file.write_bytes(content[:size])
        whole = sum(end < size for end in ends)
        with State(file, WHAT) as state:
            assert len(state.pieces) == max(0, whole - 1), size
            state.keep(piece(30))
        assert kept(file)[-1] == piece(30)


def test_a_line_that_is_changed_removed_or_moved_is_an_error(file):
    lines = file.read_bytes().splitlines(keepends=True)
    forged = [
        [lines[0], lines[1].replace(b'"found":1', b'"found":0'), *lines[2:]],
        [lines[0], *lines[2:]],
        [lines[0], lines[2], lines[1], lines[3]],
        [lines[0].replace(b"1234", b"1235"), *lines[1:]],
        [*lines[:2], b"\xff\x00\n", *lines[2:]],
    ]
    for content in forged:
        assert content != lines
        file.write_bytes(b"".join(content))
        with pytest.raises(StateError, match="was changed or damaged"):
            State(file, WHAT)
        assert file.read_bytes() == b"".join(content)


@pytest.mark.parametrize("name", list(WHAT))
def test_the_state_of_another_campaign_is_refused(file, name):
    with pytest.raises(StateError, match=f"its {name} is"):
        State(file, {**WHAT, name: "another"})
    assert len(kept(file)) == 3


@pytest.mark.parametrize("content", [b"a letter to my aunt", b"a letter\n", b"\n", b"{}\n{}\n", bytes(100)])
def test_another_file_is_not_touched(tmp_path, content):
    (tmp_path / "s").write_bytes(content)
    with pytest.raises(StateError):
        State(tmp_path / "s", WHAT)
    assert (tmp_path / "s").read_bytes() == content


def test_a_folder_and_a_pipe_are_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe", tmp_path / "no" / "folder", "/dev/null"):
        with pytest.raises(StateError, match="--state"):
            State(type(tmp_path)(path), WHAT)


def test_two_processes_do_not_share_a_state(file):
    with State(file, WHAT), pytest.raises(StateError, match="another process"):
        State(file, WHAT)
    assert len(kept(file)) == 3


FULL = """
import resource, sys
from pathlib import Path
from yarclang.campaign.pieces import Piece
from yarclang.campaign.state import State, StateError
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
with State(Path(sys.argv[1]), {"seed": 0}) as state:
    try:
        for number in range(1000):
            state.keep(Piece(number, 1))
    except StateError as error:
        print(number, error)
"""


def test_a_full_disk_is_said_and_keeps_what_was_kept(tmp_path):
    made = subprocess.run(
        [sys.executable, "-c", FULL, str(tmp_path / "s")], capture_output=True, text=True, check=True
    )
    number, _, words = made.stdout.partition(" ")
    assert f"the results of the {int(number):,} programs before are saved" in words
    with State(tmp_path / "s", {"seed": 0}) as state:
        assert [one.first for one in state.pieces] == list(range(int(number)))


@settings(max_examples=100)
@given(st.lists(st.integers(1, 9), max_size=12), st.randoms(), st.integers(0, 40), st.integers(1, 9))
def test_what_is_missing_and_what_is_there_are_everything_once(sizes, random, count, size):
    pieces, at = [], 5
    for one in sizes:
        if random.random() < 0.5:
            pieces.append(Piece(at, one))
        at += one
    random.shuffle(pieces)
    found = missing(pieces, 5, count, size)
    assert all(1 <= number <= size for _, number in found)
    there = {seed for one in pieces for seed in range(one.first, one.first + one.count)}
    new = [seed for first, number in found for seed in range(first, first + number)]
    assert sorted(new) == [seed for seed in range(5, 5 + count) if seed not in there]


def test_a_program_that_is_there_twice_is_an_error():
    with pytest.raises(StateError, match="seed 5 is recorded twice"):
        missing([Piece(0, 10), Piece(5, 10)], 0, 100, 10)


@settings(max_examples=50)
@given(st.permutations([piece(0), piece(10), piece(20), lost_piece(30, "ARM", "died")]))
def test_a_sum_does_not_depend_on_the_order(pieces):
    whole = summed(pieces, 0)
    assert whole == summed([piece(0), piece(10), piece(20), lost_piece(30, "ARM", "died")], 0)
    assert (whole.count, whole.found, whole.worst["path"].seed) == (31, 4, 20)
    assert piece_of(json.loads(json.dumps(whole.written))) == whole


def test_the_limit_of_this_process_is_not_touched():
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
