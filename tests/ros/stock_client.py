"""A double of ROS-Industrial's stock client nodes: streamer, downloader, state node and action in one.

It behaves as observed in the unmodified C++ nodes (industrial_core 0.7.3), including their faults. It ignores
FAILURE, holds its lock while it waits for an answer, and never marks the end of a streamed goal. It derives
the first duration from the goal before, and detects an end only by in_motion and positions.
"""

import asyncio
import contextlib
from dataclasses import dataclass, field

from yarclang.ros.simple_message import (
    ByteOrder,
    Comm,
    Decoder,
    JointPosition,
    Message,
    Ping,
    RobotStatus,
    TrajectoryPoint,
    encode,
    reply_to,
)

NEAR = 0.01
"""The nodes' parameter constraints/goal_threshold [rad]."""
WATCHDOG = 1.0
BETWEEN = 0.007
"""Time between an answer and the next point [s]."""


@dataclass
class GoalState:
    """A goal of the action; `state` is PENDING, ACTIVE, SUCCEEDED, PREEMPTED, ABORTED or REJECTED."""

    joints: tuple
    seconds: float
    state: str = "ACTIVE"
    moved: bool = False
    since: float = 0.0
    ended: float = 0.0


@dataclass
class Robot:
    """The robot's state, as the state link reported it."""

    joints: tuple = ()
    status: RobotStatus | None = None
    times: list = field(default_factory=list)
    """Times at which positions arrived [s]."""
    statuses: list = field(default_factory=list)
    """Each status that differs from the one before, with its time."""


class StockClient:
    """A client that is connected to both ports of a host.

    Args:
        ports: the ports of the motion link and of the state link.
        order: the byte order.
        retry: time after which the state node connects again [s].
    """

    def __init__(self, ports, *, order=ByteOrder.LITTLE, host="127.0.0.1", retry=5.0):
        self.robot = Robot()
        self.goal = None
        self.replies = []
        self._host, self._ports, self._order, self._retry = host, ports, order, retry
        self._lock = asyncio.Lock()
        self._last_time = 0.0
        self._wire = None
        self._tasks = []
        self._streaming = None

    async def __aenter__(self):
        await self._connect()
        self._tasks = [asyncio.ensure_future(one) for one in (self._listen(), self._watch())]
        return self

    async def __aexit__(self, *_):
        for one in (*self._tasks, *([self._streaming] if self._streaming else [])):
            one.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await one
        self.cut()

    def now(self):
        return asyncio.get_running_loop().time()

    # the motion node

    async def _connect(self):
        reader, writer = await asyncio.open_connection(self._host, self._ports[0])
        self._wire = reader, writer, Decoder(self._order)

    def cut(self):
        """Break the motion connection."""
        if self._wire is not None:
            self._wire[1].transport.abort()
            self._wire = None

    async def ask(self, body):
        """Send a request, and wait for its answer without a time limit.

        If the connection is lost, connect again, and send the request again.
        """
        async with self._lock:
            while True:
                try:
                    if self._wire is None:
                        await self._connect()
                    reader, writer, decoder = self._wire
                    writer.write(encode(Message(Comm.REQUEST, body), self._order))
                    while True:
                        data = await reader.read(1024)
                        if not data:
                            raise ConnectionResetError
                        for message in decoder.feed(data):
                            if message.comm is Comm.REPLY:
                                self.replies.append(message)
                                return message
                except OSError:
                    self._wire = None
                    await asyncio.sleep(0.01)

    def points(self, positions, times, velocity=0.1):
        """Return the points of a trajectory in the streamer's form."""
        made, before = [], None
        for place, (joints, time) in enumerate(zip(positions, times, strict=True)):
            if before is None:
                duration = time - self._last_time if time > self._last_time else 10.0
            else:
                duration = time - before if time > before else 10.0
            before = time
            slots = tuple(map(float, joints)) + (0.0,) * (10 - len(joints))
            made.append(TrajectoryPoint(place, slots, velocity, duration))
        self._last_time = times[-1]
        return made

    async def stream(self, positions, times, between=BETWEEN):
        """Stream a trajectory."""
        for point in self.points(positions, times):
            await self.ask(point)
            await asyncio.sleep(between)

    async def download(self, positions, times):
        """Download a trajectory: its messages are topics, which aren't answered."""
        points = self.points(positions, times)
        for place, point in enumerate(points):
            sequence = -3 if place == len(points) - 1 else -1 if place == 0 else place
            body = TrajectoryPoint(sequence, point.joints, point.velocity, point.duration)
            self._wire[1].write(encode(Message(Comm.TOPIC, body), self._order))
            await asyncio.sleep(0.001)

    async def stop(self):
        """Send a stop."""
        return await self.ask(TrajectoryPoint(-4))

    # the state node

    async def _listen(self):
        while True:
            with contextlib.suppress(OSError):
                reader, writer = await asyncio.open_connection(self._host, self._ports[1])
                decoder = Decoder(self._order)
                try:
                    while data := await reader.read(1024):
                        for message in decoder.feed(data):
                            self._hear(message, writer)
                finally:
                    writer.close()
            await asyncio.sleep(self._retry)

    def _hear(self, message, writer):
        robot = self.robot
        match message.body:
            case JointPosition(joints=joints):
                robot.joints = joints
                robot.times.append(self.now())
            case RobotStatus() as status:
                if robot.status != status:
                    robot.statuses.append((self.now(), status))
                robot.status = status
            case Ping() if message.comm is Comm.REQUEST:
                writer.write(encode(reply_to(message, success=True), self._order))
        self._look()

    # the action

    async def send_goal(self, positions, times):
        """Send a goal to the action, which first aborts a running one."""
        if not self.robot.times or self.now() - self.robot.times[-1] > WATCHDOG:
            self.goal = GoalState((), 0.0, "REJECTED")
            return self.goal
        if self.goal is not None and self.goal.state == "ACTIVE":
            self._end("ABORTED")
            if self._streaming is not None:
                self._streaming.cancel()
            await self.stop()
        self.goal = GoalState(tuple(map(float, positions[-1])), times[-1], since=self.now())
        self._streaming = asyncio.ensure_future(self.stream(positions, times))
        return self.goal

    async def cancel(self):
        """Cancel the goal; its state is PREEMPTED at once, before the arm has stopped."""
        self._end("PREEMPTED")
        if self._streaming is not None and not self._streaming.done():
            self._streaming.cancel()
        return await self.stop()

    def _look(self):
        goal, robot = self.goal, self.robot
        if goal is None or goal.state != "ACTIVE" or robot.status is None or not robot.joints:
            return
        goal.moved = goal.moved or robot.status.in_motion == 1
        if not goal.moved and self.now() - goal.since < goal.seconds / 2.0:
            return
        near = all(abs(one - other) < NEAR for one, other in zip(robot.joints, goal.joints, strict=False))
        if near and robot.status.in_motion in (0, -1):
            self._end("SUCCEEDED")

    async def _watch(self):
        while True:
            await asyncio.sleep(0.1)
            if self.goal is not None and self.goal.state == "ACTIVE":
                last = max(self.robot.times[-1], self.goal.since) if self.robot.times else self.goal.since
                if self.now() - last > WATCHDOG:
                    self._end("ABORTED")

    def _end(self, state):
        if self.goal is not None and self.goal.state == "ACTIVE":
            self.goal.state, self.goal.ended = state, self.now()

    async def until(self, condition, within):
        """Wait until a condition holds."""
        since = self.now()
        while not condition():
            assert self.now() - since < within, "it never came"
            await asyncio.sleep(0.01)
