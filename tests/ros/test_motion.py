"""The motion link's state machine: everything that the stock client does, in any order."""

import math

import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.ros.motion import (
    MOST_POINTS,
    PATIENCE,
    PAUSE,
    Answer,
    Hold,
    MotionLink,
    Move,
    Plan,
    Refused,
    Stop,
)
from yarclang.ros.refusal import UNNAMED, Refusal
from yarclang.ros.simple_message import Code, Comm, FullPoint, Message, Other, Ping, TrajectoryPoint

STEP = 0.007


def point(sequence, value=0.1, duration=0.1, comm=Comm.REQUEST):
    return Message(comm, TrajectoryPoint(sequence, (value,) * 6 + (0.0,) * 4, 0.1, duration))


def kinds(actions):
    return [type(one) for one in actions if not isinstance(one, Answer)]


def codes(actions):
    return [one.message.code for one in actions if isinstance(one, Answer)]


class Link:
    """A link with its own clock, and the actions that it has requested."""

    def __init__(self, **options):
        self.link = MotionLink(6, **options)
        self.now = 100.0
        self.actions = []
        self.link.connected()

    def say(self, message, after=STEP):
        self.wait(after)
        found = self.link.heard(message, self.now)
        self.actions += found
        return found

    def wait(self, seconds):
        """Let time pass, and serve the link's timers."""
        end = self.now + seconds
        while (due := self.link.due) is not None and due <= end:
            self.now = max(self.now, due)
            self.actions += self.link.passed(self.now)
        self.now = end

    def goal(self, count=4):
        for place in range(count):
            self.say(point(place, value=0.01 * place))

    def planned(self):
        return [one.goal for one in self.actions if isinstance(one, Plan)]

    def made(self, refusal=None):
        """Report the newest goal as planned, if there is one."""
        goals = self.planned()
        return self.link.planned(goals[-1], refusal) if goals else []

    def drop(self):
        """Break the connection, and connect again."""
        self.actions += self.link.disconnected(self.now)
        self.actions += self.link.connected()


def moving(count=4, **options):
    at = Link(**options)
    at.goal(count)
    at.wait(PAUSE)
    at.actions += at.made()
    assert at.link.phase == "moving"
    return at


def test_a_streamed_goal_is_planned_after_the_pause():
    at = Link()
    at.goal()
    at.wait(PAUSE * 0.9)
    assert at.planned() == []
    at.wait(PAUSE * 0.2)
    (goal,) = at.planned()
    assert [one.sequence for one in goal.points] == [0, 1, 2, 3]
    assert codes(at.actions) == [Code.SUCCESS] * 4
    assert at.link.phase == "planning"
    assert kinds(at.made()) == [Move]
    assert at.link.ended(1, None) == []
    assert at.link.is_idle


def test_each_answer_has_the_body_of_its_request():
    at = Link()
    message = point(0)
    (answer,) = at.say(message)
    assert answer.message == Message(Comm.REPLY, message.body, Code.SUCCESS)


def test_a_download_is_planned_at_its_end_and_nothing_is_answered():
    at = Link()
    for sequence in (-1, 1, 2):
        at.say(point(sequence, comm=Comm.TOPIC))
    at.wait(1.0)
    assert at.planned() == []
    at.say(point(-3, comm=Comm.TOPIC))
    (goal,) = at.planned()
    assert len(goal.points) == 4
    assert goal.downloaded
    assert codes(at.actions) == []


def test_a_download_of_one_point_is_its_end():
    at = Link()
    at.say(point(-3, comm=Comm.TOPIC))
    assert len(at.planned()) == 1


def test_a_download_without_an_end_is_refused():
    at = Link()
    at.say(point(-1, comm=Comm.TOPIC))
    at.wait(PATIENCE + 1.0)
    assert at.planned() == []
    assert at.link.refusal.code == "Y1623"


def test_the_first_duration_may_be_anything():
    at = Link()
    at.say(point(0, duration=math.nan))
    at.wait(PAUSE)
    assert len(at.planned()) == 1


@pytest.mark.parametrize("duration", [0.0, -1.0, math.inf, math.nan])
def test_a_later_duration_is_a_time(duration):
    at = Link()
    at.say(point(0))
    assert codes(at.say(point(1, duration=duration))) == [Code.FAILURE]
    assert at.link.refusal.number == 1622
    at.wait(1.0)
    assert at.planned() == []


def test_a_gap_is_refused_and_so_is_all_until_the_next_goal():
    at = Link()
    at.say(point(0))
    assert codes(at.say(point(2))) == [Code.FAILURE]
    assert codes(at.say(point(3))) == [Code.FAILURE]
    at.wait(1.0)
    assert at.planned() == []
    assert at.link.refusal.code == "Y1623"
    at.say(point(0))
    assert at.link.refusal is None
    at.wait(PAUSE)
    assert len(at.planned()) == 1


@pytest.mark.parametrize("sequence", [3, -5, -3000])
def test_a_point_without_a_goal_is_refused(sequence):
    at = Link()
    assert codes(at.say(point(sequence))) == [Code.FAILURE]
    assert at.link.refusal.code == "Y1623"


def test_a_slow_client_goes_on_while_its_goal_is_planned():
    at = Link()
    at.goal()
    at.wait(PAUSE * 2.0)
    assert codes(at.say(point(4))) == [Code.SUCCESS]
    assert at.made() == []  # a plan of the earlier points isn't used
    at.wait(PAUSE)
    assert [len(one.points) for one in at.planned()] == [4, 5]
    assert at.planned()[0].number == at.planned()[1].number


def test_a_plan_of_a_goal_before_it_went_on_isnt_moved():
    """A plan of the goal's first points isn't executed after more points have arrived.

    Both plans have the number of the same goal, and the shorter one must not be taken for the longer.
    """
    at = Link()
    at.goal()
    at.wait(PAUSE)
    at.say(point(4), after=0.02)
    at.wait(PAUSE)
    first, second = at.planned()
    assert at.link.planned(first, None) == []
    assert kinds(at.link.planned(second, None)) == [Move]


def test_a_point_that_comes_in_motion_stops_the_robot():
    at = moving()
    found = at.say(point(4))
    assert Stop in kinds(found)
    assert Refused in kinds(found)
    assert codes(found) == [Code.FAILURE]
    assert "more than 50 ms" in at.link.refusal.what
    assert at.link.ended(1, Refusal("", "stopped")) == []
    assert at.link.refusal.code == "Y1623"


def test_a_stop_comes_before_its_answer():
    at = moving()
    found = at.say(point(-4))
    assert isinstance(found[0], Stop)
    assert isinstance(found[-1], Answer)
    assert codes(found) == [Code.SUCCESS]
    assert at.link.phase == "stopping"
    assert at.link.ended(1, Refusal("", "stopped")) == []
    assert at.link.refusal is None  # the stop was requested, so it isn't an error
    assert at.link.is_idle


def test_stops_are_taken_idle_receiving_and_planning():
    for prepare in (lambda at: None, lambda at: at.goal(), lambda at: (at.goal(), at.wait(PAUSE))):
        at = Link()
        prepare(at)
        found = at.say(point(-4), after=0.0)
        assert Stop in kinds(found)
        assert codes(found) == [Code.SUCCESS]
        assert at.link.is_idle
        assert at.made() == []
        at.wait(20.0)
        assert at.link.is_idle


def test_a_new_goal_in_motion_stops_and_waits_for_rest():
    at = moving()
    at.say(point(-4))
    at.actions.clear()
    at.goal()
    at.wait(1.0)
    assert at.planned() == []
    assert kinds(at.link.ended(1, Refusal("", "stopped"))) == [Plan]
    assert at.link.phase == "planning"


def test_a_new_goal_in_motion_stops_also_if_its_stop_got_lost():
    at = moving()
    found = at.say(point(0))
    assert kinds(found) == [Stop]
    assert at.link.phase == "stopping"
    at.wait(PAUSE)
    assert kinds(at.link.ended(1, None)) == [Plan]


def test_a_refused_plan_is_kept_until_the_next_goal():
    at = Link()
    at.goal()
    at.wait(PAUSE)
    refusal = Refusal("Y0616", "too quick", "STRETCH 2")
    assert kinds(at.made(refusal)) == [Refused]
    at.wait(100.0)
    assert at.link.refusal is refusal
    assert refusal.number == 616
    at.say(point(-4))
    assert at.link.refusal is refusal
    at.say(point(0))
    assert at.link.refusal is None


def test_a_refusal_without_a_code_has_a_number():
    assert Refusal("", "what").number == UNNAMED
    assert str(Refusal("", "what")) == "what"


def test_a_repeated_point_after_a_reconnect_is_the_same():
    at = Link()
    at.goal(3)
    at.drop()
    assert codes(at.say(point(2, value=0.02))) == [Code.SUCCESS]
    at.say(point(3))
    at.wait(PAUSE)
    (goal,) = at.planned()
    assert [one.sequence for one in goal.points] == [0, 1, 2, 3]


def test_the_first_point_again_after_a_reconnect_is_the_same():
    at = Link()
    at.say(point(0))
    at.drop()
    at.say(point(0))
    at.say(point(1))
    at.wait(PAUSE)
    (goal,) = at.planned()
    assert goal.number == 1
    assert len(goal.points) == 2


def test_the_same_goal_again_on_one_connection_is_another_goal():
    at = moving(count=1)
    assert kinds(at.say(point(0, value=0.0))) == [Stop]


def test_a_repeated_single_point_in_motion_goes_on():
    at = moving(count=1)
    at.drop()
    assert kinds(at.say(point(0, value=0.0))) == []
    assert at.link.phase == "moving"


def test_a_single_point_again_after_its_end_is_a_new_goal():
    at = moving(count=1)
    at.link.ended(1, None)
    at.drop()
    at.say(point(0, value=0.0))
    at.wait(PAUSE)
    assert [one.number for one in at.planned()] == [1, 2]


def test_a_goal_whose_client_stays_away_is_forgotten():
    at = Link()
    at.goal(3)
    at.actions += at.link.disconnected(at.now)
    at.wait(PATIENCE - 1.0)
    assert at.link.refusal is None
    at.wait(2.0)
    assert at.planned() == []
    assert at.link.refusal.code == "Y1623"


def test_a_client_that_goes_in_motion():
    at = moving()
    assert Hold not in kinds(at.link.disconnected(at.now))
    assert at.link.phase == "moving"
    at = moving(hold_on_disconnect=True)
    assert Hold in kinds(at.link.disconnected(at.now))
    at = Link(hold_on_disconnect=True)
    at.goal()
    at.wait(PAUSE)
    at.link.disconnected(at.now)
    assert at.made() == []


def test_other_messages_are_answered():
    at = Link()
    assert codes(at.say(Message(Comm.REQUEST, Ping()))) == [Code.SUCCESS]
    assert codes(at.say(Message(Comm.REQUEST, Other(2001, b"")))) == [Code.FAILURE]
    zeros = (0.0,) * 10
    assert codes(at.say(Message(Comm.REQUEST, FullPoint(0, 0, 15, 0.0, zeros, zeros, zeros)))) == [
        Code.FAILURE
    ]
    assert at.say(Message(Comm.REPLY, Ping(), Code.SUCCESS)) == []


def test_a_goal_without_end_is_refused():
    at = Link()
    for place in range(MOST_POINTS):
        at.link.heard(point(place), at.now)
    assert codes(at.say(point(MOST_POINTS))) == [Code.FAILURE]
    assert str(MOST_POINTS) in at.link.refusal.what


# random events in any order

DEEDS = st.one_of(
    st.tuples(st.just("next"), st.integers(1, 6)),
    st.tuples(st.sampled_from(["goal", "carried"]), st.integers(1, 6)),
    st.tuples(st.just("download"), st.integers(1, 5)),
    st.tuples(
        st.sampled_from(["stop", "drop", "repeat", "planned", "refused", "ended", "failed", "gap", "ping"]),
        st.just(0),
    ),
    st.tuples(st.just("wait"), st.sampled_from([0.01, 0.04, 0.06, 0.5, 11.0])),
)


class Model(Link):
    """A link and a robot that must get no impossible order.

    No motion may be requested during another one, and none after a stop.
    """

    def __init__(self):
        super().__init__()
        self.moves, self.plans, self.sent, self.value = None, [], None, 0.0
        self.stopped = False
        self.reached = set()

    def take(self, actions):
        for one in actions:
            match one:
                case Plan(goal=goal):
                    assert self.moves is None
                    assert len(goal.points) == len({id(p) for p in goal.points})
                    self.plans.append(goal)
                    self.reached.add("planned")
                case Move(number=number):
                    assert self.moves is None
                    self.moves, self.stopped = number, False
                    self.reached.add("moved")
                case Stop():
                    self.stopped = True

    def hear(self, message):
        begun = len(self.actions)
        answers = codes(self.say(message))
        self.take(self.actions[begun:])
        assert len(answers) == (message.comm is Comm.REQUEST)

    def do(self, deed, amount):
        link = self.link
        match deed:
            case "goal" | "next":
                first = 0 if deed == "goal" or self.sent is None else self.sent.body.sequence + 1
                for place in range(max(first, 0), max(first, 0) + amount):
                    self.value += 1e-3
                    self.sent = point(place, value=self.value)
                    self.hear(self.sent)
            case "carried":
                self.do("goal", amount)
                self.do("wait", 0.06)
                self.do("planned", 0)
            case "download":
                for sequence in (-1, *range(1, amount), -3):
                    self.hear(point(sequence, comm=Comm.TOPIC))
            case "stop":
                self.hear(point(-4))
                assert link.phase in ("idle", "stopping")
            case "drop":
                begun = len(self.actions)
                self.drop()
                self.take(self.actions[begun:])
            case "repeat" if self.sent is not None:
                self.drop()
                before = link._incoming and len(link._incoming.points)
                phase = link.phase
                self.hear(self.sent)
                if (
                    before
                    and phase == "receiving"
                    and link._last == self.sent.body
                    and self.sent.body.sequence > 0
                ):
                    assert link._incoming is None or len(link._incoming.points) <= before + 1
            case "gap":
                self.hear(point(999))
            case "ping":
                self.hear(Message(Comm.REQUEST, Ping()))
            case "planned" | "refused" if self.plans:
                self.take(
                    link.planned(self.plans.pop(0), None if deed == "planned" else Refusal("Y0616", "no"))
                )
            case "ended" | "failed" if self.moves is not None:
                number, self.moves = self.moves, None
                self.take(link.ended(number, None if deed == "ended" else Refusal("Y1605", "held")))
            case "wait":
                begun = len(self.actions)
                self.wait(amount)
                self.take(self.actions[begun:])
        assert (link.phase in ("moving", "stopping")) == (self.moves is not None)
        assert (link.phase == "stopping") <= self.stopped


@exercises(planned=0.3, moved=0.1)
@settings(max_examples=200, deadline=None)
@given(deeds=st.lists(DEEDS, max_size=25))
def test_nothing_moves_that_shouldnt(tally, deeds):
    at = Model()
    for deed, amount in deeds:
        at.do(deed, amount)
    for what in ("planned", "moved"):
        tally.count(what, reached=what in at.reached)
    # after any events, a stop and an end, a new goal moves the robot
    at.do("stop", 0)
    if at.moves is not None:
        at.do("failed", 0)
    at.plans.clear()
    at.drop()
    at.do("goal", 3)
    at.do("wait", 0.06)
    assert len(at.plans) == 1
    at.do("planned", 0)
    assert at.link.phase == "moving"


@exercises(dropped=0.3)
@settings(max_examples=100, deadline=None)
@given(
    count=st.integers(1, 30),
    drops=st.dictionaries(st.integers(0, 29), st.booleans(), max_size=5),
    delays=st.lists(st.floats(0.0, 0.045), min_size=30, max_size=30),
)
def test_reconnects_lose_no_point_and_add_none(tally, count, drops, delays):
    """The stock client repeats a point whose answer was lost, also if the point itself had arrived."""
    at = Link()
    drops = {place % count: arrived for place, arrived in drops.items()}
    sent = [point(place, value=0.01 * place) for place in range(count)]
    for place, message in enumerate(sent):
        if place in drops:
            if drops[place]:
                at.say(message, after=delays[place])
            at.drop()
        assert codes(at.say(message, after=delays[place])) == [Code.SUCCESS]
    at.wait(PAUSE)
    (goal,) = at.planned()
    assert list(goal.points) == [one.body for one in sent]
    tally.count("dropped", reached=bool(drops))
