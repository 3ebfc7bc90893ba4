"""The rules of FollowJointTrajectory as a state machine, with examples and with random events."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.ros.node.action import (
    ABORTED,
    CANCELED,
    GOAL_TOLERANCE_VIOLATED,
    INVALID_GOAL,
    INVALID_JOINTS,
    OLD_HEADER_TIMESTAMP,
    PATH_TOLERANCE_VIOLATED,
    SETTLING,
    SUCCEEDED,
    SUCCESSFUL,
    Accepted,
    End,
    Give,
    Move,
    Plan,
    Ready,
    Result,
    Stop,
    TrajectoryAction,
)
from yarclang.ros.node.trajectory import Goal, Joint, Moment, Point, Tolerance, track_of

JOINTS = (Joint("a", "deg"), Joint("b", "mm"))
START, END = (0.0, 0.0), (1.0, 0.2)


def goal(**more):
    return Goal(("b", "a"), (Point((0.2, 1.0), 2.0),), **more)


def ready(lead=0.0, course=()):
    return Ready(track_of(goal(), JOINTS, START), lead, course)


def at(*positions):
    return Moment(positions, (0.0,) * len(positions))


def of(kind, actions):
    return [one for one in actions if isinstance(one, kind)]


class Told:
    """An action, and the actions that it has requested so far."""

    def __init__(self, **more):
        self.action = TrajectoryAction(JOINTS, **more)
        self.all = []

    def goal(self, name="g", now=0.0, **more):
        rejected, actions = self.action.goal(name, goal(**more), now)
        self.all += actions
        assert rejected is None
        return actions

    def moves(self, name="g", made=None, **more):
        (plan,) = of(Plan, self.goal(name, **more))
        assert self.do("planned", plan.number, made or ready(), 0.0) == [Move(plan.number)]
        return plan.number

    def do(self, what, *arguments):
        actions = getattr(self.action, what)(*arguments)
        self.all += actions
        return actions

    @property
    def ends(self):
        return [(one.goal_id, one.outcome, one.result.error_code) for one in of(End, self.all)]


# the rules


def test_a_goal_is_planned_carried_out_and_succeeds_where_the_joints_are_at_its_last_point():
    told = Told()
    assert told.goal() == [Accepted("g"), Plan(1, "g", goal())]
    assert told.do("planned", 1, ready(), 0.1) == [Move(1)]
    assert told.do("ended", 1, None, 2.1) == []
    assert told.do("position", at(1.0, 0.19), None, 2.12) == []
    assert told.do("position", at(*END), None, 2.14) == [End("g", SUCCEEDED, Result(SUCCESSFUL))]
    assert told.action.is_idle


@pytest.mark.parametrize(
    ("names", "more", "code"),
    [
        (("a", "c"), {}, INVALID_JOINTS),
        (("a", "b"), {"starts_in": -3.0}, OLD_HEADER_TIMESTAMP),
        (("a", "b"), {"starts_in": math.nan}, INVALID_GOAL),
    ],
)
def test_a_goal_that_makes_no_sense_is_rejected_and_changes_nothing(names, more, code):
    told = Told()
    number = told.moves()
    rejected, actions = told.action.goal("other", Goal(names, (Point(END, 2.0),), **more), 1.0)
    assert rejected.error_code == code
    assert actions == []
    assert told.do("ended", number, None, 2.0) == []
    told.do("position", at(*END), None, 2.0)
    assert told.ends == [("g", SUCCEEDED, SUCCESSFUL)]


def test_an_id_is_taken_once_at_a_time():
    told = Told()
    told.goal("g")
    rejected, actions = told.action.goal("g", goal(), 0.0)
    assert "the id g is under way" in rejected.error_string
    assert actions == []


def test_a_goal_that_cannot_be_planned_is_aborted_with_the_reason():
    told = Told()
    told.goal()
    why = Result(INVALID_GOAL, "Y0616: too fast; STRETCH 1.5")
    assert told.do("planned", 1, why, 0.1) == [End("g", ABORTED, why)]


def test_a_cancelled_goal_that_is_planned_never_moves():
    told = Told()
    told.goal()
    assert of(End, told.do("cancel", "g"))[0].outcome == CANCELED
    assert told.do("planned", 1, ready(), 0.1) == []


def test_a_cancelled_goal_is_held_at_once_and_ends_when_the_robot_rests():
    told = Told()
    number = told.moves()
    assert told.do("cancel", "g") == [Stop()]
    assert told.do("cancel", "g") == []
    assert told.do("cancel", None) == []
    assert of(Give, told.do("position", at(0.1, 0.02), 0.5, 0.5))
    assert told.ends == []
    told.do("ended", number, Result(INVALID_GOAL, "stopped"), 1.0)
    assert told.ends == [("g", CANCELED, SUCCESSFUL)]


def test_without_hold_on_cancel_what_moves_goes_on():
    told = Told(hold_on_cancel=False)
    number = told.moves()
    assert told.do("cancel", "g") == []
    told.do("ended", number, None, 2.0)
    told.do("position", at(*END), None, 2.0)
    assert told.ends == [("g", SUCCEEDED, SUCCESSFUL)]


def test_another_id_cancels_nothing():
    told = Told()
    told.moves()
    assert told.do("cancel", "other") == []


def test_a_new_goal_preempts_the_one_that_moves_and_is_planned_when_the_robot_rests():
    told = Told()
    number = told.moves("old")
    assert told.goal("new") == [Accepted("new"), Stop()]
    assert told.goal("newer") == [
        Accepted("newer"),
        End("new", CANCELED, Result(0, "preempted: another goal has come")),
    ]
    actions = told.do("ended", number, Result(INVALID_GOAL, "stopped"), 1.0)
    assert [type(one) for one in actions] == [End, Plan]
    assert actions[1].goal_id == "newer"
    assert told.ends[-1] == ("old", CANCELED, SUCCESSFUL)


def test_a_new_goal_takes_the_place_of_one_that_is_planned():
    told = Told()
    told.goal("old")
    actions = told.goal("new")
    assert [type(one) for one in actions] == [Accepted, End, Plan]
    assert told.do("planned", 1, ready(), 0.1) == []
    assert told.do("planned", 2, ready(), 0.1) == [Move(2)]


def test_a_goal_with_a_stamp_begins_then():
    told = Told()
    told.goal(starts_in=5.0)
    assert told.do("planned", 1, ready(), 1.0) == []
    assert told.action.due == 5.0
    assert told.do("passed", 4.9) == []
    assert told.do("passed", 5.0) == [Move(1)]


def test_a_goal_that_begins_later_than_its_stamp_says_so():
    told = Told()
    told.goal(starts_in=1.0)
    assert told.do("planned", 1, ready(), 3.0) == [Move(1)]
    told.do("ended", 1, None, 5.0)
    (end,) = told.do("position", at(*END), None, 5.0)
    assert "2.00 s later" in end.result.error_string


def test_a_robot_that_stands_there_already_succeeds_without_a_motion():
    told = Told()
    told.goal()
    assert told.do("planned", 1, Ready(None), 0.1) == []
    told.do("position", at(*END), None, 0.2)
    assert of(Move, told.all) == []
    assert told.ends == [("g", SUCCEEDED, SUCCESSFUL)]


def test_feedback_is_in_the_order_of_the_goal_and_its_error_is_desired_less_actual():
    told = Told()
    told.moves(made=ready(lead=1.0, course=((0.0, (0.5, 0.1)), (1.0, START))))
    (give,) = told.do("position", at(0.3, 0.0), 0.5, 0.5)
    lead = give.feedback
    assert lead.joint_names == ("b", "a")
    assert lead.desired.positions == pytest.approx((0.05, 0.25))
    assert lead.desired.time == -0.5
    assert lead.error.positions == pytest.approx((0.05, -0.05))
    (give,) = told.do("position", at(0.5, 0.1), 2.0, 2.0)
    assert give.feedback.desired.positions == pytest.approx((0.1, 0.5), abs=1e-3)
    assert give.feedback.actual.positions == (0.1, 0.5)
    assert give.feedback.actual.time == give.feedback.desired.time == pytest.approx(1.0, abs=0.01)


def test_positions_of_another_motion_are_no_feedback():
    told = Told()
    told.moves()
    assert told.do("position", at(*START), None, 0.1) == []


def test_a_joint_that_leaves_its_path_is_held():
    told = Told()
    number = told.moves(path_tolerance=(Tolerance("a", 0.05),))
    assert of(Stop, told.do("position", at(0.5, 0.1), 1.0, 1.0)) == []
    assert of(Stop, told.do("position", at(0.5, 0.1), 1.3, 1.3)) == [Stop()]
    assert of(Stop, told.do("position", at(0.5, 0.1), 1.35, 1.35)) == []
    told.do("ended", number, Result(INVALID_GOAL, "stopped"), 1.5)
    assert told.ends == [("g", ABORTED, PATH_TOLERANCE_VIOLATED)]
    assert "a is 0." in of(End, told.all)[0].result.error_string


def test_a_hold_breaks_no_tolerance():
    told = Told()
    told.moves(path_tolerance=(Tolerance("a", 0.05),))
    for tick in range(1000):
        assert of(Stop, told.do("position", at(0.5, 0.1), 1.0, 1.0 + 0.02 * tick)) == []


@pytest.mark.parametrize("tolerance", [0.0, -1.0])
def test_a_path_tolerance_of_the_default_or_none_is_none(tolerance):
    told = Told()
    told.moves(path_tolerance=(Tolerance("a", tolerance),))
    assert of(Stop, told.do("position", at(9.0, 9.0), 1.0, 1.0)) == []


@pytest.mark.parametrize(
    ("more", "due"),
    [({}, SETTLING), ({"goal_time_tolerance": 0.3}, 0.3), ({"goal_time_tolerance": -1.0}, None)],
)
def test_joints_that_are_not_there_in_time_abort_the_goal(more, due):
    told = Told()
    number = told.moves(**more)
    told.do("ended", number, None, 2.0)
    assert told.action.due == (None if due is None else 2.0 + due)
    assert told.do("position", at(0.9, 0.2), None, 2.0) == []
    if due is not None:
        told.do("position", at(0.9, 0.2), None, 2.0 + due)
        assert told.ends == [("g", ABORTED, GOAL_TOLERANCE_VIOLATED)]
        assert "a is 0.1 off the last point" in of(End, told.all)[0].result.error_string


def test_a_goal_whose_positions_are_not_heard_any_more_ends_in_time():
    told = Told()
    told.do("ended", told.moves(), None, 2.0)
    told.do("passed", 2.0 + SETTLING)
    assert told.ends == [("g", ABORTED, GOAL_TOLERANCE_VIOLATED)]


def test_a_goal_tolerance_of_none_is_any_place():
    told = Told()
    tolerances = (Tolerance("a", -1.0), Tolerance("b", 1.0))
    told.do("ended", told.moves(goal_tolerance=tolerances), None, 2.0)
    told.do("position", at(77.0, 0.0), None, 2.0)
    assert told.ends == [("g", SUCCEEDED, SUCCESSFUL)]


def test_a_stop_from_elsewhere_aborts_what_moves_and_what_waits():
    told = Told()
    number = told.moves("old")
    told.goal("new")
    told.do("stopped", "a stop was ordered")
    assert told.ends == [("new", ABORTED, INVALID_GOAL)]
    assert told.do("ended", number, Result(INVALID_GOAL, "stopped"), 1.0) == [
        End("old", CANCELED, Result(SUCCESSFUL, "preempted: another goal has come"))
    ]
    told.goal("planned")
    told.do("stopped", "a stop was ordered")
    assert told.ends[-1] == ("planned", ABORTED, INVALID_GOAL)


def test_who_leaves_holds_what_moves():
    told = Told()
    number = told.moves()
    assert told.do("leave", "ended") == [Stop()]
    told.do("ended", number, Result(INVALID_GOAL, "stopped"), 1.0)
    assert told.ends == [("g", ABORTED, INVALID_GOAL)]


# random events in any order

EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("goal"), st.sampled_from([0.0, 0.0, 0.5, -0.5]), st.sampled_from([0.0, 0.01])),
        st.tuples(st.just("cancel"), st.integers(-1, 4)),
        st.tuples(st.just("planned"), st.integers(0, 3), st.sampled_from(["ready", "there", "failed"])),
        st.tuples(st.just("ended"), st.integers(0, 3), st.booleans()),
        st.tuples(
            st.just("position"),
            st.sampled_from([START, END, (9.0, 9.0)]),
            st.one_of(st.none(), st.floats(0.0, 2.0)),
        ),
        st.tuples(st.just("passed"), st.floats(0.0, 3.0)),
        st.tuples(st.just("lost")),
        st.tuples(st.just("stopped")),
        st.tuples(st.just("leave")),
    ),
    max_size=60,
)


class Played:
    """An action with random events in any order, including impossible ones."""

    def __init__(self, hold_on_cancel):
        self.action = TrajectoryAction(JOINTS, hold_on_cancel)
        self.now = 0.0
        self.accepted, self.ended, self.moved, self.stopped = [], [], [], 0
        self.cancelled = False
        """True if everything was cancelled, and no goal was sent since."""

    def happens(self, event):
        kind, *more = event
        self.now += 0.01
        if kind == "goal":
            tolerances = (Tolerance("a", more[1]),)
            rejected, actions = self.action.goal(
                f"g{len(self.accepted)}", goal(starts_in=more[0], path_tolerance=tolerances), self.now
            )
            assert rejected is None
            self.cancelled = False
        elif kind == "cancel":
            name = None if more[0] < 0 else f"g{len(self.accepted) - more[0]}"
            actions = self.action.cancel(name)
            self.cancelled = self.cancelled or name is None
        elif kind == "planned":
            made = {"ready": ready(), "there": Ready(None), "failed": Result(INVALID_GOAL, "no")}[more[1]]
            actions = self.action.planned(len(self.accepted) - more[0], made, self.now)
        elif kind == "ended":
            failed = None if more[1] else Result(INVALID_GOAL, "stopped")
            actions = self.action.ended(len(self.accepted) - more[0], failed, self.now)
        elif kind == "position":
            actions = self.action.position(at(*more[0]), more[1], self.now)
        elif kind == "passed":
            self.now += more[0]
            actions = self.action.passed(self.now)
        else:
            actions = getattr(self.action, kind)(*(["reason"] if kind != "passed" else []))
        self._look(actions)

    def _look(self, actions):
        for one in actions:
            if isinstance(one, Accepted):
                self.accepted.append(one.goal_id)
            elif isinstance(one, End):
                assert one.goal_id in self.accepted
                assert one.goal_id not in self.ended
                self.ended.append(one.goal_id)
            elif isinstance(one, Move):
                assert one.number not in self.moved
                assert f"g{one.number - 1}" not in self.ended
                self.moved.append(one.number)
            elif isinstance(one, Give):
                assert one.goal_id not in self.ended
            elif isinstance(one, Stop):
                self.stopped += 1
                assert self.stopped <= len(self.moved)
            if self.cancelled:
                assert isinstance(one, Stop | End | Give)

    def finish(self):
        self._look(self.action.cancel(None))
        for number in range(len(self.accepted) + 1):
            self._look(self.action.planned(number, ready(), self.now))
            self._look(self.action.ended(number, Result(INVALID_GOAL, "stopped"), self.now))


@settings(max_examples=400)
@given(EVENTS, st.booleans())
def test_each_accepted_goal_ends_exactly_once_whatever_happens(events, hold_on_cancel):
    played = Played(hold_on_cancel)
    for event in events:
        if event[0] == "cancel" and event[1] < 0 and not hold_on_cancel:
            continue
        played.happens(event)
    played.finish()
    assert sorted(played.ended) == sorted(played.accepted)
    assert played.action.is_idle


@given(EVENTS, EVENTS)
def test_after_everything_was_cancelled_nothing_but_a_hold_is_ordered(before, after):
    played = Played(True)
    for event in before:
        played.happens(event)
    played.happens(("cancel", -1))
    assert played.cancelled
    for event in after:
        if event[0] != "goal":
            played.happens(event)
    assert played.cancelled
