"""Tests of the store of results: forged entries, damaged files, full disks, many processes, and processes
that are killed.
"""

import multiprocessing
import os
import signal
import sqlite3
import time

import pytest

from yarclang.fleet.store import Store


@pytest.fixture
def store(tmp_path):
    made = Store(tmp_path / "cache", tmp_path / "state" / "key")
    yield made
    made.close()


def values(store, key):
    return [value for _, value in store.get(key)]


def base(tmp_path):
    return sqlite3.connect(tmp_path / "cache" / "results.sqlite")


def test_what_is_put_is_got(store):
    store.put("a", b"1")
    store.put("a", b"2")
    store.put("b", b"3")
    assert sorted(values(store, "a")) == [b"1", b"2"]
    assert values(store, "b") == [b"3"]
    assert values(store, "c") == []


@pytest.mark.parametrize(
    "forgery",
    [
        "UPDATE entries SET value = x'32'",
        "UPDATE entries SET key = 'other'",
        "UPDATE entries SET code = x''",
        "UPDATE entries SET code = 'text', value = 'text'",
        "INSERT INTO entries (key, code, used, size, value) VALUES ('other', x'00', 1e12, 1, x'31')",
        "UPDATE entries SET code = NULL",
    ],
)
def test_forged_entries_are_not_looked_into(store, tmp_path, forgery):
    store.put("a", b"1")
    store.close()
    with base(tmp_path) as forged:
        try:
            forged.execute(forgery)
        except sqlite3.IntegrityError:
            return
    assert values(store, "other") == []
    assert values(store, "a") in ([], [b"1"])
    assert not (values(store, "a") and "UPDATE" in forgery)


def test_entries_of_another_user_are_not_looked_into(store, tmp_path):
    other = Store(tmp_path / "cache", tmp_path / "other" / "key")
    other.put("a", b"theirs")
    other.close()
    assert values(store, "a") == []


def test_a_secret_that_others_can_read_is_not_used(store, tmp_path):
    store.put("a", b"1")
    store.close()
    (tmp_path / "state" / "key").chmod(0o644)
    again = Store(tmp_path / "cache", tmp_path / "state" / "key")
    assert values(again, "a") == []
    assert "only you can read" in again.trouble


@pytest.mark.parametrize("content", [b"", b"no database", b"SQLite format 3\0" + bytes(200)])
def test_a_damaged_file_is_as_if_it_were_empty_and_the_next_one_is_whole(tmp_path, content):
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache" / "results.sqlite").write_bytes(content)
    first = Store(tmp_path / "cache", tmp_path / "key")
    assert values(first, "a") == []
    first.put("a", b"1")
    first.close()
    second = Store(tmp_path / "cache", tmp_path / "key")
    second.put("a", b"2")
    assert b"2" in values(second, "a")
    second.close()


def test_the_size_is_bounded_and_the_least_recently_used_go_first(tmp_path):
    store = Store(tmp_path / "cache", tmp_path / "key", largest=10_000)
    for number in range(30):
        store.put(f"k{number}", bytes(1000))
        for one, _ in store.get("k0"):
            store.use(one)
    with base(tmp_path) as raw:
        assert raw.execute("SELECT SUM(size) FROM entries").fetchone()[0] <= 10_000
    assert values(store, "k0")
    assert values(store, "k29")
    assert not values(store, "k1")
    store.put("too large", bytes(20_000))
    assert not values(store, "too large")
    store.close()


def test_a_folder_that_cannot_be_written_ends_nothing(tmp_path):
    (tmp_path / "cache").write_text("a file")
    store = Store(tmp_path / "cache", tmp_path / "key")
    store.put("a", b"1")
    assert values(store, "a") == []
    assert store.trouble


def test_a_full_disk_ends_nothing_and_leaves_the_store_whole(store):
    store.put("a", b"1")
    store._base.execute("PRAGMA max_page_count = 12")
    store.put("b", bytes(1_000_000))
    assert "full" in store.trouble
    store.put("c", b"3")  # after a failure, the store tries no more writes
    store.close()


def _fill(folder, secret, letter, count):
    store = Store(folder, secret)
    for number in range(count):
        store.put(f"{letter}{number}", letter.encode() * 1000)
    store.close()


def test_processes_at_once(tmp_path):
    context = multiprocessing.get_context("spawn")
    started = [
        context.Process(target=_fill, args=(tmp_path / "cache", tmp_path / "key", letter, 40))
        for letter in "xyz"
    ]
    for process in started:
        process.start()
    for process in started:
        process.join()
        assert process.exitcode == 0
    store = Store(tmp_path / "cache", tmp_path / "key")
    for letter in "xyz":
        for number in range(40):
            assert values(store, f"{letter}{number}") == [letter.encode() * 1000]
    store.close()


def test_a_process_that_is_killed_while_it_writes(tmp_path):
    context = multiprocessing.get_context("spawn")
    for number in range(3):
        process = context.Process(
            target=_fill, args=(tmp_path / "cache", tmp_path / "key", f"k{number}-", 100_000)
        )
        process.start()
        until = time.monotonic() + 30.0
        while not (tmp_path / "cache" / "results.sqlite").exists() and time.monotonic() < until:
            time.sleep(0.01)
        time.sleep(0.3 + 0.07 * number)
        os.kill(process.pid, signal.SIGKILL)
        process.join()
        store = Store(tmp_path / "cache", tmp_path / "key")
        store.put("after", b"1")
        assert b"1" in values(store, "after")
        found = values(store, f"k{number}-0")
        assert found in ([], [f"k{number}-".encode() * 1000])
        with base(tmp_path) as raw:
            assert raw.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        store.close()
