"""Fixtures: the runtime and the simulator in virtual time, without a socket and a clock. The test determines
how long a reply takes.
"""

import random
import re
import shutil
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from programs import compiled
from scipy.spatial import cKDTree
from simulator.machines import EXAMPLES, robot_machine

from yarclang.backend_pmac.settings import settings_text
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import approach
from yarclang.pipeline.settings import items_of
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.robot.description import load_robot
from yarclang.runtime.actions import Connect, Connected, Keep, Late, Replan, Unreachable, Violation, Wait
from yarclang.runtime.notices import Abort, Changed, Fail, Hold, Remark, Stop
from yarclang.runtime.pmac.messages import Ask, AskControl, Control, Request, Write, Written
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.performance import connect, look, perform
from yarclang.runtime.pmac.protocol import GREETING, Connection
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import commissioned
from yarclang.simulator.faults import Troubles, parse_fault
from yarclang.simulator.motion.recorder import Recorder
from yarclang.simulator.network.ethernet import PacketReader, Station

ROOT = Path(__file__).resolve().parents[2]
REPLY_TIME = 1.0
SPY = 9
"""Port of the machine that only the tests use."""

SHORT = """P0010 MOVEJ_LSPB 20 -10 15 5 20 -15 [1.5] (deg,s)
P0020 MOVEJ_LSPB 10 5 -12 10 -5 -20 [1.5] (deg,s)
P0030 MOVEJ_POLY5 0 0 0 0 0 0 [1.5] (deg,s)
"""
"""Three motions of INDUSTRIAL6 with all motors, which lead back to the start."""


@dataclass(frozen=True)
class Sent:
    """A request, the times at which it was sent and answered, and the state of the world when it was sent.

    `moving` and `stores` (True if a rotary buffer is open on the port) aren't determined for requests that
    are always allowed.
    """

    time: float
    request: Request
    state: State
    moving: bool
    stores: bool


class World:
    """A machine and an operation with a common virtual time.

    Args:
        machine: the simulator.
        delay: function that returns the duration of an exchange [s]; or its largest value, for random
            durations up to this value.
        seed: seed of random numbers.
        faults: faults as for `yarc sim --fault`; their times count from now on.

    Attributes:
        operation: state, orders and notices of the run.
        at: pairs (time, function) of calls to come.
        replan: returns the rest of the program after a search.
        told: all notices.
        sent: all requests.
        given: all orders, each with the number of requests that were sent before.
        refused: errors with which WRITEBUFFERs were refused.
        spoil: function that gets a request and its reply, and returns a changed reply.
        reachable: function of the time that returns True if the controller can be reached.
        stall_at: times at which the host stands still, with the durations [s].
    """

    def __init__(self, machine, delay=0.0005, seed=0, faults=()):
        self.machine = machine
        self.operation = Operation()
        self.random = random.Random(seed)
        self.delay = delay if callable(delay) else lambda: self.random.uniform(0.0, delay)
        self.now = machine.now
        self.at = []
        self.told = []
        self.kept, self.unkept = {}, None
        self.replan = lambda wanted: None  # the program is unknown by default
        self.sent = []
        self.given = []
        self.refused = []
        self.spoil = lambda request, reply: reply
        self.reachable = lambda now: True
        self.stall_at = []
        self.troubles = Troubles(machine)
        self.spoil_by(*faults)
        self._station = self._connection = self._reader = None

    def spoil_by(self, *faults):
        """Add faults. Their times, after `@`, count from now."""
        self.troubles = Troubles(self.machine, [parse_fault(_later(text, self.now)) for text in faults])

    # actions of a test

    def perform(self, script, within=600.0):
        """Run a script, and return its result."""
        outcome, until = None, self.now + within
        while True:
            assert self.now < until, "it takes too long"
            while self.stall_at and self.stall_at[0][0] <= self.now:
                self._pass(self.now + self.stall_at.pop(0)[1])
            self.operation.now = self.now
            try:
                action = script.send(outcome)
            except StopIteration as end:
                return end.value
            finally:
                self.told += self.operation.notices
                self.operation.notices.clear()
            match action:
                case Wait(until=then):
                    self._pass(then, wakes=True)
                    outcome = None
                case Keep(register=register, value=value):
                    self.kept[register] = value
                    outcome = self.unkept
                case Replan():
                    self._pass(self.now + 0.05)
                    outcome = self.replan(action)
                case Connect():
                    self._pass(self.now + 0.001)
                    outcome = self._connect()
                case _:
                    outcome = self._exchange(action)

    def order(self, order, after):
        """Give an order after a time [s]."""

        def give():
            self.given.append((len(self.sent), order))
            self.operation.orders.append(order)

        self.at.append((self.now + after, give))

    def do(self, function, after):
        """Call a function after a time [s]."""
        self.at.append((self.now + after, function))

    def say(self, line):
        """Send a line from another terminal. The controller must accept it."""
        reply = self.machine.command(line, SPY)
        assert reply.error is None, (line, reply)
        return reply.items

    def prepare(self, robot):
        """Connect and inspect the controller. Everything must be in order."""
        self.perform(connect(self.operation))
        found = self.perform(look(self.operation, robot, items_of(robot)))
        assert not found.errors, found.errors
        return found

    def approach(self, robot, there):
        """Move to the start of a program."""
        made = approach(robot, from_counts(robot, self.stands(robot)), there)
        job = job_of_compiled(made.value, "approach")
        return self.perform(perform(self.operation, job))

    # observations of a test

    def stands(self, robot):
        """Return the commanded motor positions (n,) [counts]."""
        return self.machine.positions(motors=robot.controller.motors)

    @property
    def moving(self):
        """Return True if a motor has a desired velocity other than zero."""
        words = self.machine.control(2, SPY).items[0].split()
        return not all(int(word, 16) >> 24 & (1 << 13 | 1 << 18) for word in words)

    @property
    def states(self):
        """All states that were reported, in order."""
        return [notice.state for notice in self.told if isinstance(notice, Changed)]

    @property
    def words(self):
        """The texts of all reports."""
        return "\n".join(
            getattr(notice, "text", None) or notice.why
            for notice in self.told
            if isinstance(notice, Changed | Remark)
        )

    @property
    def asked(self):
        """All lines that were sent as requests."""
        return [sent.request.line for sent in self.sent if isinstance(sent.request, Ask)]

    # the connection

    def _connect(self):
        if not self.reachable(self.now):
            return Unreachable("the cable is out")
        self._station = Station(self.machine, 0)
        self._connection, self._reader = Connection(), PacketReader()
        return Connected()

    def _exchange(self, request):
        self._note(request)
        connection = self._connection
        if connection is None or connection.lost:
            return Violation(request, "there is no connection")
        data = connection.send(request, self.now, REPLY_TIME)
        while True:
            events = self._round_trip(request, data)
            data = connection.outgoing()
            if events:
                break
        event = events[0]
        if isinstance(event, Written) and event.error is not None:
            self.refused.append(event)
        if isinstance(event, Late | Violation) and self.operation.state in (State.MOVE, State.HOLD):
            self._last_words()
        return event

    def _round_trip(self, request, data):
        """Return the events of one packet and its reply."""
        connection, delay = self._connection, self.delay()
        there = delay * self.random.random()
        if self._dead() or delay >= REPLY_TIME:
            self._pass(self.now + min(there, REPLY_TIME))
            if not self._dead():
                self._answers(request, data)
            self._pass(max(connection.deadline, self.now))
            return connection.check(self.now)
        self._pass(self.now + there)
        reply, late = self._answers(request, data)
        if self.troubles.dropped():
            return connection.close()
        self._pass(self.now + delay - there + late)
        if self.troubles.dropped():
            return connection.close()
        if self.now >= connection.deadline or self._dead():
            self._pass(max(connection.deadline, self.now))
            return connection.check(self.now)
        return connection.receive(reply, self.now)

    def _dead(self):
        return self.troubles.frozen or not self.reachable(self.now)

    def _answers(self, request, data):
        packets = self._reader.receive(data)
        if self.troubles.busy and isinstance(request, Ask):
            return self.troubles.spoil(b"\x00")
        reply = b"".join(self._station.answer(packet) for packet in packets)
        reply, late = self.troubles.spoil(self.spoil(request, reply))
        self.troubles.lines_written(self._station.take_lines())
        return reply, late

    def _last_words(self):
        """Send the last control character before the connection ends, as a session does."""
        character = "\x01" if Abort() in self.operation.orders else "\x0f"
        data = Connection().last_words(character)
        if not self._dead():
            for packet in PacketReader().receive(data):
                self._station.answer(packet)

    def _note(self, request):
        harmless = isinstance(request, Write) or (
            request in (AskControl("\x02"), AskControl("\x10"), AskControl("\x06")) or asks_flow(request)
        )
        self.sent.append(
            Sent(
                self.now,
                request,
                self.operation.state,
                not harmless and self.moving,
                not harmless and bool(int(self.machine.command("???", SPY).items[0], 16) >> 40 & 1),
            )
        )

    def _pass(self, until, wakes=False):
        """Let time pass until `until`, and make the calls that are due. With `wakes`, a new order ends the
        wait.
        """
        orders = len(self.operation.orders)
        while True:
            due = [one for one in self.at if one[0] <= until]
            if not due:
                break
            first = min(due, key=lambda one: one[0])
            self.at.remove(first)
            self._advance(max(first[0], self.now))
            first[1]()
            if wakes and len(self.operation.orders) > orders:
                return
        self._advance(max(until, self.now))

    def _advance(self, until):
        if until > self.now:
            self.troubles.advance(until - self.now)
            self.now = until


def _later(text, now):
    """Return a fault whose time counts from `now`."""
    head, at, rest = text.partition("@")
    if not at or rest.startswith("line"):
        return text
    when, colon, values = rest.partition(":")
    return f"{head}@{float(when) + now:.9f}{colon}{values}"


@cache
def prepared(text=SHORT, robot="INDUSTRIAL6", **request):
    """Return the job and the plan of a program."""
    value, found = compiled(text, robot, **request)
    assert value is not None, found
    return job_of_compiled(value, "test"), value.plan


@cache
def example_of(robot, **request):
    """Return the job and the plan of a robot's example."""
    from conftest import EXAMPLES as FOLDER

    return prepared((FOLDER / f"{EXAMPLES[robot]}.yarc").read_text(), robot, **request)


def world_of(job, *, record=False, prepare=True, stand=True, **options):
    """Return a world whose robot stands at a job's start, after an inspection."""
    robot, machine = robot_machine(job.robot.name, record)
    world = World(machine, **options)
    if stand:
        place_at(world, robot, job.start)
    if prepare:
        world.prepare(robot)
    return world


def robot_with(folder, motors):
    """Return INDUSTRIAL6 on other motors of its controller, and a world with it."""
    source = ROOT / "stdlib" / "robots" / "industrial6"
    shutil.copytree(source, folder / "robot")
    file = folder / "robot" / "robot.toml"
    file.write_text(file.read_text().replace("numbers = [1, 2, 3, 4, 5, 6]", f"numbers = {list(motors)}"))
    robot = load_robot(str(file)).value
    return robot, World(commissioned(robot, settings_text(robot), record=Recorder()))


def place_at(world, robot, joints):
    """Move the robot to joint positions, by jogs."""
    for motor, counts in zip(robot.controller.motors, to_counts(robot, joints), strict=True):
        world.say(f"#{motor}J={counts:.6f}")
    world.machine.advance(0.5)
    while world.moving:
        world.machine.advance(0.5)
    world.now = world.machine.now


class PlannedPath:
    """The path of a plan, as a fine polyline in counts."""

    def __init__(self, plan, step=1e-3):
        times = np.arange(0.0, plan.duration + step, step)
        joints, _, _ = plan.sample(np.minimum(times, plan.duration))
        self._points = to_counts(plan.robot, joints)
        self._tree = cKDTree(self._points)

    def distance(self, counts):
        """Return the largest distance of points (N, n) from the path [counts of any motor]."""
        counts = np.atleast_2d(counts)
        _, nearest = self._tree.query(
            counts, 32
        )  # the nearest point alone may be on another part of the path that crosses here
        best = np.full(len(counts), np.inf)
        for first in (*(nearest.T - 1), *nearest.T):
            begin = self._points[np.clip(first, 0, len(self._points) - 2)]
            way = self._points[np.clip(first, 0, len(self._points) - 2) + 1] - begin
            length = np.maximum((way**2).sum(axis=1), 1e-12)
            share = np.clip(((counts - begin) * way).sum(axis=1) / length, 0.0, 1.0)
            best = np.minimum(best, np.abs(counts - begin - share[:, None] * way).max(axis=1))
        return float(best.max())


def moved_along(world, job, plan, since, step=0.01):
    """Return the robot's largest distance from its path since a time [counts]."""
    times = np.arange(since, world.machine.now, step)
    return path_of(plan).distance(world.machine.positions(times, job.robot.controller.motors))


def path_of(plan):
    """Return the path of a plan. It is computed only once."""
    if id(plan) not in _PATHS:
        _PATHS[id(plan)] = plan, PlannedPath(plan)
    return _PATHS[id(plan)][1]


_PATHS = {}


def well_behaved(world):
    """Check what holds for each run: no line too many, no forbidden request in motion, and no request that an
    open rotary buffer would store.
    """
    for sent in world.sent:
        match sent.request:
            case Ask(line=line):
                assert not re.fullmatch(r"(&\d+)?[QK/]|#\d+K", line), sent
                asks_while_storing = line in ("R", "CLOSE", "CLOSE ALL", "CLEAR") or _is_harmless(line)
                assert not sent.stores or asks_while_storing, sent
                assert not sent.moving or line == GREETING or _is_harmless(line) or _only_asks(line), sent
            case Control(character=character):
                assert character in "\x01\x0f\x0c", sent
            case AskControl(character=character):
                assert character in "\x02\x06\x10", sent
            case Write(lines=lines):
                assert sum(len(line) + 1 for line in lines) <= 1024, sent


def _is_harmless(line):
    """Return True for requests of status, holds, overrides, and the choice of reported motors."""
    system = line.lstrip("&0123456789")
    return system in ("??", "H") or line.startswith(("%", "##"))


def asks_flow(request):
    """Return True if a request is the regular one about the flow of lines."""
    return isinstance(request, Ask) and re.match(r"I5\d12=\d+ PR ", request.line) is not None


def ahead_in(reply):
    """Return the number of buffered lines in the reply to the request about the flow."""
    return int(reply.partition(b"\r")[0])


def with_ahead(reply, ahead):
    """Return the reply to the request about the flow, with another number of buffered lines."""
    return ahead + reply[reply.index(b"\r") :]


def lines_of(request):
    """Return the lines of a packet for the rotary buffer."""
    first, *lines, last = request.lines
    assert (first, last) == ("OPEN ROT", "CLOSE")
    return lines


def _only_asks(line):
    """Return True for lines that only request values, definitions or listings. (The request about the flow
    also resets the watchdog.)
    """
    asked = re.sub(r"^I5\d12=\d+ PR | %$|(?<=\d) (?=P)", "", line)
    puts_back = r"I5\d95=\d+"  # without this value, no hold comes to rest
    return bool(re.fullmatch(rf"([PIM]\d+(->)?|#\d+->)+|LIST PLC \d+|{puts_back}", asked))


def stopped_at_once(world):
    """Check that each order to stop was sent with the very next request, if a program was running."""
    urgent = [(place, order) for place, order in world.given if isinstance(order, Hold | Stop | Fail | Abort)]
    for place, order in urgent:
        before = [sent.request for sent in world.sent[:place]]
        ends = max((n for n, request in enumerate(before) if _ends(request)), default=-1)
        goes = max((n for n, request in enumerate(before) if request == Ask("R")), default=-1)
        if goes <= ends or place == len(world.sent):
            continue
        request = world.sent[place].request
        assert request == Control("\x01") if order == Abort() else _holds(request), (order, request)


def _holds(request):
    return request in (Control("\x01"), Control("\x0f")) or (
        isinstance(request, Ask) and request.line.endswith("H")
    )


def _ends(request):
    return _holds(request) or request == Ask("CLOSE ALL")
