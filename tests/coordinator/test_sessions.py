"""Random sessions: two clients send commands, stops, faults and disconnects in any order, in the process and
over its socket, against the simulator in virtual time.

In each session, only certified lines are streamed, no joint is ever beyond a limit, and after a stop the
robot rests as soon as physics allows. The same sessions are tested each time. `YARCLANG_RANDOM_SESSIONS=1000`
tests that many other sessions, for a night.
"""

import asyncio
import os
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace
from unittest import mock

import numpy as np
import pytest
from coordinator.virtual import VirtualLoop, World, coordinating
from floors import Tally
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from yarclang.coordinator.attached import There
from yarclang.coordinator.live.proof import Judge
from yarclang.coordinator.live.steering import JointVelocity, Master, Twist
from yarclang.coordinator.messages import orders, wants
from yarclang.coordinator.ownership import NotOwner
from yarclang.coordinator.serving import ControlSocket
from yarclang.pmac.requests import Code
from yarclang.pmac.variables import DISARMS
from yarclang.robot.actuation import from_counts
from yarclang.runtime.actions import Trouble
from yarclang.runtime.pmac import scripts
from yarclang.runtime.state import State

NIGHT = "YARCLANG_RANDOM_SESSIONS" in os.environ
SESSIONS = int(os.environ.get("YARCLANG_RANDOM_SESSIONS", "40"))

START = [0.0, 10.0, 10.0, 0.0, 40.0, 0.0]
REPLY = 0.05
"""Longest delay of a stop [s]: it is sent after the reply that is awaited."""

JOINTS = st.lists(st.integers(-12, 12), min_size=6, max_size=6)
LINES = st.one_of(
    JOINTS.map(lambda q: f"MOVEJ {q[0]} {10 + q[1]} {10 + q[2]} {q[3]} {40 + q[4]} {q[5]} [30%] (deg,s)"),
    JOINTS.map(lambda q: f"DMOVEJ {' '.join(map(str, q))} [1] (deg,s)"),
    st.tuples(st.integers(-40, 40), st.integers(-40, 40)).map(
        lambda d: f"DMOVE {{TCP}} {d[0]} 0 {d[1]} 0 0 0 [50%] (mm,deg,s) {{B}}"
    ),
    st.sampled_from(
        [
            "JOINTS READY 0 10 10 0 40 0 (deg)",
            "MOVEJ READY [40%] (s)",
            "OUTPUT GRIP M1 OFF",
            "SET GRIP ON",
            "WAIT [0.2] (s)",
            "HOLD",
            "MOVEJ 400 0 0 0 0 0 [1] (deg,s)",
            "nonsense",
        ]
    ),
)
FLOORS = {
    "sessions that stream": 0.3,
    "lines offered": 0.3,
    "lines carried out": 0.05,
    "ways back offered": 0.0,
    "drives begun": 0.1,
    "jogs that move": 0.1,
    "stops and aborts of what moves": 0.0,
    "faults cleared": 0.0,
}
"""Smallest shares of the requested actions that must really have happened in all sessions together. After a
fault or a stop, many actions are refused.
"""
SPEEDS = st.lists(st.floats(-0.6, 0.6), min_size=6, max_size=6)


@contextmanager
def certified_lines():
    """Yield the set of all certified lines: those of programs, and those that the judge of live motions has
    admitted.
    """
    known = set()
    given, admit = scripts.SCRIPTS, Judge.admit

    def performing(operation, job):
        assert job.certificate
        known.update(job.lines)
        for leg in job.legs:
            known.update(leg.job.lines if leg.job else ())
        return given.perform(operation, job)

    def performing_live(operation, live):
        assert not any(line.startswith("X") for line in live.opening)
        known.update(live.opening)
        return given.perform_live(operation, live)

    def admitting(self, lines):
        known.update(lines)
        admit(self, lines)

    scripts.SCRIPTS = replace(given, perform=performing, perform_live=performing_live)
    Judge.admit = admitting
    try:
        yield known
    finally:
        scripts.SCRIPTS, Judge.admit = given, admit


class Sessions(RuleBasedStateMachine):
    """Random actions of two clients of one coordinator."""

    tally = Tally()
    """Counts over all sessions: requested actions, and actions that really happened."""

    def __init__(self):
        super().__init__()
        self.loop = VirtualLoop()
        asyncio.set_event_loop(self.loop)
        self.going = None
        self.drive = None
        self.known_context = certified_lines()
        self.known = self.known_context.__enter__()

    @initialize(moves=st.booleans())
    def begin(self, moves):
        """Begin a session, half of them in motion. Otherwise too few sessions would stop a moving robot."""
        self.do(self._begin())
        if moves:
            self.line("MOVEJ 20 20 15 0 50 10 [20%] (deg,s)", 0.4)

    async def _begin(self):
        self.world = World(joints=START, record=True)
        self.context = coordinating(world=self.world)
        _, self.coordinator, self.client = await self.context.__aenter__()
        self.other = self.coordinator.attach("other")

    def teardown(self):
        try:
            self.do(self._end())
            self.judge()
        finally:
            self.known_context.__exit__(None, None, None)
            self.loop.run_until_complete(self.loop.shutdown_asyncgens())
            self.loop.close()

    async def _end(self):
        if hasattr(self, "context"):
            self.world.plug()
            self.client.motion.stop()
            await self.context.__aexit__(None, None, None)
            pending = [one for one in (self.going, *self.driving) if one is not None]
            await asyncio.gather(*pending, return_exceptions=True)
            assert not self.world.moving

    @property
    def driving(self):
        return [asyncio.ensure_future(self.drive.ended())] if self.drive else []

    def do(self, coroutine):
        return self.loop.run_until_complete(coroutine)

    def wait(self, seconds):
        self.do(asyncio.sleep(seconds))

    @property
    def busy(self):
        return bool(self.coordinator.under_way)

    @property
    def state(self):
        return self.coordinator.state

    # actions of the owner

    @rule(text=LINES, wait=st.sampled_from([0.0, 0.02, 0.1, 0.5, 3.0]))
    def line(self, text, wait):
        async def go():
            try:
                made = await self.client.motion.offer(text)
                self.tally.count("lines offered", made.value is not None)
                if made.value is not None:
                    done = await self.client.motion.go(made.value)
                    self.tally.count("lines carried out", done.well)
                    return done
            except Trouble as trouble:
                return trouble

        if self.going is None or self.going.done():
            self.going = self.loop.create_task(go())
            self.wait(wait)
        else:
            assert isinstance(self.do(go()), Trouble | type(None)) or not self.busy

    @precondition(lambda self: not self.busy and self.coordinator.history.end is not None)
    @rule(wait=st.sampled_from([0.02, 0.3, 2.0]))
    def back(self, wait):
        async def go():
            try:
                made = await self.client.motion.offer_back()
                self.tally.count("ways back offered", made.value is not None)
                return made.value and await self.client.motion.go(made.value)
            except Trouble as trouble:
                return trouble

        if self.going is None or self.going.done():
            self.going = self.loop.create_task(go())
            self.wait(wait)

    @precondition(lambda self: not self.busy and self.state is State.STOP)
    @rule(joints=JOINTS, wait=st.sampled_from([0.02, 0.1, 0.5, 3.0]))
    def motion(self, joints, wait):
        self.line(
            f"MOVEJ {joints[0]} {10 + joints[1]} {10 + joints[2]} 0 {40 + joints[4]} {joints[5]} [40%] "
            "(deg,s)",
            wait,
        )

    @rule(kind=st.sampled_from(["joints", "base", "tool", "master"]), values=SPEEDS)
    def jog(self, kind, values):
        values = np.array(values)
        targets = {
            "joints": JointVelocity(values),
            "base": Twist(values[:3] * 0.4, values[3:]),
            "tool": Twist(values[:3] * 0.4, values[3:], "tool"),
            "master": Master(np.deg2rad(START) + values, np.zeros(6)),
        }

        async def begin():
            try:
                if self.drive is not None and self.drive.alive:
                    self.drive.want(targets[kind])
                else:
                    made = await self.client.live.drive(targets[kind])
                    self.drive = made.value or self.drive
                    self.tally.count("drives begun", made.value is not None)
                await asyncio.sleep(0.15)
                if self.drive is not None and self.drive.alive:
                    self.drive.want(targets[kind])
                    self.tally.count("jogs that move", self.world.moving)
            except Trouble:
                pass
            await asyncio.sleep(0.1)

        self.do(begin())

    @precondition(lambda self: self.drive is not None and self.drive.alive)
    @rule()
    def finish(self):
        self.drive.finish()
        self.wait(0.2)

    @precondition(lambda self: self.busy)
    @rule(who=st.sampled_from(["client", "other"]), wait=st.sampled_from([0.0, 0.1, 0.4]))
    def stop(self, who, wait):
        self.wait(wait)
        self.tally.count("stops and aborts of what moves", self.world.moving)
        getattr(self, who).motion.stop()
        self.rests_within(self.world.robot.controller.hold_time + REPLY)

    @precondition(lambda self: self.busy)
    @rule(who=st.sampled_from(["client", "other"]), wait=st.sampled_from([0.0, 0.1, 0.4]))
    def abort(self, who, wait):
        self.wait(wait)
        self.tally.count("stops and aborts of what moves", self.world.moving)
        getattr(self, who).motion.abort()
        limits = self.world.robot.limits
        self.rests_within(2.0 * float((limits.velocity / limits.stop_acceleration).max()) + REPLY)

    def rests_within(self, seconds):
        """Check that the robot comes to rest in time, if the controller is connected. Otherwise the guard PLC
        stops it later.
        """
        if not self.world.unplugged and self.state is not State.DISCONNECTED and self.connected:
            self.do(self.world.until(lambda: not self.world.moving, within=seconds + 0.01, each=0.002))

    @precondition(lambda self: self.busy)
    @rule()
    def hold(self):
        self.other.motion.hold()
        self.wait(0.3)

    @precondition(lambda self: self.busy)
    @rule(wait=st.sampled_from([0.0, 0.3]))
    def resume(self, wait):
        self.client.motion.resume()
        self.wait(wait)

    @rule(percent=st.sampled_from([20.0, 60.0, 100.0]))
    def override(self, percent):
        self.client.motion.override(percent)
        self.wait(0.05)

    @rule(seconds=st.sampled_from([0.01, 0.2, 1.0, 4.0]))
    def time_passes(self, seconds):
        self.wait(seconds)

    # actions of the other client, and events

    @rule(what=st.sampled_from(["go", "drive", "own", "override", "resume"]))
    def the_other_wants_to_move_it(self, what):
        async def wanted():
            match what:
                case "go":
                    made = await self.other.motion.offer("LET A1 = 1")
                    await self.other.motion.go(made.value)
                case "drive":
                    await self.other.live.drive(JointVelocity(np.ones(6) * 0.1))
                case "own":
                    self.other.session.own()
                case "override":
                    self.other.motion.override(50.0)
                case "resume":
                    self.other.motion.resume()

        with pytest.raises(Trouble) as refused:
            self.do(wanted())
        # Every client may plan, but nothing can be planned during a motion, so `go` may lack its offer.
        assert isinstance(refused.value, NotOwner) or what == "go"

    @rule(seconds=st.sampled_from([0.05, 1.5, 4.0]))
    def unplug(self, seconds):
        self.world.unplug()
        self.connected = False
        self.wait(seconds)
        self.world.plug()
        self.wait(12.0)
        assert not self.world.moving or self.busy
        self.connected = True

    connected = True

    @precondition(lambda self: self.state is not State.FAULT)
    @rule(motor=st.integers(1, 6))
    def fault(self, motor):
        """Kill a motor: the controller stops the running program."""
        self.world.catch_up()
        self.world.machine.command(f"#{motor}K", 9)
        self.wait(0.5)

    @precondition(lambda self: self.state is State.FAULT and not self.busy)
    @rule()
    def clear(self):
        for motor in range(1, 7):
            self.world.machine.command(f"#{motor}J/", 9)
        try:
            self.do(self.client.motion.clear())
        except Trouble:
            self.tally.count("faults cleared", False)
            return
        self.tally.count("faults cleared")
        assert self.state is State.STOP

    @invariant()
    def nothing_moves_but_what_is_under_way(self):
        if hasattr(self, "world") and not self.busy and self.connected:
            assert not self.world.moving

    # checks of the streamed lines and of the robot's positions

    def judge(self):
        if not hasattr(self, "world"):
            return
        streamed = False
        for _, code, text in self.world.lines:
            if code != Code.WRITEBUFFER:
                continue
            for line in text.strip("\0").split("\0"):
                assert line in self.known or line in (DISARMS, "OPEN ROT", "CLOSE"), line
                streamed |= line in self.known
        self.tally.count("sessions that stream", streamed)
        robot, machine = self.world.robot, self.world.machine
        times = np.arange(0.0, machine.now, 0.01)
        q = from_counts(robot, machine.positions(times, robot.controller.motors))
        assert (q >= robot.limits.lower - 1e-6).all()
        assert (q <= robot.limits.upper + 1e-6).all()
        rate = np.abs(np.diff(q, axis=0)) / 0.01
        assert (rate <= robot.limits.velocity * 1.001).all(), rate.max(axis=0)


Sessions.TestCase.settings = settings(
    max_examples=SESSIONS,
    stateful_step_count=24,
    deadline=None,
    derandomize=not NIGHT,
    suppress_health_check=list(HealthCheck),
    print_blob=True,
    # without shrinking: shrinking a session takes longer than reading it
    phases=(Phase.explicit, Phase.reuse, Phase.generate),
)


class TestSessions(Sessions.TestCase):
    def runTest(self):
        Sessions.tally = Tally()
        super().runTest()
        assert Sessions.tally.below(FLOORS) == []


class Remote:
    """A client over a socket, with those parts of `Client` that the sessions use."""

    def __init__(self, there, coordinator):
        self.there, self.coordinator = there, coordinator
        self.motion = self.live = self

    @classmethod
    async def attach(cls, coordinator, control, name):
        return cls(await There.attach(control.path, name), coordinator)

    async def offer(self, text):
        return SimpleNamespace(value=(await self.there.ask(orders.Offer(text=text))).offer)

    async def offer_back(self):
        return SimpleNamespace(value=(await self.there.ask(orders.OfferBack())).offer)

    async def go(self, offer):
        return await self.there.ask(orders.Go(offer=offer.number))

    async def clear(self):
        await self.there.ask(orders.Clear())

    def stop(self):
        self.there.send(orders.Stop())

    def abort(self):
        self.there.send(orders.Abort())

    def hold(self):
        self.there.send(orders.Hold())

    def resume(self):
        self.there.send(orders.Resume())

    def override(self, percent):
        self.there.send(orders.Override(percent=percent))

    async def drive(self, target):
        await self.there.ask(orders.Steer(again=False))
        await self.there.ask(want_of(target))
        return SimpleNamespace(value=RemoteDrive(self))


class RemoteDrive:
    """A live motion that is steered over a socket."""

    def __init__(self, client):
        self.client = client

    @property
    def alive(self):
        return self.client.coordinator.under_way == "master"

    def want(self, target):
        self.client.there.send(want_of(target))

    def finish(self):
        self.client.there.send(wants.Finish())

    async def ended(self):
        while self.alive:
            await asyncio.sleep(0.01)


def want_of(target):
    """Return a target as a message."""
    degrees = np.rad2deg
    match target:
        case JointVelocity(velocity=velocity):
            return wants.MoveJoints(velocity={f"J{n + 1}": float(degrees(v)) for n, v in enumerate(velocity)})
        case Twist(linear=linear, angular=angular, axes=axes):
            return wants.MoveTool(twist=(*(linear * 1e3).tolist(), *degrees(angular).tolist()), axes=axes)
        case Master(q=q, rate=rate):
            return wants.BeThere(joints=tuple(degrees(q).tolist()), rate=tuple(degrees(rate).tolist()))


class ServedSessions(Sessions):
    """Random actions of two clients over the socket, with broken connections and changes of the owner."""

    async def _begin(self):
        self.world = World(joints=START, record=True)
        self.context = coordinating(world=self.world)
        _, self.coordinator, first = await self.context.__aenter__()
        first.session.leave()
        self.folder = tempfile.TemporaryDirectory(prefix="yarc-")
        with mock.patch.dict(os.environ, {"XDG_RUNTIME_DIR": self.folder.name}):
            self.control = ControlSocket(self.coordinator)
            await self.control.__aenter__()
        self.client = await Remote.attach(self.coordinator, self.control, "client")
        self.other = await Remote.attach(self.coordinator, self.control, "other")
        await self.client.there.ask(orders.Own())

    async def _end(self):
        if hasattr(self, "control"):
            self.world.plug()
            self.client.stop()
            await asyncio.sleep(1.0)
            for one in (self.client, self.other):
                await one.there.leave()
            await self.control.__aexit__(None, None, None)
            self.folder.cleanup()
        if hasattr(self, "context"):
            await self.context.__aexit__(None, None, None)
            await asyncio.gather(*(one for one in (self.going,) if one is not None), return_exceptions=True)
            assert not self.world.moving

    @rule(what=st.sampled_from(["go", "drive", "own", "override", "resume", "set", "load"]))
    def the_other_wants_to_move_it(self, what):
        async def wanted():
            there = self.other.there
            match what:
                case "go":
                    made = await self.other.offer("LET A1 = 1")
                    await self.other.go(made.value)
                case "drive":
                    await there.ask(want_of(JointVelocity(np.ones(6) * 0.1)))
                case "own":
                    await there.ask(orders.Own())
                case "override":
                    await there.ask(orders.Override(percent=50.0))
                case "resume":
                    await there.ask(orders.Resume())
                case "set":
                    await there.ask(orders.SetOutput(name="GRIP", value="ON"))
                case "load":
                    await there.ask(orders.Run(program=1))

        with pytest.raises(Trouble):
            self.do(wanted())
        assert self.coordinator.owner == "client"

    @precondition(lambda self: self.busy)
    @rule(before=st.sampled_from([0.0, 0.1, 0.4]), wait=st.sampled_from([0.0, 0.3]))
    def the_owner_is_cut_off(self, before, wait):
        """The owner's process dies: the robot comes to rest, and has no owner."""
        self.wait(before)
        self.client.there._writer.transport.abort()
        self.tally.count("owners cut off in motion", self.world.moving)
        self.wait(0.002)
        assert self.coordinator.owner == ""
        self.rests_within(self.world.robot.controller.hold_time + REPLY)
        self.wait(wait)
        self.do(self._again())

    async def _again(self):
        await self.client.there.leave()
        self.client = await Remote.attach(self.coordinator, self.control, "client")
        await self.client.there.ask(orders.Own())
        self.drive = None

    @precondition(lambda self: not self.busy)
    @rule()
    def the_robot_is_given_over(self):
        async def given():
            await self.client.there.ask(orders.Give(to=self.other.there.welcome.name))
            assert self.coordinator.owner == "other"
            await self.other.there.ask(orders.Release())
            await self.client.there.ask(orders.Own())

        self.do(given())

    @rule(line=st.binary(max_size=40) | st.sampled_from([b"{}", b'{"order": "go"}', b'{"order": "abort"']))
    def somebody_says_nonsense(self, line):
        async def said():
            reader, writer = await asyncio.open_unix_connection(str(self.control.path))
            writer.write(line + b"\n")
            writer.write_eof()
            answers = await reader.read()
            writer.close()
            return answers

        assert b'"ok": true' not in self.do(said())


ServedSessions.TestCase.settings = Sessions.TestCase.settings


class TestServedSessions(ServedSessions.TestCase):
    def runTest(self):
        Sessions.tally = ServedSessions.tally = Tally()
        super().runTest()
        # With frequent changes of the owner, there is rarely a motion to take back.
        floors = {**FLOORS, "owners cut off in motion": 0.05}
        del floors["ways back offered"]
        assert ServedSessions.tally.below(floors) == []
