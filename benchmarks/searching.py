"""Measure watched inputs: `python benchmarks/searching.py [--rounds N]`. The figures are the time from an
input's edge to the hold, and the time to plan and prove the motion after a search, or a pick and place with
an OFFSET.

`yarc sim` and `yarc run` run as separate processes, and a third client of the controller changes the input,
as a PLC would. The clock begins just before that client writes, and ends when the bytes of the hold are on
the wire; both are read from the system's monotonic clock. So the time includes that client's own way to the
controller. Planning is measured separately: a line down is ended at ten places, and a line up is planned from
each of them.

Goals: edge to hold 10 ms (p99, idle); planned and certified in 150 ms (median).
"""

from __future__ import annotations

import argparse
import random
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from yarclang.pipeline.replanning import replanned
from yarclang.pipeline.shifting import shifted
from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import flange_poses
from yarclang.runtime.actions import Replanned
from yarclang.runtime.pmac.messages import Ask
from yarclang.runtime.pmac.protocol import GREETING, Connection
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse
from yarclang.transforms import roll_pitch_yaw

sys.path.insert(0, str(Path(__file__).parent))
from cobots import robot_of

PROGRAM = """ROBOT INDUSTRIAL6
INPUT CURTAIN M11
ON CURTAIN OFF HOLD
P0010 MOVEJ 0 0 0 0 30 0 [20] (deg,s)
P0020 MOVEJ 0 0 0 0 0 0 [20] (deg,s)
"""
RUNNER = """
import os, sys, time
from yarclang.runtime.transports import tcp
from yarclang.cli.yarc import main

sends = tcp.Wire.send

def send(self, data):
    sends(self, data)
    if data[8:] == b"&1H":
        print("hold", time.monotonic_ns(), flush=True)

tcp.Wire.send = send
main(["run", sys.argv[1], "--to", sys.argv[2], "--no-log", "--yes"])
"""
SEARCHES = {
    "INDUSTRIAL6": "P0010 MOVEL 0 1174.4 1000 0 0 0 [2]\n"
    "P0020 MOVEL 0 1174.4 800 0 0 0 [V 50] UNTIL TOUCH\n"
    "P0030 MOVEL 0 1174.4 1000 0 0 0 [2]\n",
}


PICKS = ("INDUSTRIAL6", "UR5")


class Beside:
    """Another client of the controller."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._connection = Connection()
        self.ask(GREETING)

    def ask(self, line: str) -> None:
        """Send a line, and wait for its reply."""
        self._socket.sendall(self._connection.send(Ask(line), time.monotonic(), 5.0))
        while not self._connection.receive(self._socket.recv(4096), time.monotonic()):
            pass


def edges(rounds: int, folder: Path) -> list[float]:
    """Return the times from an edge to the hold [ms]."""
    program = folder / "program.yarc"
    program.write_text(PROGRAM)
    arguments = ["sim", "--port", "0", "--robot", "INDUSTRIAL6"]
    command = [sys.executable, "-c", f"from yarclang.cli.yarc import main; main({arguments})"]
    found: list[float] = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as simulator:
        assert simulator.stdout is not None
        found_port = re.search(r":([0-9]+)", simulator.stdout.readline())
        assert found_port is not None
        port = int(found_port[1])
        beside = Beside(port)
        beside.ask("M11->*")
        draw = random.Random(0)
        while len(found) < rounds:
            beside.ask("M11=1")
            arguments = [sys.executable, "-c", RUNNER, str(program), f"tcp://127.0.0.1:{port}"]
            with subprocess.Popen(
                [*arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            ) as run:
                assert run.stdout is not None
                for line in run.stdout:
                    if line.startswith("move"):
                        break
                time.sleep(draw.uniform(0.5, 1.0))
                begin = time.monotonic_ns()
                beside.ask("M11=0")
                for line in run.stdout:
                    if line.startswith("hold"):
                        found.append((int(line.split()[1]) - begin) / 1e6)
                        break
                run.terminate()
                run.wait()
            # back to the start of the program
            beside.ask("&1A")
            for motor in range(1, 7):
                beside.ask(f"#{motor}J=0")
            time.sleep(1.5)
        simulator.terminate()
    return found


def planned(name: str, text: str) -> list[float]:
    """Return the times to plan and prove the commands after a search, which is ended at ten places [ms]."""
    robot = load_robot(name).value
    assert robot is not None
    head = "INPUT TOUCH M12\nDEFAULT {TCP} (mm,deg,s) {B}\n"
    module = parse(SourceFile("search.yarc", head + text)).value
    assert module is not None
    made = compile_module(module, Request(robot)).value
    assert made is not None
    plan, found = made.plan, []
    begin, end = plan.begins[1], plan.ends[1]
    for time_ in np.linspace(begin, end, 12)[1:-1]:
        here = plan.sample(np.array([time_]))[0][0]
        since = time.perf_counter()
        answer = replanned(plan, 1, here, Request(robot))
        found.append((time.perf_counter() - since) * 1e3)
        assert isinstance(answer, Replanned), answer
    return found


def picked(name: str, rounds: int) -> list[float]:
    """Return the CPU times to plan and prove a pick and place, six motions and two SETs, somewhere in the box
    of an OFFSET [ms].
    """
    with tempfile.TemporaryDirectory() as folder:
        robot = robot_of(name, Path(folder))
    begin = robot.home.copy()
    begin[[1, 2, 4]] += np.radians((-20.0, 25.0, 30.0))
    flange = flange_poses(robot.chain, begin[None])[0]
    turn = " ".join(f"{one:.4f}" for one in np.degrees(roll_pitch_yaw(flange[:3, :3])))

    def at(x: float, z: float) -> str:
        x, y, z = flange[:3, 3] * 1e3 + np.array([x, 0.0, z])
        return f"{x:.2f} {y:.2f} {z:.2f} {turn}"

    # 60 mm along the base's z axis
    above = " ".join(f"{one:.3f}" for one in flange[2, :3] * 60.0)
    text = f"""OUTPUT GRIP M1
REGISTER DX -2000..2000 0
REGISTER DY -2000..2000 0
REGISTER TURN -1000..1000 0
DEFAULT {{FLANGE}} [50%] (mm,deg,s) {{B}}
FRAME {{PART}} {at(0.0, -60.0)}
FRAME {{PLACE}} {at(120.0, -60.0)}
START {" ".join(f"{one:.4f}" for one in np.degrees(begin))} (deg)
OFFSET {{PART}} X DX Y DY RZ TURN
  P0010 MOVEJ_RPY {above} 0 0 0 {{PART}}
  P0020 MOVEL 0 0 0 0 0 0 {{PART}}
  P0030 SET GRIP ON
  P0040 MOVEL {above} 0 0 0 {{PART}}
  P0050 MOVEJ_RPY {above} 0 0 0 {{PLACE}}
  P0060 MOVEL 0 0 0 0 0 0 {{PLACE}}
  P0070 SET GRIP OFF
  P0080 MOVEL {above} 0 0 0 {{PLACE}}
END
"""
    parsed = parse(SourceFile("pick.yarc", text)).value
    assert parsed is not None
    compiled = compile_module(parsed, Request(robot))
    made = compiled.value
    assert made is not None, compiled.diagnostics
    draw, found = random.Random(0), []
    here = made.plan.motions[0].curve.points[0]
    for _ in range(rounds):
        values = (draw.randint(-2000, 2000), draw.randint(-2000, 2000), 0, draw.randint(-1000, 1000))
        since = time.process_time()
        answer = shifted(made.plan, 0, here, values, Request(robot))
        found.append((time.process_time() - since) * 1e3)
        assert isinstance(answer, Replanned), answer
    return found


def main() -> None:
    """Print the measurements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=40)
    rounds = parser.parse_args().rounds
    for name, text in SEARCHES.items():
        times = planned(name, text)
        print(
            f"{name}: what follows a search {statistics.median(times):.0f} ms (median), "
            f"{max(times):.0f} ms (worst)"
        )
    for name in PICKS:
        times = picked(name, rounds)
        print(
            f"{name}: a pick and place with an OFFSET {statistics.median(times):.0f} ms (median), "
            f"{max(times):.0f} ms (worst) of CPU time"
        )
    with tempfile.TemporaryDirectory() as folder:
        found = sorted(edges(rounds, Path(folder)))
    print(
        f"edge to hold: {statistics.median(found):.1f} ms (median), {found[-1]:.1f} ms (worst of "
        f"{len(found)})"
    )


if __name__ == "__main__":
    main()
