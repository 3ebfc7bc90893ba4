"""Tests of the feed. It never sends more lines than fit into the buffer, and never overestimates the buffered
lines. It sends each line once and in order, whatever the controller executes in the meantime.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from runtime.virtual import example_of, prepared

from yarclang.runtime.pmac.feed import AHEAD, Feed
from yarclang.runtime.pmac.loading import Loading, capacity_of, loading_of
from yarclang.runtime.pmac.packets import fitting

SEGMENT = 0.01


def job_of(gaps, words=480, guarded=False):
    """Return a job of moves that take `SEGMENT` each. `gaps` has the number of lines without a duration
    before each move. If `guarded`, ten lines disarm the guard after the last move.
    """
    model, _ = prepared()
    lines, times = [], []
    for number, gap in enumerate(gaps, 1):
        lines += [f"P{n}=0" for n in range(gap)] + [f"X{number}.123456Y{number}.123456Z0A0B0C0"]
        times += [0.0 if number == 1 else number * SEGMENT] * gap + [number * SEGMENT]
    lines += ["P8100=P8100&2"] * (10 * guarded)
    times += [(len(gaps) + 2) * SEGMENT] * (10 * guarded)
    return replace(
        model,
        lines=tuple(lines),
        times=np.array(times),
        duration=(len(gaps) + 2) * SEGMENT,
        segment=SEGMENT,
        capacity=capacity_of(model.robot, words),
        own=Loading((), words, 5, 10),
    )


class Executor:
    """The fastest execution that a controller is capable of: one move in each segment, and two at once at the
    beginning and after the buffer was empty.

    `pace` gives for each segment how long it takes, in segments (1 or more).
    """

    def __init__(self, job, pace):
        self.job = job
        self.pace = pace
        self.taken = self.loaded = 0
        self.next = None
        self.moved = 0

    @property
    def ahead(self):
        return self.loaded - self.taken

    def begin(self, now):
        self._calculate()
        self._calculate()
        self.next = now + SEGMENT

    def pass_to(self, now):
        while self.next is not None and self.next <= now:
            dry = not self.ahead
            self._calculate()
            if dry:
                self._calculate()
            self.next += SEGMENT * self.pace[self.moved % len(self.pace)]
            self.moved += 1

    def _calculate(self):
        """Take lines up to and including the next move, if the buffer contains one."""
        while self.taken < self.loaded:
            self.taken += 1
            if self.job.lines[self.taken - 1].startswith("X"):
                return


JOBS = st.builds(
    job_of,
    st.lists(st.integers(0, 3), min_size=1, max_size=200),
    st.integers(160, 700),
    st.booleans(),
)
STEPS = st.lists(
    st.tuples(st.sampled_from(["write", "ask", "wait"]), st.floats(0.0, 0.3)), min_size=1, max_size=60
)
PACES = st.lists(st.sampled_from([1.0, 1.0, 1.7, 20.0]), min_size=1, max_size=5)


@given(JOBS, STEPS, PACES)
def test_bounds_hold_whatever_the_controller_executes(job, steps, pace):
    feed, controller, now, received = Feed(job), Executor(job, pace), 0.0, []

    def passes(seconds):
        nonlocal now
        now += seconds
        controller.pass_to(now)

    def look():
        assert controller.ahead <= feed.at_most <= job.capacity
        assert feed.at_least(now) <= controller.ahead
        assert feed.left == len(job.lines) - len(received)
        assert tuple(received) == job.lines[: len(received)]
        least, most = feed.executed_within(now)
        assert least == feed.executed <= max(0, controller.taken - AHEAD)
        assert controller.taken <= most <= feed.sent

    while packet := feed.packet():
        received += packet
        controller.loaded += len(packet)
        feed.written(len(packet))
    controller.begin(now)
    feed.heard(controller.ahead, now, now)
    for kind, seconds in steps:
        match kind:
            case "wait":
                passes(seconds)
            case "ask":
                asked = now
                passes(seconds / 2)
                answer = controller.ahead
                passes(seconds / 2)
                feed.heard(answer, asked, now)
            case _:
                packet = feed.packet()
                assert len(packet) <= feed.room
                passes(seconds / 2)
                received += packet
                controller.loaded += len(packet)
                assert controller.ahead <= job.capacity
                feed.written(len(packet))
                passes(seconds / 2)
        look()


@given(JOBS)
def test_packets_are_the_lines_in_order_and_fit(job):
    feed, sent = Feed(job), []
    while feed.left:
        packet = feed.packet()
        if not packet:
            feed.heard(0, 0.0, 0.0)
            continue
        assert fitting(packet) == len(packet) <= feed.room
        sent += packet
        feed.written(len(packet))
    assert tuple(sent) == job.lines
    assert feed.packet() == ()
    assert not feed.worthwhile(0.0)
    assert not feed.runs_low(1e9)


def test_a_packet_is_worth_it_where_it_is_full_or_the_last_or_lines_are_few():
    job = job_of([0] * 200, words=800)
    feed = Feed(job)
    assert len(feed.packet()) == fitting(job.lines) < job.capacity
    assert feed.worthwhile(0.0)
    while feed.packet():
        feed.written(len(feed.packet()))
    assert feed.room == 0
    feed.heard(job.capacity - 3, 1.0, 1.0)
    # There is room for only three lines, so it isn't worth sending a packet yet.
    assert len(feed.packet()) == 3
    assert not feed.worthwhile(1.0)
    # A second later, the buffer may be almost empty.
    assert feed.worthwhile(2.0)


def test_a_packet_is_worth_it_where_the_buffer_may_have_less_than_plenty():
    """Lines without moves can empty the buffer from `plenty` to the low mark at once."""
    job = job_of([0] * 200, words=400)
    feed = Feed(job)
    while feed.packet():
        feed.written(len(feed.packet()))
    feed.heard(feed.plenty - 1, 1.0, 1.0)
    assert loading_of(job).full < feed.at_least(1.0)
    assert len(feed.packet()) == feed.room, "not a full packet"
    assert feed.worthwhile(1.0)
    feed.heard(feed.plenty, 1.0, 1.0)
    assert not feed.worthwhile(1.0)


@pytest.mark.parametrize(("gaps", "dry"), [([90] * 3, True), ([90, 0, 0], False), ([0, 0, 0], False)])
def test_a_buffer_runs_dry_only_between_moves(gaps, dry):
    """Before the first move and after the last one, an empty buffer is only filled again."""
    job = job_of(gaps)
    job = replace(job, lines=(*job.lines, *["P1=1"] * 90), times=np.append(job.times, [job.duration] * 90))
    feed, ran = Feed(job), []
    while feed.left:
        feed.written(len(feed.packet()))
        feed.heard(0, 0.0, 0.0)
        ran.append(feed.ran_dry)
    assert any(ran) == dry
    assert not ran[-1]
    assert not feed.runs_low(1e9)


def test_lines_that_disarm_the_guard_are_needed():
    """Until they are in the buffer, the guard would hold the last moves."""
    job = job_of([0] * 100, words=2000, guarded=True)
    feed = Feed(job)
    for sent, needed in ((50, True), (100, True), (109, True), (110, False)):
        feed.written(sent - feed.sent)
        feed.heard(3, 1.0, 1.0)
        assert feed.runs_low(1.0) == needed


def test_few_lines_ahead_are_low_water_and_before_that_hunger():
    job = job_of([0] * 200, words=800)
    feed = Feed(job)
    while feed.packet():
        feed.written(len(feed.packet()))
    assert loading_of(job).low < feed.low < loading_of(job).full < feed.plenty < job.capacity
    for ahead in range(job.capacity + 1):
        feed.heard(ahead, 1.0, 1.0)
        assert feed.runs_low(1.0) == (ahead < feed.low)
        assert feed.hungry(1.0) == (ahead < feed.plenty)


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
@pytest.mark.parametrize("tm", [5, 20, 50])
def test_the_buffer_of_a_compiled_program_is_large_enough(robot, tm):
    job, _ = example_of(robot, tm=tm)
    feed = Feed(job)
    assert job.capacity * job.segment > 0.99
    assert loading_of(job).low < feed.low <= loading_of(job).full < feed.plenty < job.capacity
