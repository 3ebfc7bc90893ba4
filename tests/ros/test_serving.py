"""The ROS server with a simulated robot in virtual time, and doubles of the stock client on real sockets."""

import asyncio
import contextlib
import socket
import struct
import time

import numpy as np
import pytest
from coordinator.virtual import coordinating, run
from ros.stock_client import StockClient

from yarclang.coordinator.attached import Here
from yarclang.ros.serving import Place, served
from yarclang.ros.simple_message import ByteOrder, Code, Comm, Decoder, Message, Ping, TrajectoryPoint, encode
from yarclang.runtime.state import State

END = np.array([0.3, -0.2, 0.25, 0.1, 0.3, 0.2])


class Door:
    """A ROS server, its robot and its output."""

    def __init__(self, world, coordinator, ports, said):
        self.world, self.coordinator, self.ports, self.said = world, coordinator, ports, said

    def stands(self):
        return self.world.stands() * self.world.robot.axis_units

    def told(self, text):
        return any(text in one for one in self.said)


@contextlib.asynccontextmanager
async def door(*, order=ByteOrder.LITTLE, hold_on_disconnect=False, keeps=False, **options):
    async with coordinating(**options) as (world, coordinator, client):
        if not keeps:
            client.session.leave()
        said = []

        async def attach(name):
            return Here(coordinator, name)

        place = Place("127.0.0.1", 0, 0)
        serving = served(
            world.robot, attach, place, said.append, order=order, hold_on_disconnect=hold_on_disconnect
        )
        async with serving as ports:
            await asyncio.sleep(0.1)
            yield Door(world, coordinator, ports, said)


def path(end=END, count=12, seconds=2.0, start=None):
    """Return a smooth trajectory whose first point is its start, as in MoveIt."""
    start = np.zeros_like(end) if start is None else start
    share = (1.0 - np.cos(np.linspace(0.0, np.pi, count))) / 2.0
    return start + share[:, None] * (end - start), np.linspace(0.0, seconds, count).tolist()


async def rests(client, within=20.0):
    await client.until(lambda: client.goal.state != "ACTIVE", within)
    return client.goal.state


def test_a_goal_succeeds_where_it_ends():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            began = client.now()
            goal = await client.send_goal(*path())
            assert await rests(client) == "SUCCEEDED", at.said
            assert goal.moved
            assert 2.0 <= goal.ended - began < 2.6
            assert np.abs(at.stands() - END).max() < 2e-4
            assert [one.code for one in client.replies] == [Code.SUCCESS] * 12
            told = [status.in_motion for _, status in client.robot.statuses]
            assert told[-1] == 0
            assert 1 in told
            assert client.robot.status.error_code == client.robot.status.in_error == 0
            assert client.robot.status.drives_powered == 1
            await client.until(lambda: not at.coordinator.owner, 1.0)

    run(script())


def test_big_endian_clients_are_served():
    async def script():
        async with door(order=ByteOrder.BIG) as at, StockClient(at.ports, order=ByteOrder.BIG) as client:
            await client.until(lambda: client.robot.times, 2.0)
            await client.send_goal(*path(seconds=1.5))
            assert await rests(client) == "SUCCEEDED", at.said

    run(script())


def test_a_download_is_carried_out_at_its_end():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.download(*path())
            await client.until(lambda: at.told("has ended at its last point"), 10.0)
            assert client.replies == []
            assert np.abs(at.stands() - END).max() < 2e-4

    run(script())


def test_a_single_point_takes_a_time_of_its_own():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            began = client.now()
            await client.send_goal([END], [2.0])  # its duration comes as 2 s by chance, or as 10 s
            assert await rests(client) == "SUCCEEDED", at.said
            first = client.now() - began
            assert first < 5.0
            await client.until(lambda: not at.coordinator.owner, 1.0)
            await client.send_goal([END], [2.0])  # the robot is already at this point
            assert await rests(client) == "SUCCEEDED"
            await client.until(lambda: at.told("already at its last point"), 2.0)

    run(script())


def test_feedback_comes_at_40_hz():
    async def script():
        async with door() as at, StockClient(at.ports) as client, StockClient(at.ports) as other:
            await asyncio.sleep(2.1)
            for one in (client, other):
                found = [at for at in one.robot.times if at > one.robot.times[-1] - 2.0]
                assert 76 <= len(found) <= 82

    run(script())


def test_a_stop_in_motion_is_a_hold_on_the_path_and_the_end():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            goal = await client.send_goal(*path(seconds=3.0))
            await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            await asyncio.sleep(1.0)
            await client.cancel()
            assert goal.state == "PREEMPTED"
            await client.until(lambda: at.coordinator.state is State.STOP and not at.world.moving, 2.0)
            share = at.stands() / END
            assert 0.02 < share.mean() < 0.98
            # all joints have completed the same share, so the robot is on the path
            assert np.ptp(share) < 2e-3
            await asyncio.sleep(0.3)
            assert client.robot.status.in_motion == 0
            assert client.robot.status.in_error == 0
            assert (await client.stop()).code is Code.SUCCESS  # without a motion, a stop does nothing
            here = at.stands()
            await client.send_goal(*path(end=np.zeros(6), start=here))
            assert await rests(client) == "SUCCEEDED", at.said

    run(script())


def test_a_stop_while_planning_moves_nothing():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            release = asyncio.Event()
            plan = at.coordinator._plan

            async def slow(function, *arguments):
                await release.wait()
                return await plan(function, *arguments)

            at.coordinator._plan = slow
            await client.stream(*path())
            await asyncio.sleep(0.5)
            begun = len(client.robot.times)
            assert (await client.stop()).code is Code.SUCCESS
            await asyncio.sleep(1.0)
            assert len(client.robot.times) - begun >= 38  # feedback goes on while a plan is made
            release.set()
            await asyncio.sleep(1.0)
            assert np.abs(at.stands()).max() < 1e-6
            assert at.told("the goal is forgotten")
            assert not at.coordinator.owner

    run(script())


def test_a_new_goal_stops_the_old_one_and_begins_where_it_rests():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            old = await client.send_goal(*path(seconds=4.0))
            await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            await asyncio.sleep(1.0)
            here = np.array(client.robot.joints[:6])
            goal = await client.send_goal(*path(end=-END, start=here, seconds=4.0))
            assert old.state == "ABORTED"
            assert await rests(client) == "SUCCEEDED", at.said
            assert goal.state == "SUCCEEDED"
            assert np.abs(at.stands() + END).max() < 2e-4

    run(script())


def test_a_goal_that_breaks_limits_is_told_by_robot_status_until_the_next_one():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            await client.send_goal(*path(seconds=0.2))
            await client.until(lambda: client.robot.status.in_error == 1, 5.0)
            assert client.robot.status.error_code == 616
            assert at.told("[Y0616]")
            assert at.told("STRETCH")
            assert client.goal.state == "ACTIVE"  # the stock client doesn't notice the error
            await asyncio.sleep(0.5)
            assert client.robot.status.in_error == 1
            assert np.abs(at.stands()).max() < 1e-6
            await client.send_goal(*path())
            assert await rests(client) == "SUCCEEDED", at.said
            assert client.robot.status.in_error == client.robot.status.error_code == 0

    run(script())


@pytest.mark.parametrize(("slot", "value"), [(2, float("nan")), (6, 0.5), (0, float("inf"))])
def test_points_that_mean_nothing_are_refused(slot, value):
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            joints = [0.0] * 10
            joints[slot] = value
            assert (await client.ask(TrajectoryPoint(0, tuple(joints), 0.1, 1.0))).code is Code.FAILURE
            await client.until(lambda: client.robot.status and client.robot.status.in_error == 1, 2.0)
            assert client.robot.status.error_code == 1622
            assert (await client.ask(TrajectoryPoint(1, (0.0,) * 10, 0.1, 1.0))).code is Code.FAILURE

    run(script())


def test_a_robot_of_somebody_else_isnt_taken():
    async def script():
        async with door(keeps=True) as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.status is not None, 2.0)
            assert client.robot.status.motion_possible == 0
            assert client.robot.status.mode == 1
            await client.send_goal(*path())
            await client.until(lambda: client.robot.status.in_error == 1, 5.0)
            assert client.robot.status.error_code == 1611
            assert np.abs(at.stands()).max() < 1e-6

    run(script())


def test_a_client_killed_in_motion_leaves_its_goal():
    async def script():
        async with door() as at:
            async with StockClient(at.ports) as client:
                await client.stream(*path())
                await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            async with StockClient(at.ports) as other:
                await other.until(lambda: at.told("has ended at its last point"), 5.0)
                assert at.told("continues")
                await asyncio.sleep(0.2)
                assert 1 in [status.in_motion for _, status in other.robot.statuses]
                assert other.robot.status.in_motion == 0
            assert np.abs(at.stands() - END).max() < 2e-4

    run(script())


def test_a_client_killed_in_motion_holds_the_robot_if_that_is_wanted():
    async def script():
        async with door(hold_on_disconnect=True) as at:
            async with StockClient(at.ports) as client:
                await client.stream(*path())
                await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            async with StockClient(at.ports) as other:
                await other.until(lambda: at.coordinator.state is State.HOLD and not at.world.moving, 2.0)
                assert at.told("is held on its path")
                await asyncio.sleep(0.3)
                assert other.robot.status.in_motion == 0
                await other.send_goal(*path(end=np.zeros(6), start=at.stands()))
                assert await rests(other) == "SUCCEEDED", at.said

    run(script())


def test_a_client_killed_within_its_goal_moves_nothing():
    async def script():
        async with door() as at:
            async with StockClient(at.ports) as client:
                for point in client.points(*path())[:6]:
                    await client.ask(point)
            await asyncio.sleep(12.0)
            assert np.abs(at.stands()).max() < 1e-6
            assert at.told("[Y1623]")
            assert at.told("after 6 points")

    run(script())


@pytest.mark.parametrize("answered", [True, False])
def test_a_connection_lost_within_a_goal_loses_no_point_and_adds_none(answered):
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            for point in client.points(*path()):
                if point.sequence == 5:
                    if answered:  # the point has arrived, its answer is lost
                        client._wire[1].write(encode(Message(Comm.REQUEST, point)))
                        await asyncio.sleep(0.005)
                    client.cut()
                    await asyncio.sleep(0.4)
                assert (await client.ask(point)).code is Code.SUCCESS
            await client.until(lambda: at.told("has ended at its last point"), 10.0)
            assert at.told("goal 1: 12 points")
            assert np.abs(at.stands() - END).max() < 2e-4

    run(script())


GARBAGE = {
    "text": b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n",
    "a gigabyte": struct.pack("<4i", 10**9, 11, 2, 0),
    "negative": struct.pack("<4i", -5, 11, 2, 0),
    "the other order": encode(Message(Comm.REQUEST, TrajectoryPoint(0)), ByteOrder.BIG),
}


@pytest.mark.parametrize("what", GARBAGE)
@pytest.mark.parametrize("link", [0, 1])
def test_garbage_ends_its_connection_and_nothing_else(what, link):
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            if link == 0:
                client.cut()
                await asyncio.sleep(0.05)
            reader, writer = await asyncio.open_connection("127.0.0.1", at.ports[link])
            writer.write(GARBAGE[what])
            with contextlib.suppress(ConnectionError):
                while await asyncio.wait_for(reader.read(1024), 2.0):
                    pass
            writer.close()
            assert at.told("[Y1621]")
            await client.send_goal(*path())
            assert await rests(client) == "SUCCEEDED", at.said

    run(script())


def test_half_a_frame_keeps_nobody_waiting():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            frame = encode(Message(Comm.REQUEST, Ping()))
            for link in (0, 1):
                _, writer = await asyncio.open_connection("127.0.0.1", at.ports[link])
                writer.write(frame[:7])
                await asyncio.sleep(0.1)
                writer.transport.abort()
            await client.until(lambda: client.robot.times, 2.0)
            await client.send_goal(*path())
            assert await rests(client) == "SUCCEEDED", at.said

    run(script())


async def asked(ports, body):
    """Send a request on a new connection; return the answer, and whether the connection was closed then."""
    reader, writer = await asyncio.open_connection("127.0.0.1", ports[0])
    writer.write(encode(Message(Comm.REQUEST, body)))
    decoder, found = Decoder(), []
    try:
        while not found:
            found += decoder.feed(await asyncio.wait_for(reader.read(1024), 2.0))
        try:
            ended = not await asyncio.wait_for(reader.read(1024), 0.5)
        except TimeoutError:
            ended = False
    finally:
        writer.transport.abort()
    return found[0].code, ended


def test_a_second_motion_client_is_refused_but_its_stop():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            await client.send_goal(*path(seconds=4.0))
            await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            assert await asked(at.ports, TrajectoryPoint(0, (0.1,) * 6 + (0.0,) * 4, 0.1, 1.0)) == (
                Code.FAILURE,
                True,
            )
            assert at.told("[Y1625]")
            assert at.coordinator.state is State.MOVE
            assert client.robot.status.in_error == 0
            assert await asked(at.ports, TrajectoryPoint(-4)) == (Code.SUCCESS, False)
            await client.until(lambda: at.coordinator.state is State.STOP, 2.0)

    run(script())


def test_another_stop_is_told():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            await client.send_goal(*path(seconds=4.0))
            await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            at.coordinator.stop()  # a stop by somebody else
            await client.until(lambda: client.robot.status.in_error == 1, 3.0)
            assert client.goal.state == "ACTIVE"
            assert at.told("was ended before its last point")

    run(script())


def test_an_answer_never_waits():
    """Every answer comes at once, because stock clients hold their lock until then, and a stop would wait."""

    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            longest = 0.0
            for point in client.points(*path(count=60)):
                begun = time.perf_counter()
                await client.ask(point)
                longest = max(longest, time.perf_counter() - begun)
            assert longest < 0.5

    run(script())


def test_a_robot_that_cant_be_reached_tells_no_positions():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            at.world.unplug()
            await client.until(lambda: client.robot.status.in_error == 1, 20.0)
            assert client.robot.status.motion_possible == 0
            count = len(client.robot.times)
            await asyncio.sleep(1.0)
            assert len(client.robot.times) == count
            at.world.plug()
            await client.until(lambda: len(client.robot.times) > count + 10, 20.0)
            assert client.robot.status.in_error == 0

    run(script())


def test_a_long_goal_is_carried_out(monkeypatch):
    """A long goal is written as lines of bounded length, and in a thread."""

    async def inline(function, *arguments):
        return function(*arguments)

    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            positions, times = path(count=2500, seconds=25.0)
            await client.stream(positions, times, between=0.001)
            await client.until(lambda: at.coordinator.state is State.MOVE, 5.0)
            assert at.told("goal 1: 2500 points")
            assert client.robot.status.in_error == 0

    monkeypatch.setattr(asyncio, "to_thread", inline)
    run(script())


def test_a_client_that_waits_moves_the_robot_when_the_first_has_gone():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            async with StockClient(at.ports) as other:
                await asyncio.sleep(0.05)
                assert at.told("[Y1625]")
                client.cut()
                await other.until(lambda: other.robot.times, 2.0)
                await other.send_goal(*path())
                assert await rests(other) == "SUCCEEDED", at.said

    run(script())


def test_too_many_clients_are_sent_away():
    async def script():
        async with door() as at:
            wires = [await asyncio.open_connection("127.0.0.1", at.ports[1]) for _ in range(17)]
            await asyncio.sleep(0.2)
            assert await wires[-1][0].read(1) == b""
            assert len(await wires[0][0].read(44)) == 44
            for _, writer in wires:
                writer.transport.abort()
            async with StockClient(at.ports) as client:  # there is room again
                await client.until(lambda: client.robot.times, 10.0)

    run(script())


def test_a_client_that_doesnt_read_is_sent_away():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            wire = socket.socket()
            wire.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            wire.connect(("127.0.0.1", at.ports[1]))
            for _ in range(60):
                await asyncio.sleep(2.0)
                if at.told("it doesn't read"):
                    break
            assert at.told("it doesn't read")
            assert client.now() - client.robot.times[-1] < 0.1
            wire.close()

    run(script())


def test_what_runs_at_the_end_comes_to_rest():
    async def script():
        async with door() as at, StockClient(at.ports) as client:
            await client.until(lambda: client.robot.times, 2.0)
            await client.send_goal(*path(seconds=4.0))
            await client.until(lambda: at.coordinator.state is State.MOVE, 3.0)
            await asyncio.sleep(1.0)
        assert not at.world.moving
        share = at.stands() / END
        assert 0.02 < share.mean() < 0.98
        assert np.ptp(share) < 2e-3

    run(script())
