"""The reports of the state link, from those of the coordinator."""

import numpy as np
import pytest

from yarclang.coordinator.describing import joints_by_name
from yarclang.coordinator.messages import events, replies
from yarclang.robot.description import load_robot
from yarclang.ros.refusal import Refusal
from yarclang.ros.simple_message import Comm
from yarclang.ros.state import STANDS, Feedback
from yarclang.runtime.state import State

ROBOT = load_robot("INDUSTRIAL6").value


class Told:
    """A feedback whose coordinator reports what a test says."""

    def __init__(self, state=State.STOP, owner=None):
        joints = [replies.Joint(name=name, position=None, unit="deg") for name in ROBOT.joint_names]
        status = replies.Status(
            program="ros", robot=ROBOT.name, controller="", state=state, why="", command=None, done=0.0,
                left=0.0,
            override=100.0, joints=tuple(joints), waiting=0, pid=1, since="", owner=owner,
        )  # fmt: skip
        self.feedback = Feedback(ROBOT, "ros", status)
        self.time = 0.0

    def at(self, joints, after=0.02):
        self.time += after
        told = joints_by_name(ROBOT, np.asarray(joints, dtype=float))
        self.feedback.hear(events.Position(time_s=self.time, joints=told, done_s=0.0))

    def becomes(self, state, why="", code=None):
        self.feedback.hear(events.StateChanged(time_s=self.time, state=state, why=why, code=code))

    def status(self, refusal=None):
        message = self.feedback.status(refusal)
        assert message.comm is Comm.TOPIC
        return message.body


def motors(*closed):
    made = (
        replies.MotorHealth(number=n, closed_loop=one, homed=True, trouble="", flags=(), following=0.0)
        for n, one in enumerate(closed, 1)
    )
    return replies.Health(
        motors=tuple(made), following=None, reply_s=0.0, slowest_s=0.0, silence_s=0.4, ahead=None, guard=True
    )


def test_positions_are_told_in_their_order():
    told = Told()
    assert told.feedback.position() is None
    told.at([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    found = told.feedback.position().body.joints
    assert found == pytest.approx((0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.0, 0.0, 0.0, 0.0), abs=1e-7)


def test_a_program_is_a_motion():
    told = Told()
    assert told.status().in_motion == -1
    told.at([0.0] * 6)
    assert told.status().in_motion == 0
    told.becomes(State.INIT)
    assert told.status().in_motion == 0
    told.becomes(State.MOVE)
    assert told.status().in_motion == 1  # during a program in_motion is 1, even in a pause
    told.becomes(State.STOP)
    assert told.status().in_motion == 0


def test_a_hold_is_a_motion_until_the_joints_rest():
    told = Told(State.MOVE)
    told.at([0.0] * 6)
    told.becomes(State.HOLD)
    told.at([0.01] * 6)
    assert told.status().in_motion == 1
    told.at([0.01] * 6)
    assert told.status().in_motion == 0


def test_a_count_that_flickers_isnt_a_motion():
    told = Told()
    step = 0.5 * STANDS * 0.02 * ROBOT.limits.velocity
    for one in (0.0, 1.0, 0.0, 1.0):
        told.at(one * step)
        assert told.status().in_motion == 0
    told.at(5.0 * step)
    assert told.status().in_motion == 1


def test_a_refusal_is_told_by_its_number():
    told = Told()
    found = told.status(Refusal("Y0616", "too quick"))
    assert (found.error_code, found.in_error) == (616, 1)
    found = told.status()
    assert (found.error_code, found.in_error) == (0, 0)


def test_a_fault_comes_before_a_refusal():
    told = Told()
    told.becomes(State.FAULT, "a motor", "Y1603")
    found = told.status(Refusal("Y0616", "too quick"))
    assert (found.error_code, found.in_error, found.motion_possible) == (1603, 1, 0)
    assert told.feedback.trouble().what == "a motor"


def test_a_lost_controller_tells_no_positions():
    told = Told()
    told.at([0.0] * 6)
    told.becomes(State.DISCONNECTED, "the cable")
    assert told.feedback.position() is None
    found = told.status()
    assert (found.error_code, found.in_motion, found.drives_powered, found.motion_possible) == (
        1606,
        -1,
        -1,
        0,
    )


def test_who_owns_the_robot_is_the_mode():
    told = Told(owner="anna")
    assert (told.status().mode, told.status().motion_possible) == (1, 0)
    for owner in ("ros", None):
        told.feedback.hear(events.OwnerChanged(time_s=0.0, owner=owner))
        assert (told.status().mode, told.status().motion_possible) == (2, 1)


def test_drives_are_powered_if_all_are():
    told = Told()
    assert told.status().drives_powered == -1
    told.feedback.health(motors(True, True))
    assert (told.status().drives_powered, told.status().motion_possible) == (1, 1)
    told.feedback.health(motors(True, False))
    assert (told.status().drives_powered, told.status().motion_possible) == (0, 0)
