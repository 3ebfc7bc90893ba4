"""Tests of the process's settings for prompt stops (priority, garbage collection, thread switching). All of
them are undone afterwards, and none is required.
"""

import asyncio
import gc
import os
import sys
import threading

import pytest

from yarclang.runtime.transports import promptness
from yarclang.runtime.transports.promptness import prompt_thread, prompt_while_moving, shares_the_interpreter


@pytest.fixture
def refused(monkeypatch):
    """Refuse real-time scheduling, as for a user without the right to it."""

    def refuse(*_):
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)


@pytest.fixture
def given(monkeypatch):
    """Accept requests for real-time scheduling, and record them instead of executing them."""
    asked = []
    monkeypatch.setattr(
        os, "sched_setscheduler", lambda thread, _, param: asked.append((thread, param.sched_priority))
    )
    return asked


def test_what_is_changed_while_something_moves_is_changed_back():
    before = sys.getswitchinterval(), gc.get_threshold(), gc.get_freeze_count()
    with prompt_while_moving():
        assert sys.getswitchinterval() < 0.001
        assert gc.get_threshold()[2] >= 1000
        with prompt_while_moving():  # a second robot moves at the same time
            pass
        assert sys.getswitchinterval() < 0.001
    assert (sys.getswitchinterval(), gc.get_threshold()) == before[:2]
    assert bool(gc.get_freeze_count()) == bool(before[2])


def test_an_error_changes_it_back_too():
    before = sys.getswitchinterval()
    with pytest.raises(KeyError), prompt_while_moving():
        raise KeyError
    assert sys.getswitchinterval() == before


def test_who_may_not_go_first_goes_on_without(refused, monkeypatch):
    asked = []
    monkeypatch.setattr(promptness, "_ask_for_slices", asked.append)
    with prompt_thread(), prompt_while_moving(), shares_the_interpreter():
        pass
    assert len(asked) == 2
    assert asked[1] == 0, "the system's own slices"


def test_a_system_that_knows_nothing_of_it_is_left_alone(refused, monkeypatch):
    monkeypatch.setattr(promptness.platform, "machine", lambda: "abacus")
    with prompt_thread():
        pass
    monkeypatch.delattr(os, "sched_setscheduler")
    with prompt_thread(), prompt_while_moving(), shares_the_interpreter():
        pass


def test_who_plans_is_not_kept_from_giving_way(given):
    """While a robot moves, a thread that plans has priority over ordinary threads, but not over the thread
    that streams.
    """
    number = threading.get_native_id()
    with prompt_thread():
        with shares_the_interpreter():
            assert given == [(0, 2)]
            with prompt_while_moving():
                assert given.pop() == (number, 1)
            assert given.pop() == (number, 0)
        with prompt_while_moving(), shares_the_interpreter():
            assert given.pop() == (number, 1)
        assert given.pop() == (number, 0)
    assert given[-1] == (0, 0)


def test_without_a_thread_that_streams_nobody_goes_first(given):
    with prompt_while_moving(), shares_the_interpreter():
        pass
    assert not given


def test_threads_that_begin_later_are_ordinary():
    async def policies():
        with prompt_thread():
            return await asyncio.to_thread(os.sched_getscheduler, 0)

    assert asyncio.run(policies()) & ~os.SCHED_RESET_ON_FORK == os.SCHED_OTHER
    assert os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_OTHER
