"""`yarc ros` as people start it: with a simulator of its own, or beside `yarc serve`."""

import asyncio
import contextlib
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
    """Yield a folder with a short path, for a robot that no other test finds."""
    with tempfile.TemporaryDirectory(prefix="ros-") as name:
        yield Path(name)


def path(count, seconds, end=END, start=None):
    start = np.zeros(6) if start is None else start
    share = (1.0 - np.cos(np.linspace(0.0, np.pi, count))) / 2.0
    return start + share[:, None] * (end - start), np.linspace(0.0, seconds, count).tolist()


TRIES = 8
"""Number of attempts to send a goal.

If a busy computer delays a client by 50 ms, the client has sent only half of a goal, which is reported.
"""


async def carried_out(ports, count, seconds):
    """Send a goal, repeatedly if the computer is busy, and return what the state link reports at its end."""
    async with StockClient(ports) as client:
        await client.until(lambda: client.robot.times, 60.0)
        for _ in range(TRIES):
            here = np.array(client.robot.joints[:6])
            goal = await client.send_goal(*path(count, seconds, start=here))
            with contextlib.suppress(AssertionError):
                await client.until(lambda: goal.state != "ACTIVE" or client.robot.status.in_error == 1, 20.0)  # noqa: B023
            if goal.state == "SUCCEEDED":
                assert goal.moved
                return client.robot
            await asyncio.sleep(1.0)
    raise AssertionError(f"{TRIES} goals, the last one is {goal}")


def test_a_goal_is_carried_out(folder):
    with yarc("ros", "--robot", "INDUSTRIAL6", "--port", "0", "0", folder=folder) as told:
        robot = asyncio.run(carried_out(ports_of(told), 20, 2.0))
        assert np.abs(np.array(robot.joints[:6]) - END).max() < 0.01
        told.until(r"goal \d+ has ended at its last point")
        told.until(r"log: .*\.mcap")
        assert told.end() == 0


def test_feedback_goes_on_while_a_long_goal_is_planned(folder):
    async def longest(client):
        """Send a long goal; return the longest silence of the state link until the robot moves [s].

        Return None if the robot doesn't move.
        """
        positions, times = path(4000, 80.0, start=np.array(client.robot.joints[:6]))
        begun = len(client.robot.times)
        await client.stream(positions, times, between=0.0)
        await client.until(
            lambda: client.robot.status.in_motion == 1 or client.robot.status.in_error == 1, 60.0
        )
        moves = client.robot.status.in_motion == 1
        times = client.robot.times[begun - 1 :]
        await client.stop()
        await client.until(lambda: client.robot.status.in_motion == 0, 20.0)
        return max(np.diff(times)) if moves else None

    async def script(ports):
        async with StockClient(ports) as client:
            await client.until(lambda: client.robot.times, 60.0)
            for _ in range(4):  # on a busy computer nobody is heard for a while
                silence = await longest(client)
                if silence is not None and silence < 1.0:
                    return
            raise AssertionError(f"silent for {silence} s")

    with yarc("ros", "--robot", "INDUSTRIAL6", "--no-log", "--port", "0", "0", folder=folder) as told:
        asyncio.run(script(ports_of(told)))


def test_a_served_robot_is_moved(folder):
    with yarc("serve", "--robot", "INDUSTRIAL6", "--no-log", folder=folder) as serving:
        serving.until(" is served: ")
        with yarc("ros", "--robot", "INDUSTRIAL6", "--port", "0", "0", folder=folder) as told:
            told.until("which serves it")
            asyncio.run(carried_out(ports_of(told), 20, 2.0))
            assert told.end() == 0


def test_a_robot_that_is_served_anew_is_moved_again(folder):
    serve = ("serve", "--robot", "INDUSTRIAL6", "--no-log")
    with yarc(*serve, folder=folder) as serving:
        serving.until(" is served: ")
        with yarc("ros", "--robot", "INDUSTRIAL6", "--port", "0", "0", folder=folder) as told:
            ports = ports_of(told)
            serving.end()
            told.until("the coordinator of INDUSTRIAL6 has gone: look at the robot")
            with yarc(*serve, folder=folder) as again:
                again.until(" is served: ")
                told.until("the coordinator of INDUSTRIAL6 is back")
                robot = asyncio.run(carried_out(ports, 20, 2.0))
                assert np.abs(np.array(robot.joints[:6]) - END).max() < 0.01


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
