"""Tests of users, sessions, PINs and their database, including damage to its file."""

import asyncio
import os
import signal
import sqlite3
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.pendant.accounts import people
from yarclang.pendant.accounts.accounts import Accounts, NotAllowed, TooMany
from yarclang.pendant.accounts.attempts import FREE, LONGEST_WAIT, Attempts
from yarclang.pendant.accounts.database import Database
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import IDLE, LONGEST, MOST
from yarclang.runtime.actions import Trouble

PASSWORD = "correct horse"


class Clock:
    def __init__(self, now=1000.0):
        self.now = now

    def __call__(self):
        return self.now


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Replace the password hashes by fake ones that take no time. argon2id has a test of its own."""
    monkeypatch.setattr("yarclang.pendant.accounts.accounts.hashed", lambda secret: f"hash of {secret}")
    monkeypatch.setattr(
        "yarclang.pendant.accounts.accounts.is_secret", lambda kept, secret: kept == f"hash of {secret}"
    )


def trial(tmp_path, work, *, fresh=False, **clocks):
    """Run a test coroutine with accounts; anna is their first user, unless `fresh`."""

    async def whole():
        accounts = Accounts(tmp_path / "data" / "pendant.db", **clocks)
        try:
            if not fresh:
                await accounts.begin(accounts.first, "anna", PASSWORD, "4711", "::1")
            return await work(accounts)
        finally:
            await accounts.close()

    return asyncio.run(whole())


def login(accounts, name="anna", password=PASSWORD, address="::1", device=""):
    return accounts.login(name, password, address, "a test", device)


def test_passwords_are_kept_as_argon2id():
    from yarclang.pendant.accounts.passwords import hashed, is_secret

    kept = hashed(PASSWORD)
    assert kept.startswith("$argon2id$")
    assert is_secret(kept, PASSWORD)
    assert not is_secret(kept, PASSWORD + "r")
    assert not is_secret(None, "nobody")
    assert not is_secret("damaged", PASSWORD)


def test_the_first_link_makes_one_user(tmp_path):
    async def work(accounts):
        with pytest.raises(NotAllowed, match="link"):
            await accounts.begin("wrong", "anna", PASSWORD, "4711", "::1")
        first = accounts.first
        with pytest.raises(Trouble, match="8 to 256"):
            await accounts.begin(first, "anna", "short", "4711", "::1")
        with pytest.raises(Trouble, match="PIN"):
            await accounts.begin(first, "anna", PASSWORD, "1111", "::1")
        await accounts.begin(first, "anna", PASSWORD, "4711", "::1")
        assert accounts.first == ""
        for token in (first, ""):
            with pytest.raises(NotAllowed, match="link"):
                await accounts.begin(token, "eve", PASSWORD, "4711", "::1")
        assert [one.name for one in await accounts.all_users()] == ["anna"]
        assert "correct" not in (tmp_path / "data" / "pendant.db").read_bytes().decode("latin-1").replace(
            "hash of correct", ""
        )

    trial(tmp_path, work, fresh=True)


def test_files_are_for_one_user_alone(tmp_path):
    async def work(accounts):
        for place in (tmp_path / "data").iterdir():
            assert place.stat().st_mode & 0o077 == 0, place

    trial(tmp_path, work)


def test_five_wrong_passwords_slow_down(tmp_path):
    clock = Clock()

    async def work(accounts):
        for _ in range(FREE):
            with pytest.raises(Trouble, match="the name or the password is wrong"):
                await login(accounts, password="wrong")
        with pytest.raises(TooMany):
            await login(accounts)
        clock.now += 3.0
        session, _, _ = await login(accounts)
        assert session.user == "anna"

    trial(tmp_path, work, now=clock)


def test_nobody_locks_others_out(tmp_path):
    """Wrong passwords, even from her own network address, don't lock anna out of a device that she has used
    before.
    """
    clock = Clock()

    async def work(accounts):
        _, _, device = await login(accounts)
        for number in range(200):
            clock.now += 0.1
            with pytest.raises(Trouble):
                await login(accounts, name=f"guess{number % 7}" if number % 2 else "anna", password="wrong")
        with pytest.raises(TooMany):
            await login(accounts)
        session, _, same = await login(accounts, device=device)
        assert session.user == "anna"
        assert same == device
        # at another address, too, anna can log in at once
        await login(accounts, address="10.0.0.7")

    trial(tmp_path, work, now=clock)


def test_a_device_of_one_user_is_none_of_another(tmp_path):
    async def work(accounts):
        await accounts.add("bea", Role.OPERATOR, PASSWORD, None)
        _, _, device = await login(accounts)
        for _ in range(FREE):
            with pytest.raises(Trouble):
                await login(accounts, name="bea", password="wrong", device=device)
        with pytest.raises(TooMany):
            await login(accounts, name="bea", device=device)
        await login(accounts, device=device)

    trial(tmp_path, work)


@given(st.lists(st.floats(0.0, 1000.0), max_size=60))
def test_waits_grow_and_end(pauses):
    attempts, now = Attempts(), 0.0
    before = 0.0
    for pause in pauses:
        now += pause
        count = attempts.failed(("anna", "::1"), now)
        wait = attempts.wait(("anna", "::1"), now)
        assert 0.0 <= wait <= LONGEST_WAIT
        assert (wait > 0.0) == (count >= FREE)
        assert wait >= before or pause > 0.0
        before = wait
        assert attempts.wait(("bea", "::1"), now) == attempts.wait(("anna", "::2"), now) == 0.0
        assert attempts.wait(("anna", "::1"), now + LONGEST_WAIT + 1.0) == 0.0


def test_attempts_of_a_million_names_take_no_memory():
    attempts = Attempts()
    for number in range(20_000):
        attempts.failed((str(number), "::1"), float(number))
    assert len(attempts._failures) < 5000


def test_sessions_end(tmp_path):
    clock = Clock()

    async def work(accounts):
        session, token, _ = await login(accounts)
        clock.now += IDLE - 1.0
        assert accounts.session_of(token) is session
        accounts.used(session)
        clock.now += IDLE - 1.0
        assert accounts.session_of(token) is session
        clock.now += 2.0
        assert accounts.session_of(token) is None
        session, token, _ = await login(accounts)
        for _ in range(int(LONGEST / IDLE) + 1):
            clock.now += IDLE * 0.99
            accounts.used(session)
        assert accounts.session_of(token) is None
        assert accounts.session_of("") is None
        assert accounts.session_of("x" * 10_000) is None

    trial(tmp_path, work, now=clock)


def test_sessions_are_bounded(tmp_path):
    async def work(accounts):
        tokens = [(await login(accounts))[1] for _ in range(MOST + 5)]
        assert len(accounts.sessions.all()) == MOST
        assert accounts.session_of(tokens[0]) is None
        assert accounts.session_of(tokens[-1]) is not None

    trial(tmp_path, work)


@pytest.mark.parametrize(
    ("later", "goes_on"), [(60.0, True), (IDLE + 60.0, False), (-30.0, True), (-3600.0, False)]
)
def test_sessions_outlast_a_restart_but_no_clock_that_is_set_back(tmp_path, later, goes_on):
    now, wall = Clock(), Clock(1.8e9)

    async def before(accounts):
        return (await login(accounts))[1]

    async def after(accounts):
        assert (accounts.session_of(token) is not None) == goes_on
        if goes_on:  # after the restart, the session still ends at its original time
            now.now += LONGEST
            assert accounts.session_of(token) is None

    token = trial(tmp_path, before, now=now, wall=wall)
    now.now, wall.now = 5.0, wall.now + later
    trial(tmp_path, after, fresh=True, now=now, wall=wall)


def test_a_clock_that_is_set_back_while_it_runs_changes_nothing(tmp_path):
    now, wall = Clock(), Clock(1.8e9)

    async def work(accounts):
        _, token, _ = await login(accounts)
        wall.now -= 1e8
        assert accounts.session_of(token) is not None
        now.now += IDLE + 1.0
        assert accounts.session_of(token) is None

    trial(tmp_path, work, now=now, wall=wall)


def test_pins(tmp_path):
    clock = Clock()

    async def work(accounts):
        session, token, _ = await login(accounts)
        with pytest.raises(NotAllowed, match="PIN"):
            accounts.check(session, Role.SERVICE, pin=True)
        with pytest.raises(NotAllowed, match="wrong"):
            await accounts.confirm(session, "0000")
        lasts = await accounts.confirm(session, "4711")
        accounts.check(session, Role.SERVICE, pin=True)
        clock.now += lasts + 1.0
        with pytest.raises(NotAllowed, match="PIN"):
            accounts.check(session, Role.SERVICE, pin=True)
        for _ in range(5):
            with pytest.raises(NotAllowed):
                await accounts.confirm(session, "0000")
        assert accounts.session_of(token) is None

    trial(tmp_path, work, now=clock)


def test_users_are_changed_and_one_for_service_stays(tmp_path):
    async def work(accounts):
        await accounts.add("Bea", Role.OPERATOR, PASSWORD, None)
        with pytest.raises(Trouble, match="already"):
            await accounts.add("bea", Role.VIEWER, PASSWORD, None)
        with pytest.raises(Trouble, match="needs a PIN"):
            await accounts.add("carl", Role.SERVICE, PASSWORD, None)
        for name in ("", " x", "a/b", "<b>", "x" * 41, "\n"):
            with pytest.raises(Trouble, match="name"):
                await accounts.add(name, Role.VIEWER, PASSWORD, None)
        _, token, _ = await login(accounts, "BEA")
        with pytest.raises(Trouble, match="only user of the role service"):
            await accounts.remove("anna")
        with pytest.raises(Trouble, match="only user of the role service"):
            await accounts.change("anna", role=Role.VIEWER)
        with pytest.raises(Trouble, match="needs a PIN"):
            await accounts.change("bea", role=Role.SERVICE)
        await accounts.change("bea", role=Role.SERVICE, pin="1234")
        assert accounts.session_of(token) is None
        await accounts.remove("ANNA")
        assert [one.name for one in await accounts.all_users()] == ["Bea"]
        with pytest.raises(Trouble, match="no user"):
            await accounts.remove("anna")

    trial(tmp_path, work)


def test_a_new_password_ends_the_other_sessions(tmp_path):
    async def work(accounts):
        here, token, device = await login(accounts)
        _, other, _ = await login(accounts)
        with pytest.raises(Trouble, match="old password"):
            await accounts.change_own(here, "wrong", password="another one", pin=None)
        await accounts.change_own(here, PASSWORD, password="another one", pin=None)
        assert accounts.session_of(token) is here
        assert accounts.session_of(other) is None
        with pytest.raises(Trouble):
            await login(accounts)
        await login(accounts, password="another one", device=device)

    trial(tmp_path, work)


def test_the_audit_trail_is_never_changed(tmp_path):
    async def work(accounts):
        await login(accounts)
        for sentence in ("DELETE FROM audit", "UPDATE audit SET user = 'eve'"):
            with pytest.raises(Trouble, match="never changed"):
                await accounts.database.call(lambda connection, text=sentence: connection.execute(text))
        found = [deed.action for _, _, deed in await accounts.deeds(None, 10)]
        assert found == ["login", "first user"]

    trial(tmp_path, work)


def test_a_full_disk(tmp_path):
    """On a full disk, actions that can't be recorded in the audit trail are refused. A stop is executed
    anyway.
    """

    async def work(accounts):
        def fill(connection):
            pages = connection.execute("PRAGMA page_count").fetchone()[0]
            connection.execute(f"PRAGMA max_page_count = {pages}")

        session, _, _ = await login(accounts)
        await accounts.database.call(fill)

        async def write_on():
            for _ in range(1000):
                await accounts.did(people.Deed("anna", "::1", "run", "x" * 500))

        with pytest.raises(Trouble, match="full") as caught:
            await write_on()
        assert "make room" in caught.value.remedy
        assert accounts.trouble is not None
        accounts.note(people.Deed("anna", "::1", "stop"))
        await accounts.database.call(lambda connection: connection.execute("PRAGMA max_page_count = 100000"))
        await accounts.did(people.Deed("anna", "::1", "run"))
        assert accounts.trouble is None
        assert not accounts.is_over(session)

    trial(tmp_path, work)


@pytest.mark.parametrize("is_replaced", [False, True])
def test_a_file_that_was_removed_while_it_was_in_use(tmp_path, is_replaced):
    """SQLite writes to a removed file without an error, and the audit trail would be lost without a word."""

    async def work(accounts):
        path = accounts.database.path
        kept = path.with_suffix(".kept")
        path.rename(kept)
        if is_replaced:
            path.touch()
        with pytest.raises(Trouble, match="was removed or replaced") as caught:
            await accounts.did(people.Deed("anna", "here", "run"))
        assert "restart the pendant" in caught.value.remedy
        assert accounts.trouble is not None
        kept.replace(path)
        await accounts.did(people.Deed("anna", "here", "run"))
        assert accounts.trouble is None

    trial(tmp_path, work)


@pytest.mark.parametrize("damage", ["text", "cut", "middle", "folder", "later"])
def test_a_damaged_file_is_one_clear_error(tmp_path, damage):
    async def fill(accounts):
        for _ in range(200):
            await accounts.did(people.Deed("anna", "::1", "run", "x" * 400))

    trial(tmp_path, fill)
    place = tmp_path / "data" / "pendant.db"
    content = place.read_bytes()
    match damage:
        case "text":
            place.write_text("this is no database, but a text that is long enough to be one\n" * 20)
        case "cut":
            place.write_bytes(content[: len(content) // 3])
        case "middle":
            place.write_bytes(content[:6000] + b"\xa5" * 9000 + content[15000:])
        case "folder":
            place.unlink()
            place.mkdir()
        case "later":
            with sqlite3.connect(place) as connection:
                connection.execute("PRAGMA user_version = 99")
    with pytest.raises(Trouble) as caught:
        trial(tmp_path, fill, fresh=True)
    assert str(place) in caught.value.what
    assert caught.value.remedy


def test_it_is_whole_after_kill_9(tmp_path):
    """A process that writes audit entries, and reports each written one, is killed several times. No reported
    entry is lost.
    """
    place = tmp_path / "pendant.db"
    writes = (
        "import sys\n"
        "from pathlib import Path\n"
        "from yarclang.pendant.accounts.database import Database\n"
        "from yarclang.pendant.accounts import people\n"
        f"database = Database(Path({str(place)!r}))\n"
        "for number in range(100000):\n"
        "    database.now(people.write_deed, people.Deed('anna', '::1', 'run', sys.argv[1] + str(number)))\n"
        "    print(number, flush=True)\n"
    )
    said = []
    for turn in range(4):
        process = subprocess.Popen(
            [sys.executable, "-c", writes, f"{turn}."], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None
        said += [f"{turn}.{process.stdout.readline().strip()}" for _ in range(5 + 20 * turn)]
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        process.stdout.close()
    database = Database(place)
    try:
        found = {deed.detail for _, _, deed in database.now(people.deeds, None, 10**6)}
    finally:
        database.close()
    assert set(said) <= found
