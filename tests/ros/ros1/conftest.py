"""A ROS master, `yarc serve`, the node and a client for all tests of this folder.

Each of them is a process of its own.
"""

import contextlib
import json
import os
import queue
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import xmlrpc.client
from pathlib import Path

import pytest
from ros.process import SCRIPT, Told

from yarclang.runtime.transports.lock import SPACE

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
PYTHON = "/usr/bin/python3"
"""The system's Python, which has ROS's packages; a venv doesn't find them."""
MODULES = (
    "rospy, rosmaster, actionlib, sensor_msgs.msg, std_srvs.srv, trajectory_msgs.msg, visualization_msgs.msg"
)
MASTER = "import rosmaster; rosmaster.rosmaster_main()"
NODE = ("-u", "-m", "yarclang.ros.node.ros1")
RATE = "4"
"""Factor by which the simulated robot is faster than real time."""
PATIENCE = 60.0


def ros_or_skip():
    """Skip a test without ROS 1, or fail it if YARCLANG_REQUIRE_TOOLS=1, as in .ci/run."""
    if Path(PYTHON).exists():
        tried = subprocess.run(
            [PYTHON, "-c", f"import {MODULES}"], capture_output=True, cwd=tempfile.gettempdir(), check=False
        )
        if not tried.returncode:
            return
    reason = (
        "there is no ROS 1 (Debian: apt-get install python3-rospy python3-rosmaster python3-actionlib "
        "python3-sensor-msgs python3-std-srvs python3-trajectory-msgs python3-visualization-msgs)"
    )
    if os.environ.get("YARCLANG_REQUIRE_TOOLS") == "1":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def ended(process, how=signal.SIGTERM, within=30.0):
    """End a process if it is running, and return its exit status."""
    if process is None:
        return None
    if process.poll() is None:
        process.send_signal(how)
    try:
        return process.wait(within)
    finally:
        process.kill()
        process.wait()


class Client:
    """The client's process; its orders are methods of this object."""

    def __init__(self, start):
        self.process = start(PYTHON, "-u", str(HERE / "client.py"), stdin=subprocess.PIPE)
        self.answers = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()
        self._answer("start")

    def _read(self):
        for line in self.process.stdout:
            with contextlib.suppress(ValueError):  # not what rospy logs
                self.answers.put(json.loads(line))

    def _answer(self, what):
        answer = self.answers.get(timeout=PATIENCE)
        if "error" in answer:
            raise AssertionError(f"{what}: {answer['error']}")
        return answer["answer"]

    def __getattr__(self, order):
        def ask(**fields):
            self.process.stdin.write(json.dumps({"do": order, **fields}) + "\n")
            self.process.stdin.flush()
            return self._answer(order)

        return ask


class Stage:
    """All processes, which are started when needed, and again after a test has ended one."""

    def __init__(self, folder):
        self.folder = folder
        self.port = free_port()
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("ROS_")},
            "ROS_MASTER_URI": f"http://127.0.0.1:{self.port}",
            "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(folder / "ros"),
            "ROS_LOG_DIR": str(folder / "ros" / "log"),
            "PYTHONPATH": str(ROOT),
            "XDG_RUNTIME_DIR": str(folder),
            SPACE: folder.name,
            # the robot is also served between the tests, and mustn't slow down other tests
        }
        self.master = self.serve = self.node = self.client = None

    def start(self, *command, **more):
        more.setdefault("stderr", subprocess.STDOUT)
        return subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, cwd=self.folder, env=self.environment, **more
        )

    def start_master(self):
        self.master = self.start(
            PYTHON, "-c", MASTER, "--core", "-p", str(self.port), stderr=subprocess.DEVNULL
        )
        end = time.monotonic() + PATIENCE
        with xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"]) as proxy:
            while time.monotonic() < end:
                with contextlib.suppress(OSError):
                    proxy.getPid("/test")
                    return
                time.sleep(0.05)
        raise AssertionError("the ROS master doesn't answer")

    def start_serve(self, *options):
        process = self.start(
            sys.executable,
            "-u",
            "-c",
            SCRIPT,
            "serve",
            "--robot",
            "industrial6",
            "--no-log",
            "--rate",
            RATE,
            *options,
        )
        self.serve = Told(process)
        self.serve.until("is served")

    def start_node(self, *options):
        self.node = Told(self.start(PYTHON, *NODE, *options))
        return self.node

    def ready(self):
        """Start the processes that aren't running, and wait until goals are accepted."""
        if self.master is None or self.master.poll() is not None:
            self.start_master()
        if self.serve is None or self.serve.process.poll() is not None:
            self.start_serve()
        if self.node is None or self.node.process.poll() is not None:
            self.start_node()
        self.node.until("goals are taken")
        if self.client is None or self.client.process.poll() is not None:
            self.client = Client(self.start)
        assert self.client.ready()
        return self.client

    def status(self):
        """Return the output of `yarc status`."""
        run = subprocess.run(
            [sys.executable, "-c", SCRIPT, "status"],
            check=False,
            capture_output=True,
            text=True,
            cwd=self.folder,
            env=self.environment,
            timeout=PATIENCE,
        )
        return run.stdout + run.stderr

    def end(self):
        if self.client is not None:
            self.client.process.stdin.close()
            ended(self.client.process)
        for told in (self.node, self.serve):
            ended(told and told.process)
        ended(self.master)


@pytest.fixture(scope="module")
def stage():
    ros_or_skip()
    with tempfile.TemporaryDirectory(prefix="ros1-", ignore_cleanup_errors=True) as name:
        made = Stage(Path(name))
        try:
            yield made
        finally:
            made.end()


@pytest.fixture
def ros(stage):
    """Return the client, with all other processes running and the robot free."""
    return stage.ready()
