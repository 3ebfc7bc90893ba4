"""Tests of a master in another process, through a real socket and in slowed time, against the simulator."""

import asyncio
import json
import time

import numpy as np
import pytest
from simulator.machines import robot_machine

from yarclang.coordinator.attached import Here
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.serving import MasterServer, TcpDoor, UnixDoor
from yarclang.coordinator.ordered import OrderedSession
from yarclang.runtime.actions import Trouble
from yarclang.simulator.commissioning import stand
from yarclang.simulator.network.embedded import EmbeddedSimulator

PACE = 0.25
"""Speed of the simulator's time relative to real time, slow enough for a busy computer."""

READY = np.array([0.0, 10.0, 10.0, 0.0, 40.0, 0.0])


async def say(writer, reader, content):
    writer.write(json.dumps(content).encode() + b"\n")
    return json.loads(await reader.readline())


async def over_tcp(server):
    reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
    writer.write(json.dumps({"token": server.door.token}).encode() + b"\n")
    return reader, writer


async def over_unix(server):
    return await asyncio.open_unix_connection(str(server.path))


@pytest.mark.parametrize(("door", "connect"), [(UnixDoor(), over_unix), (TcpDoor(), over_tcp)])
def test_a_master_is_followed(door, connect, tmp_path):
    robot, machine = robot_machine("INDUSTRIAL6", record=False)
    stand(machine, robot, READY * robot.axis_units)

    async def session(port):
        link = OrderedSession("127.0.0.1", port, reply_time=20.0, pace=PACE)
        async with Coordinator(robot, link, folder=tmp_path, log=NO_LOG) as coordinator:
            attached = Here(coordinator, "test")
            client = attached.client
            client.session.own()
            async with MasterServer(attached, door) as server:
                reader, writer = await connect(server)
                if isinstance(door, TcpDoor):
                    assert json.loads(await reader.readline()) == {"ok": True}
                since = time.monotonic()
                while (now := (time.monotonic() - since) * PACE) < 1.2:
                    wanted = np.add(READY, [4.0 * min(now, 0.7), 0, 0, 0, 0, 0])
                    answer = await say(writer, reader, {"joints": wanted.tolist()})
                    assert answer["ok"], answer
                    await asyncio.sleep(0.02)
                assert answer["lag_s"] < 0.4
                assert abs(answer["behind"]["J1"]) < 0.2
                denied = await say(writer, reader, {"joints": [999, 0, 0, 0, 0, 0]})
                assert denied == {"ok": False, "error": "J1 would exceed its limits", "code": "Y1616"}
                # Only one process may steer at a time.
                other, second = await connect(server)
                assert (
                    json.loads(await other.readline())["error"] == "another process already steers the robot"
                )
                second.close()
                writer.close()  # at the end of the connection, the robot comes to rest
                until = time.monotonic() + 20.0
                while coordinator.under_way:
                    assert time.monotonic() < until
                    await asyncio.sleep(0.02)
                assert (await client.motion.stands())[0] / robot.axis_units[0] == pytest.approx(2.8, abs=0.3)
            with pytest.raises(Trouble, match="can't be listened on"):
                async with MasterServer(attached, TcpDoor(port, "203.0.113.1")):
                    pass

    with EmbeddedSimulator(machine, rate=PACE) as simulator:
        asyncio.run(session(simulator.port))
