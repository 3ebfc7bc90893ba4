"""The driver of the ROS nodes with a real `yarc serve` and its simulator."""

import contextlib
import math
import os
import signal
import tempfile
import threading
import time
from pathlib import Path

import pytest
from ros.process import yarc

from tests.robot.made_arms import made, urdf_of
from yarclang.client import Gone, Robot
from yarclang.ros.node import driver as driver_module
from yarclang.ros.node.action import (
    GOAL_TOLERANCE_VIOLATED,
    INVALID_GOAL,
    INVALID_JOINTS,
    PATH_TOLERANCE_VIOLATED,
    SUCCESSFUL,
)
from yarclang.ros.node.driver import Driver
from yarclang.ros.node.trajectory import Goal, Point, Tolerance

LONG = 60.0
"""Longest time to wait for an event, which usually comes within seconds [s]."""


class Shell:
    """A ROS side that records its calls."""

    def __init__(self):
        self.calls, self.endings, self.feedbacks, self.says, self.statuses = [], {}, {}, [], []
        self.state, self.changes = None, 0
        self.news = threading.Condition()

    def accepted(self, goal_id):
        self._note("accepted", goal_id)

    def feedback(self, goal_id, feedback):
        with self.news:
            assert goal_id not in self.endings
            self.feedbacks.setdefault(goal_id, []).append(feedback)
            self.news.notify_all()

    def ended(self, goal_id, outcome, result):
        with self.news:
            assert goal_id not in self.endings
            self.endings[goal_id] = outcome, result
        self._note("ended", goal_id)

    def joint_state(self, state):
        with self.news:
            self.state = state
            self.news.notify_all()

    def status(self, status):
        with self.news:
            self.statuses.append(status)
            self.news.notify_all()

    def changed(self):
        with self.news:
            self.changes += 1

    def say(self, level, text):
        with self.news:
            self.says.append((level, text))
            self.news.notify_all()

    def _note(self, what, goal_id):
        with self.news:
            self.calls.append((what, goal_id))
            self.news.notify_all()

    def until(self, true, within=LONG):
        with self.news:
            assert self.news.wait_for(true, within), (self.calls, self.endings, self.says, self.statuses[-3:])

    def end(self, goal_id):
        """Return the end of a goal: outcome, code, text."""
        self.until(lambda: goal_id in self.endings)
        outcome, result = self.endings[goal_id]
        return outcome, result.error_code, result.error_string

    def moving(self, goal_id, share=0.02):
        """Wait until a goal is moving the robot."""
        self.until(lambda: any(one.desired.time > share for one in self.feedbacks.get(goal_id, ())))

    @property
    def positions(self):
        self.until(lambda: self.state is not None)
        return self.state.positions

    def rests(self):
        self.until(lambda: self.statuses[-1].in_motion == 0)


@contextlib.contextmanager
def served(folder, robot="INDUSTRIAL6", *more):
    with yarc("serve", "--robot", robot, "--no-log", *more, folder=folder) as told:
        told.path = told.until(r"is served: (\S+\.sock)")[1]
        yield told


@contextlib.contextmanager
def driven(path, shell=None, **more):
    shell = shell or Shell()
    driver = Driver(path, shell, **more)
    driver.start()
    try:
        yield driver, shell
    finally:
        driver.close()


@pytest.fixture(scope="module")
def folder():
    with tempfile.TemporaryDirectory(prefix="node-") as name:
        yield Path(name)


@pytest.fixture(scope="module")
def path(folder):
    """Return the path of the socket of a robot that many tests share."""
    with served(folder) as told:
        yield told.path


@pytest.fixture
def node(path):
    with driven(path) as both:
        yield both


def away(shell, by=0.3):
    """Return joint positions that differ from the present ones by `by`, towards zero and away from limits."""
    return tuple(q - math.copysign(by, q) for q in shell.positions)


def goal_to(driver, positions, seconds=2.0, **more):
    return Goal(driver.joint_names, (Point(tuple(positions), seconds),), **more)


def owner_of(path):
    with Robot(path, name=None) as robot:
        return robot.status()["owner"]


def nobody_owns(path):
    """Wait until nobody owns the robot."""
    until = time.monotonic() + LONG
    while owner_of(path) is not None:
        assert time.monotonic() < until
        time.sleep(0.05)


# goals that succeed


def test_a_goal_in_another_order_of_its_joints_ends_at_its_last_point(node, path):
    driver, shell = node
    start = shell.positions
    end = away(shell)
    middle = tuple((a + b) / 2.0 for a, b in zip(start, end, strict=True))
    points = [Point(tuple(reversed(one)), at) for one, at in ((start, 0.0), (middle, 1.0), (end, 2.0))]
    tolerances = tuple(Tolerance(name, 0.02) for name in driver.joint_names)
    assert driver.goal("g", Goal(driver.joint_names[::-1], tuple(points), path_tolerance=tolerances)) is None
    shell.moving("g")
    ghost = driver.ghost()
    assert len(ghost) > 100
    assert ghost[-1][1] == pytest.approx(end, abs=1e-3)
    assert owner_of(path) == "ros"
    assert shell.end("g") == ("succeeded", SUCCESSFUL, "")
    assert shell.positions == pytest.approx(end, abs=1e-3)
    given = shell.feedbacks["g"]
    assert len(given) > 20
    assert given[0].joint_names == driver.joint_names[::-1]
    assert max(abs(error) for one in given for error in one.error.positions) < 0.005
    assert given[-1].desired.time == pytest.approx(2.0, abs=0.2)
    assert max(abs(v) for one in given for v in one.actual.velocities) > 0.1
    assert driver.ghost() == []
    assert shell.changes >= 3  # connected, planned, ended
    assert shell.calls[-2:] == [("accepted", "g"), ("ended", "g")]
    nobody_owns(path)


def test_the_robot_is_led_to_a_first_point_where_it_does_not_stand(node):
    driver, shell = node
    first = away(shell, 0.2)
    end = tuple(q + 0.1 for q in first)
    driver.goal("g", Goal(driver.joint_names, (Point(first, 0.0), Point(end, 1.0))))
    assert shell.end("g")[:2] == ("succeeded", SUCCESSFUL)
    times = [one.desired.time for one in shell.feedbacks["g"]]
    assert min(times) < -0.1
    assert max(times) > 0.8
    assert shell.positions == pytest.approx(end, abs=1e-3)
    assert max(abs(error) for one in shell.feedbacks["g"] for error in one.error.positions) < 0.05


def test_velocities_and_accelerations_are_kept(node):
    driver, shell = node
    start = shell.positions
    end = away(shell, 0.2)
    size = len(start)
    rest = (0.0,) * size
    rate = tuple((b - a) / 2.0 for a, b in zip(start, end, strict=True))
    middle = tuple((a + b) / 2.0 for a, b in zip(start, end, strict=True))
    points = (Point(start, 0.0, rest, rest), Point(middle, 2.0, rate, rest), Point(end, 4.0, rest, rest))
    driver.goal("g", Goal(driver.joint_names, points))
    assert shell.end("g") == ("succeeded", SUCCESSFUL, "")
    assert max(abs(error) for one in shell.feedbacks["g"] for error in one.error.positions) < 0.005


def test_a_robot_that_stands_there_already_succeeds_at_once(node):
    driver, shell = node
    driver.goal("g", goal_to(driver, shell.positions))
    assert shell.end("g") == ("succeeded", SUCCESSFUL, "the robot was there already")


def test_a_goal_with_a_stamp_begins_then(node):
    driver, shell = node
    begun = time.monotonic()
    driver.goal("g", goal_to(driver, away(shell, 0.1), 1.0, starts_in=4.0))
    shell.moving("g")
    assert time.monotonic() - begun > 4.0
    assert shell.end("g")[:2] == ("succeeded", SUCCESSFUL)


def test_a_joint_that_slides_goes_to_its_place():
    with tempfile.TemporaryDirectory(prefix="node-") as name:
        folder = Path(name)
        slide = ("prismatic", (0, 0, 0.3), (0, 0, 0), (0, 0, 1), (-0.3, 0.3))
        turn = ("revolute", (0.4, 0, 0.1), (0, 0, 0), (0, 0, 1), (-2.0, 2.0))
        (folder / "arm.urdf").write_text(urdf_of([turn, slide]))
        made(folder / "arm.urdf", folder / "arm")
        with served(folder, str(folder / "arm")) as told, driven(told.path) as (driver, shell):
            assert [one["unit"] for one in _status(told.path)["joints"]] == ["deg", "mm"]
            assert shell.positions == (0.0, 0.0)
            # far less than an error of units, and more than a busy computer is behind
            tolerances = tuple(Tolerance(one, 0.01) for one in driver.joint_names)
            driver.goal("g", goal_to(driver, (0.2, 0.05), path_tolerance=tolerances))
            assert shell.end("g") == ("succeeded", SUCCESSFUL, "")
            assert shell.positions == pytest.approx((0.2, 0.05), abs=1e-4)
            driver.goal("far", goal_to(driver, (0.2, 0.4)))
            assert shell.end("far")[2].startswith("Y0502")


def _status(path):
    with Robot(path, name=None) as robot:
        return robot.status()


def test_goals_that_come_as_the_one_before_ends_are_carried_out(path):
    """Each goal is sent when the one before it ends, while the robot is being released."""

    class Eager(Shell):
        def ended(self, goal_id, outcome, result):
            super().ended(goal_id, outcome, result)
            if (number := int(goal_id) + 1) <= 12:
                driver.goal(str(number), goal_to(driver, away(self, 0.01), 0.5))

    with driven(path, Eager()) as (driver, shell):
        driver.goal("1", goal_to(driver, away(shell, 0.01), 0.5))
        for number in range(1, 13):
            assert shell.end(str(number)) == ("succeeded", SUCCESSFUL, "")


# goals that fail


def test_a_goal_that_makes_no_sense_is_rejected_at_once(node):
    driver, shell = node
    rejected = driver.goal("g", Goal(("nobody",), (Point((0.0,), 1.0),)))
    assert rejected.error_code == INVALID_JOINTS
    time.sleep(0.2)
    assert shell.calls == []


@pytest.mark.parametrize(
    ("by", "seconds", "code", "text"),
    [(0.5, 0.1, "Y0616", "STRETCH"), (9.0, 60.0, "Y0502", "limit")],
)
def test_a_goal_that_cannot_be_carried_out_is_aborted_with_the_finding(node, path, by, seconds, code, text):
    driver, shell = node
    before = shell.positions
    driver.goal("g", goal_to(driver, (q + by for q in before), seconds))
    outcome, number, why = shell.end("g")
    assert (outcome, number) == ("aborted", INVALID_GOAL)
    assert why.startswith(f"{code}: ")
    assert text in why
    shell.until(lambda: (shell.statuses[-1].error_code, shell.statuses[-1].in_error) == (int(code[1:]), 1))
    assert shell.positions == before
    nobody_owns(path)
    driver.goal("next", goal_to(driver, before))
    assert shell.end("next")[0] == "succeeded"
    shell.until(lambda: shell.statuses[-1].in_error == 0)


def test_a_goal_that_does_not_fit_into_a_line_is_refused(node):
    driver, shell = node
    row = tuple(0.1234567891 for _ in driver.joint_names)
    rest = (0.0,) * len(row)
    rate = tuple(-12.345678 for _ in row)
    points = (*(Point(row, 0.123 + 0.1 * n, rate, rate) for n in range(19_900)), Point(row, 1e5, rest, rest))
    driver.goal("g", Goal(driver.joint_names, points))
    outcome, number, why = shell.end("g")
    assert (outcome, number) == ("aborted", INVALID_GOAL)
    assert "MiB are taken" in why


def test_a_goal_while_somebody_else_owns_the_robot_is_aborted(node, path):
    driver, shell = node
    with Robot(path, name="somebody") as other:
        other.own()
        shell.until(lambda: (shell.statuses[-1].mode, shell.statuses[-1].motion_possible) == (1, 0))
        driver.goal("g", goal_to(driver, away(shell)))
        outcome, number, why = shell.end("g")
        assert (outcome, number) == ("aborted", INVALID_GOAL)
        assert "Y1611" in why
        assert "somebody" in why
    shell.until(lambda: shell.statuses[-1].mode == 2)
    driver.goal("then", goal_to(driver, away(shell, 0.05)))
    assert shell.end("then")[0] == "succeeded"


def test_a_joint_that_leaves_its_path_holds_the_robot(node):
    driver, shell = node
    # no robot is that exact: the text follows the timetable's path within 0.1 mrad
    tolerances = tuple(Tolerance(name, 1e-9) for name in driver.joint_names)
    driver.goal("g", goal_to(driver, away(shell), path_tolerance=tolerances))
    outcome, number, why = shell.end("g")
    assert (outcome, number) == ("aborted", PATH_TOLERANCE_VIOLATED)
    assert "path_tolerance allows 1e-09" in why
    shell.rests()


def test_joints_that_are_not_at_the_last_point_abort_the_goal(node):
    driver, shell = node
    end = tuple(q + 5e-7 for q in away(shell))
    tolerances = tuple(Tolerance(name, 1e-12) for name in driver.joint_names)
    driver.goal("g", goal_to(driver, end, goal_tolerance=tolerances, goal_time_tolerance=0.2))
    assert shell.end("g")[:2] == ("aborted", GOAL_TOLERANCE_VIOLATED)


# events during a goal


def test_a_new_goal_preempts_the_one_that_moves(node):
    driver, shell = node
    start = shell.positions
    driver.goal("old", goal_to(driver, away(shell), 6.0))
    shell.moving("old", 1.0)
    driver.goal("new", goal_to(driver, start))
    assert shell.end("new") == ("succeeded", SUCCESSFUL, "")
    outcome, _, why = shell.end("old")
    assert outcome == "canceled"
    assert "preempted" in why
    assert shell.calls.index(("ended", "old")) < shell.calls.index(("ended", "new"))
    assert shell.positions == pytest.approx(start, abs=1e-3)


def test_a_cancelled_goal_is_held_on_its_path(node, path):
    driver, shell = node
    start, end = shell.positions, away(shell)
    driver.goal("g", goal_to(driver, end, 6.0))
    shell.moving("g", 2.0)
    asked = time.monotonic()
    driver.cancel("g")
    assert shell.end("g") == ("canceled", SUCCESSFUL, "canceled")
    assert time.monotonic() - asked < 2.0
    shell.rests()
    rests = shell.positions
    shares = [(c - a) / (b - a) for a, b, c in zip(start, end, rests, strict=True)]
    assert 0.1 < min(shares) <= max(shares) < 0.9
    assert max(shares) - min(shares) < 0.01
    time.sleep(0.5)
    assert shell.positions == pytest.approx(rests, abs=1e-4)
    nobody_owns(path)


def test_a_goal_that_is_cancelled_while_it_is_planned_never_moves(node):
    driver, shell = node
    before = shell.positions
    wave = [Point(tuple(q + 0.05 * math.sin(0.3 * n) for q in before), 0.5 + 0.2 * n) for n in range(2000)]
    driver.goal("g", Goal(driver.joint_names, tuple(wave)))
    time.sleep(0.1)
    driver.cancel(None)
    assert shell.end("g")[0] == "canceled"
    driver.goal("there", goal_to(driver, before))  # this goal is planned after the cancelled one
    assert shell.end("there")[0] == "succeeded"
    assert shell.feedbacks == {}
    assert shell.positions == before


def test_a_goal_that_is_cancelled_as_it_begins_rests_soon(node):
    driver, shell = node
    for number in range(5):
        driver.goal(f"g{number}", goal_to(driver, away(shell, 0.1), 4.0))
        shell.until(lambda: any("was planned" in text and f"g{number}:" in text for _, text in shell.says))  # noqa: B023
        driver.cancel(None)
        assert shell.end(f"g{number}")[0] == "canceled"
    shell.rests()


def test_a_hold_from_elsewhere_keeps_the_goal(node, path):
    driver, shell = node
    tolerances = tuple(Tolerance(name, 0.01) for name in driver.joint_names)
    driver.goal("g", goal_to(driver, away(shell), 3.0, path_tolerance=tolerances))
    shell.moving("g", 1.0)
    with Robot(path, name=None) as other:
        other.ask("hold")
        shell.rests()
        shell.until(lambda: "hold" in shell.statuses[-1].why)
        time.sleep(0.5)
        assert "g" not in shell.endings
        other.ask("resume")
    assert shell.end("g") == ("succeeded", SUCCESSFUL, "")


def test_a_hold_and_another_pace_are_taken_here_as_well(node):
    driver, shell = node
    assert driver.override(0.5)[0] is False
    assert driver.override(math.nan)[0] is False
    assert driver.override(50.0)[0] is True
    tolerances = tuple(Tolerance(name, 0.01) for name in driver.joint_names)
    begun = time.monotonic()
    driver.goal("g", goal_to(driver, away(shell), 2.0, path_tolerance=tolerances))
    shell.moving("g", 0.5)
    assert driver.hold()[0]
    shell.rests()
    assert driver.resume()[0]
    assert shell.end("g") == ("succeeded", SUCCESSFUL, "")
    assert time.monotonic() - begun > 4.0
    driver.override(100.0)
    driver.goal("h", goal_to(driver, away(shell, 0.05), 1.0))
    shell.moving("h", 0.1)
    assert driver.override(100.0)[0]
    assert shell.end("h")[0] == "succeeded"


@pytest.mark.parametrize("here", [True, False])
def test_a_stop_aborts_the_goal_with_the_reason(node, path, here):
    driver, shell = node
    driver.goal("g", goal_to(driver, away(shell), 6.0))
    shell.moving("g", 1.0)
    if here:
        assert driver.stop()[0]
    else:
        with Robot(path, name=None) as other:
            other.ask("stop")
    outcome, number, why = shell.end("g")
    assert (outcome, number) == ("aborted", INVALID_GOAL)
    assert "stop" in why
    shell.rests()


def test_a_stop_is_for_a_goal_that_is_planned_as_well(node):
    driver, shell = node
    before = shell.positions
    driver.goal("g", goal_to(driver, away(shell)))
    driver.stop()
    assert shell.end("g") == ("aborted", INVALID_GOAL, "a stop was ordered")
    time.sleep(1.0)
    assert shell.positions == before


def test_a_stop_from_elsewhere_is_for_a_goal_that_is_planned_as_well(node, path):
    driver, shell = node
    before = shell.positions
    wave = [Point(tuple(q + 0.05 * math.sin(0.3 * n) for q in before), 0.5 + 0.2 * n) for n in range(2000)]
    driver.goal("g", Goal(driver.joint_names, tuple(wave)))
    while owner_of(path) is None:
        time.sleep(0.01)
    with Robot(path, name=None) as other:
        other.ask("stop")
    assert not any("was planned" in text for _, text in shell.says)
    outcome, _, why = shell.end("g")
    assert outcome == "aborted"
    assert "stopped before it began; nothing moved" in why
    assert shell.feedbacks == {}
    assert shell.positions == before
    driver.goal("then", goal_to(driver, away(shell, 0.05)))
    assert shell.end("then")[0] == "succeeded"


# errors


def test_nobody_there_is_told(folder):
    with pytest.raises(Gone, match="yarc serve"):
        Driver(str(folder / "nobody-1.sock"), Shell()).start()
    assert Driver(None, Shell()).goal("g", Goal((), ())).error_code == INVALID_GOAL


def test_a_process_that_is_killed_aborts_the_goal_and_a_new_one_is_found():
    with tempfile.TemporaryDirectory(prefix="node-") as name:
        folder = Path(name)
        with served(folder) as told, driven(told.path) as (driver, shell):
            driver.goal("g", goal_to(driver, away(shell), 6.0))
            shell.moving("g", 1.0)
            told.process.send_signal(signal.SIGKILL)
            outcome, number, why = shell.end("g")
            assert (outcome, number) == ("aborted", INVALID_GOAL)
            assert "has ended: look at the robot" in why
            told.process.wait(LONG)
            shell.until(lambda: (shell.statuses[-1].in_error, shell.statuses[-1].motion_possible) == (1, 0))
            assert "no robot is there" in driver.goal("h", goal_to(driver, (0.1,) * 6)).error_string
            assert driver.hold()[0] is False
            with pytest.raises(Gone):
                driver.model()
            with served(folder):
                shell.until(lambda: any("is served again" in text for _, text in shell.says))
                shell.until(lambda: shell.statuses[-1].in_motion == 0)
                assert driver.goal("i", goal_to(driver, (0.1,) * 6)) is None
                assert shell.end("i")[0] == "succeeded"
                assert shell.positions == pytest.approx((0.1,) * 6, abs=1e-3)


def test_a_controller_that_is_lost_aborts_the_goal_and_nothing_is_told_as_known():
    with tempfile.TemporaryDirectory(prefix="node-") as name:
        folder = Path(name)
        with yarc("sim", "--robot", "INDUSTRIAL6", "--port", "0", folder=folder) as simulator:
            to = f"tcp://{simulator.until(r'listens on ([0-9.:]+)')[1]}"
            with served(folder, "INDUSTRIAL6", "--to", to) as told, driven(told.path) as (driver, shell):
                driver.goal("g", goal_to(driver, away(shell), 6.0))
                shell.moving("g", 1.0)
                simulator.process.kill()
                outcome, _, why = shell.end("g")
                assert outcome == "aborted"
                assert why.startswith("Y1606: ")
                shell.until(lambda: shell.statuses[-1].error_code == 1606)
                shell.until(lambda: shell.statuses[-1].in_motion == shell.statuses[-1].drives_powered == -1)
                assert shell.statuses[-1].motion_possible == 0
                assert driver.goal("h", goal_to(driver, shell.positions)) is None
                assert shell.end("h")[0] == "aborted"
                assert "Y1606" in shell.end("h")[2]


def test_a_process_that_hangs_aborts_the_goal(monkeypatch):
    monkeypatch.setattr(driver_module, "_HANGS", 2.0)
    with (
        tempfile.TemporaryDirectory(prefix="node-") as name,
        served(Path(name)) as told,
        driven(told.path) as (driver, shell),
    ):
        driver.goal("g", goal_to(driver, away(shell), 6.0))
        shell.moving("g", 1.0)
        os.kill(told.process.pid, signal.SIGSTOP)
        try:
            outcome, _, why = shell.end("g")
        finally:
            os.kill(told.process.pid, signal.SIGCONT)
        assert outcome == "aborted"
        assert "doesn't answer within 2 s" in why
        shell.until(lambda: any("is served again" in text for _, text in shell.says))
        nobody_owns(told.path)


def test_a_driver_that_is_closed_lets_the_robot_rest(path):
    with driven(path) as (driver, shell):
        driver.goal("g", goal_to(driver, away(shell), 6.0))
        shell.moving("g", 1.0)
        driver.close()
        assert shell.end("g")[0] == "aborted"
        assert "was ended" in shell.end("g")[2]
        assert driver.goal("h", goal_to(driver, (0.0,) * 6)).error_code == INVALID_GOAL
    assert [one.name for one in threading.enumerate() if one.name.startswith("yarc ")] == []
    with driven(path) as (driver, shell):
        shell.rests()


def test_a_shell_that_fails_or_blocks_keeps_no_goal_from_its_end(path):
    class Slow(Shell):
        def feedback(self, goal_id, feedback):
            time.sleep(0.1)
            super().feedback(goal_id, feedback)
            raise RuntimeError("a fault of the ROS side")

        def accepted(self, goal_id):
            super().accepted(goal_id)
            raise RuntimeError("a fault of the ROS side")

    with driven(path, Slow()) as (driver, shell):
        driver.goal("g", goal_to(driver, away(shell), 2.0))
        assert shell.end("g")[:2] == ("succeeded", SUCCESSFUL)


def test_goals_and_cancels_from_many_threads_end_once_each(node):
    driver, shell = node
    here = shell.positions
    taken = []

    def play(own):
        for number in range(12):
            name = f"{own}-{number}"
            if driver.goal(name, goal_to(driver, (q + 0.02 * (number % 3) for q in here), 1.0)) is None:
                taken.append(name)
            time.sleep(0.05 * own)
            if number % 3 == own % 3:
                driver.cancel(name)

    threads = [threading.Thread(target=play, args=(own,)) for own in range(4)]
    for one in threads:
        one.start()
    for one in threads:
        one.join(LONG)
    for name in taken:
        shell.end(name)
    assert len(taken) == 48
    assert sorted(shell.endings) == sorted(taken)
    assert {outcome for outcome, _ in shell.endings.values()} <= {"succeeded", "canceled"}
