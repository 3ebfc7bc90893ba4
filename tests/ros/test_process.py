"""`yarc ros` as people start it: with a simulator of its own, or beside `yarc serve`."""

import asyncio
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from ros.process import SCRIPT, ports_of, yarc
from ros.stock_client import StockClient

END = np.array([0.3, -0.2, 0.25, 0.1, 0.3, 0.2])


@pytest.fixture
def folder():
    """A folder for a robot that nobody else finds; the paths of sockets are short."""
    with tempfile.TemporaryDirectory(prefix="ros-") as name:
        yield Path(name)


def path(count, seconds, end=END):
    share = (1.0 - np.cos(np.linspace(0.0, np.pi, count))) / 2.0
    return share[:, None] * end, np.linspace(0.0, seconds, count).tolist()


async def carried_out(ports, positions, times, within=60.0):
    async with StockClient(ports) as client:
        await client.until(lambda: client.robot.times, 20.0)
        goal = await client.send_goal(positions, times)
        await client.until(lambda: goal.state != "ACTIVE", within)
        assert goal.state == "SUCCEEDED"
        assert goal.moved
        return client.robot


def test_a_goal_is_carried_out(folder):
    with yarc("ros", "--robot", "INDUSTRIAL6", "--port", "0", "0", folder=folder) as told:
        robot = asyncio.run(carried_out(ports_of(told), *path(20, 2.0)))
        assert np.abs(np.array(robot.joints[:6]) - END).max() < 0.01
        told.until("goal 1 has ended at its last point")
        told.until(r"log: .*\.mcap")
        assert told.end() == 0


def test_feedback_goes_on_while_a_long_goal_is_planned(folder):
    async def script(ports):
        async with StockClient(ports) as client:
            await client.until(lambda: client.robot.times, 20.0)
            await client.stream(*path(4000, 80.0), between=0.0)
            begun = len(client.robot.times)
            await client.until(lambda: client.robot.status.in_motion == 1, 120.0)
            times = client.robot.times[begun - 1 :]
            assert len(times) > 2
            assert max(np.diff(times)) < 1.0
            assert client.robot.status.in_error == 0
            await client.stop()
            await client.until(lambda: client.robot.status.in_motion == 0, 20.0)

    with yarc("ros", "--robot", "INDUSTRIAL6", "--no-log", "--port", "0", "0", folder=folder) as told:
        asyncio.run(script(ports_of(told)))


def test_a_served_robot_is_moved(folder):
    with yarc("serve", "--robot", "INDUSTRIAL6", "--no-log", folder=folder) as serving:
        serving.until(" is served: ")
        with yarc("ros", "--robot", "INDUSTRIAL6", "--port", "0", "0", folder=folder) as told:
            told.until("which serves it")
            asyncio.run(carried_out(ports_of(told), *path(20, 2.0)))
            assert told.end() == 0


def test_a_port_that_is_taken_is_told(folder):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        command = ["ros", "--robot", "INDUSTRIAL6", "--no-log", "--port", port, "0"]
        found = subprocess.run(
            [sys.executable, "-c", SCRIPT, *command],
            check=False,
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=120,
        )
    assert found.returncode == 1
    assert f"port {port} can't be listened on" in found.stderr
    assert "--port" in found.stderr
    assert "Traceback" not in found.stderr
